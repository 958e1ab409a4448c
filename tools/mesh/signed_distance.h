// On which side of a mesh points lie, and how far from it.
#pragma once

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "soapfilm/context.h"
#include "soapfilm/mesh.h"
#include "tools/mesh/distance.h"

namespace soapfilm {

struct SignedPoint {
  Vec3d position;       ///< the closest point of the mesh
  Vec3d normal;         ///< unit gradient of the distance: away from the mesh outside, towards it inside
  double distance = 0;  ///< positive on the side that faces look to
};

/// Signs follow Baerentzen and Aanaes 2005: where the closest point is on an edge or a vertex the mean normal of the
/// faces around it decides, weighted by their angles there, so the sign of a closed mesh is right everywhere. Vertices
/// at one place count as one. Of an open mesh the sign says on which side of the nearest face a point lies; beyond the
/// border that is the side of its continued plane.
class SignedDistance {
 public:
  /// Throws ParameterError as ClosestPointQuery does.
  SignedDistance(const Mesh& mesh, const Context& context);

  std::vector<SignedPoint> operator()(const std::vector<Vec3d>& points, const Context& context) const;

 private:
  Vec3d normal_at(const ClosestPoint& at) const;

  ClosestPointQuery query_;
  std::vector<Vec3d> vertices_;
  std::vector<Triangle> triangles_;                               // of welded vertices
  std::vector<Vec3d> faces_;                                      // unit; zero without area
  std::vector<Vec3d> corners_;                                    // of each vertex: sum of face normals by their angles
  std::vector<std::pair<std::array<uint32_t, 2>, Vec3d>> edges_;  // sorted: sums of face normals
};

}  // namespace soapfilm
