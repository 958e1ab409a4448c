// The faces of the sharp-edged part: flat regions with one circular hole, and bands of cylinders.
#pragma once

#include <optional>
#include <vector>

#include "soapfilm/core/vec.h"
#include "tools/scanner/mesh_builder.h"

namespace soapfilm {

struct Vec2 {
  double x = 0;
  double y = 0;
};

/// Orthonormal, right-handed; w is the normal of a flat patch and the axis of a cylinder.
struct PatchFrame {
  Vec3d origin, u, v, w;

  Vec3d to_local(Vec3d p) const {
    const Vec3d d = p - origin;
    return {dot(d, u), dot(d, v), dot(d, w)};
  }
  Vec3d to_world(Vec3d p) const { return origin + u * p.x + v * p.y + w * p.z; }
};

/// Circle in space around the axis u x v.
struct Ring {
  Vec3d center, u, v;
  double radius = 0;

  /// Counter-clockwise around u x v. Patches that share a ring share these points bit by bit.
  std::vector<Vec3d> points(int segments) const;
};

/// Flat region: within a polygon or a ring, and outside of at most one hole that stays clear of its border.
class FlatPatch {
 public:
  /// `corners` counter-clockwise seen against the unit vector `normal`.
  FlatPatch(Vec3d normal, std::vector<Vec3d> corners, std::optional<Ring> hole = {});
  FlatPatch(Vec3d normal, Ring rim, Ring hole);

  Vec3d normal(Vec3d /*on_patch*/) const { return frame_.w; }
  Vec3d closest(Vec3d p) const;
  /// Distance along the ray to a hit from the front.
  std::optional<double> intersect(Vec3d origin, Vec3d direction) const;
  double area() const;
  void tessellate(int segments, MeshBuilder& builder) const;

 private:
  struct Circle {
    Vec2 center;
    double radius = 0;

    bool contains(Vec2 p) const;
    Vec2 closest(Vec2 p) const;
  };

  Vec2 flatten(Vec3d p) const;
  Circle flatten(const Ring& ring) const { return {flatten(ring.center), ring.radius}; }
  bool contains(Vec2 p) const;
  void clip(const std::vector<Vec3d>& polygon, MeshBuilder& builder) const;

  PatchFrame frame_;
  std::vector<Vec3d> corners_;
  std::optional<Ring> rim_ring_, hole_ring_;
  std::vector<Vec2> outline_;
  std::optional<Circle> rim_, hole_;
};

/// Side of a cylinder between two equal rings; `outward` is +1 for a boss and -1 for a bore.
class BandPatch {
 public:
  BandPatch(Ring bottom, Ring top, double outward);

  Vec3d normal(Vec3d on_patch) const;
  Vec3d closest(Vec3d p) const;
  std::optional<double> intersect(Vec3d origin, Vec3d direction) const;
  double area() const;
  void tessellate(int segments, MeshBuilder& builder) const;

 private:
  Ring bottom_, top_;
  PatchFrame frame_;
  double height_;
  double outward_;
};

}  // namespace soapfilm
