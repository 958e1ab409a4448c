// Builds scenes from flat pieces. The air is in front of every face: corners run counter-clockwise seen from there.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "soapfilm/core/vec.h"
#include "soapfilm/mesh.h"

namespace soapfilm {

/// Part of a wall in the wall's own coordinates, distances along u and v from its corner.
struct WallPart {
  double u0 = 0, v0 = 0, u1 = 0, v1 = 0;
};

/// The side of a block that is hidden and left out.
enum class Rests { nowhere, on_the_floor, at_the_ceiling };

class SceneBuilder {
 public:
  /// Parallelogram corner, corner + u, corner + u + v, corner + v; u x v points into the air. `openings` (they must not
  /// overlap) are left out.
  void wall(Vec3d corner, Vec3d u, Vec3d v, const std::vector<WallPart>& openings = {});
  /// A solid block in the air.
  void block(const Box3d& box, Rests rests = Rests::nowhere);
  /// Four walls, floor and ceiling around air, except those whose bit 1 << (2 axis + high) is in `without`.
  void hollow(const Box3d& box, unsigned without = 0);
  /// A niche behind an opening of a wall: four sides and a back, `depth` along -(u x v).
  void niche(Vec3d corner, Vec3d u, Vec3d v, const WallPart& opening, double depth);
  /// A round post of `sides` flat sides with a flat top.
  void post(Vec3d foot, double radius, double height, int sides = 24);
  /// A ball of 2 n x n patches.
  void ball(Vec3d center, double radius, int n = 16);
  /// z = height(x, y) over the rectangle, n + 1 by n + 1 vertices; the air is above.
  void ground(double x0, double y0, double x1, double y1, int n, const std::function<double(double, double)>& height);

  Mesh take() { return std::move(mesh_); }

 private:
  uint32_t vertex(Vec3d p);
  void quad(Vec3d a, Vec3d b, Vec3d c, Vec3d d);

  Mesh mesh_;
};

}  // namespace soapfilm
