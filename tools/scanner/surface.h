// A surface that is known exactly, to be scanned and to be compared with: it can be intersected with rays and finds its
// closest points.
#pragma once

#include <optional>
#include <vector>

#include "soapfilm/core/parallel.h"
#include "soapfilm/core/vec.h"
#include "soapfilm/mesh.h"

namespace soapfilm {

/// A point of a surface, the result for a ray or a closest-point query.
struct SurfacePoint {
  Vec3d position;       ///< on the surface, input frame
  Vec3d normal;         ///< unit, outward; at a sharp edge any unit vector of the normal cone; zero: there is none
  double distance = 0;  ///< from the ray's origin, or from the query point; >= 0
};

/// A surface in space. All members are safe to call from several threads at once.
class Surface {
 public:
  virtual ~Surface() = default;

  /// First point met along origin + t direction, t > 0. `direction` is a unit vector.
  virtual std::optional<SurfacePoint> intersect(Vec3d origin, Vec3d direction) const = 0;
  virtual SurfacePoint closest(Vec3d p) const = 0;
  virtual Box3d box() const = 0;
  /// Triangles whose vertices lie on the surface and whose chords deviate from it by at most about `tolerance`
  /// (input units, > 0). A mesh returns itself.
  virtual Mesh tessellate(double tolerance) const = 0;
  /// Enclosed volume and area, where they are known without tessellating.
  virtual std::optional<double> volume() const { return std::nullopt; }
  virtual std::optional<double> area() const { return std::nullopt; }

  /// closest() of many points, in their order.
  virtual std::vector<SurfacePoint> closest_points(const std::vector<Vec3d>& points, const Context& context) const {
    std::vector<SurfacePoint> found(points.size());
    parallel_for(context, points.size(), 256, [&](size_t i) { found[i] = closest(points[i]); });
    return found;
  }
  double distance(Vec3d p) const { return closest(p).distance; }
};

}  // namespace soapfilm
