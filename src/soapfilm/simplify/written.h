// Coordinates as a file will hold them: what is proved of a mesh must hold for the numbers that are written.
#pragma once

#include "soapfilm/core/triangle_pair.h"
#include "soapfilm/mesh.h"

namespace soapfilm {

/// The frame in which a mesh is simplified: its unit, a power of two, is about the length of an edge, or of the
/// tolerance if that is longer; its origin is near the mesh's center. Only points are used whose world coordinates a
/// file can hold: floats where rounding to them moves no vertex by more than a small part of the tolerance and of an
/// edge, otherwise doubles. All of them are also points of one integer lattice, so that predicates are exact, and
/// moving between the frames does not round.
class Written {
 public:
  /// Of a mesh with finite coordinates, not all in one place. `tolerance`: input units. `edge`: the length of the edges
  /// that are worked with; zero: that of the mesh's.
  Written(const Mesh& mesh, double tolerance, double edge = 0);

  Vec3d local(Vec3d world) const { return (rounded(world) - origin_) * per_unit_; }
  Vec3d world(Vec3d local) const { return origin_ + local * unit_; }
  /// The nearest point that can be written, or one beside it.
  Vec3d snapped(Vec3d point) const { return local(world(point)); }
  LatticePoint lattice(Vec3d local) const { return static_cast<LatticePoint>(local * steps_per_unit_); }
  LatticeTriangle lattice(Vec3d a, Vec3d b, Vec3d c) const { return {lattice(a), lattice(b), lattice(c)}; }

  double unit() const { return unit_; }    ///< input units
  double moved() const { return moved_; }  ///< the most that rounding moves a vertex of the mesh, input units
  double slack() const { return slack_; }  ///< above all rounding errors of a distance, input units

 private:
  Vec3d rounded(Vec3d world) const;

  bool single_ = true;
  double step_ = 1, unit_ = 1, per_unit_ = 1, steps_per_unit_ = 1;
  Vec3d origin_;
  double moved_ = 0, slack_ = 0;
};

}  // namespace soapfilm
