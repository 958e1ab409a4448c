// A range scan as the surface that its scanner saw: triangles between neighboring pixels, and their weights.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "soapfilm/cloud.h"
#include "soapfilm/core/vec.h"
#include "soapfilm/mesh.h"
#include "soapfilm/params.h"

namespace soapfilm {

// RangeSurfaceParams: an edge longer than max_edge distances between neighboring samples (the median along rows or
// along columns, whichever is larger) bridges a step in depth (Turk and Levoy 1994, section 3.1); triangles steeper
// than max_incidence_deg, and those seen from behind, are steps in depth too. Near the border triangulation scanners
// extend edges falsely: the border itself gets a weight of 1 / (taper + 1).

/// Throws ParameterError when a parameter is out of range.
void validate(const RangeSurfaceParams& params);

/// The position or direction from which a scan was seen.
class Viewpoint {
 public:
  /// The scan's sensor position, or `sensor` if it has none; else its viewing direction. Throws ParameterError when
  /// none of them exists.
  explicit Viewpoint(const Scan& scan, const std::optional<Vec3d>& sensor = {});
  /// Rays that meet in `position`.
  static Viewpoint central(Vec3d position) { return {position, true}; }
  /// Parallel rays; `direction` points from the surface to the scanner and is a unit vector.
  static Viewpoint parallel(Vec3d direction) { return {direction, false}; }

  bool is_central() const { return central_; }
  /// The sensor's position, or the direction of parallel rays.
  Vec3d vector() const { return vector_; }
  /// Unit vector from a point to the scanner.
  Vec3d from(Vec3d point) const { return central_ ? normalized(vector_ - point) : vector_; }

 private:
  Viewpoint(Vec3d vector, bool central) : vector_(vector), central_(central) {}
  Vec3d vector_;
  bool central_;
};

struct RangeSurface {
  /// Indices of samples relative to the scan's first one; counter-clockwise as the scanner sees them.
  std::vector<Triangle> triangles;
  /// Per sample of the scan: the sample's own weight, times the cosine between the surface's normal there and the ray
  /// to the scanner (Curless and Levoy 1996, section 3.2), times the taper towards the border; 0 without a triangle.
  std::vector<float> weight;
  size_t dropped = 0;  ///< triangles across steps in depth
};

/// Throws ParameterError naming the scan when it has no range grid or no viewpoint; `sensor`: for scans without one.
void require_range_scan(const Scan& scan, const std::optional<Vec3d>& sensor = {});

/// Joins the samples of neighboring pixels: four give two triangles along the shorter diagonal, three give one.
/// Throws ParameterError when the scan has no range grid or no viewpoint, or a range grid that does not fit it.
RangeSurface range_surface(const PointCloud& cloud, const Scan& scan, const RangeSurfaceParams& params,
                           const std::optional<Vec3d>& sensor = {});

}  // namespace soapfilm
