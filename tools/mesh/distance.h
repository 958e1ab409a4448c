// How far points lie from a mesh: closest points by Embree's tree, distances in double.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "soapfilm/context.h"
#include "soapfilm/mesh.h"

namespace soapfilm {

struct ClosestPoint {
  Vec3d position;
  uint32_t triangle = 0;  ///< the lowest of several at the same distance
  double distance = 0;    ///< >= 0, units of the mesh
};

/// A mesh prepared for closest-point queries. It keeps its own copy of the triangles. The tree is built in float with
/// boxes rounded outward, every candidate is measured in double relative to the mesh's center: georeferenced meshes
/// (offsets of 1e6 with millimeter detail) lose no precision, and the result does not depend on the shape of the tree.
class ClosestPointQuery {
 public:
  static constexpr double longest_side = 1e100;  ///< of the mesh's box, at most: a double holds its square

  /// Throws ParameterError when the mesh has no triangle, a coordinate that is not finite, a box longer than
  /// longest_side, or a triangle that names a vertex which does not exist.
  ClosestPointQuery(const Mesh& mesh, const Context& context);
  ~ClosestPointQuery();
  ClosestPointQuery(ClosestPointQuery&&) noexcept;
  ClosestPointQuery& operator=(ClosestPointQuery&&) noexcept;

  /// For one finite point. Safe to call from several threads.
  ClosestPoint operator()(Vec3d point) const;

  /// For many points, in their order; fast if neighbors in the list are near each other in space. Throws ParameterError
  /// when a point is not finite.
  std::vector<ClosestPoint> operator()(const std::vector<Vec3d>& points, const Context& context) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Distance of each point to the mesh; see ClosestPointQuery.
std::vector<double> distances_to_mesh(const std::vector<Vec3d>& points, const Mesh& mesh, const Context& context);

/// The same distances with a tree over only so many triangles at a time, > 0: less memory, more time. Fast if the
/// points are in an order along space, and neighbors among the triangles are near each other.
std::vector<double> distances_by_parts(const std::vector<Vec3d>& points, const Mesh& mesh, size_t part_triangles,
                                       const Context& context);

DistanceSummary summarize(std::vector<double> distances);

/// summarize(distances_to_mesh(...)).
DistanceSummary point_to_mesh_distance(const std::vector<Vec3d>& points, const Mesh& mesh, const Context& context);

}  // namespace soapfilm
