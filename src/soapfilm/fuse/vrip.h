// Curless and Levoy 1996, "A volumetric method for building complex models from range images": the weighted mean of the
// signed distances to all range surfaces near a vertex of the grid. The method with which the paper compares in figure
// 3 a.
#pragma once

#include <cstddef>

#include "soapfilm/cloud.h"
#include "soapfilm/context.h"
#include "soapfilm/fuse/range_surface.h"
#include "soapfilm/grid/brick_grid.h"
#include "soapfilm/grid/field.h"
#include "soapfilm/grid/lattice.h"
#include "soapfilm/params.h"
#include "soapfilm/progress.h"
#include "soapfilm/report.h"

namespace soapfilm {

// VripParams (Curless and Levoy's Dmin and Dmax): with a long `front` other scans outvote false edge extensions that
// float above the surface, with a short `behind` the two sides of thin parts do not displace each other. The weight
// falls linearly over the outer half. Measured at right angles to the surface: so 2 voxels reach all corners of the
// cells that the surface crosses, however obliquely it was seen.

struct VripReport {
  size_t scans = 0;
  size_t triangles = 0;          ///< of all range surfaces
  size_t dropped_triangles = 0;  ///< across steps in depth
  size_t vertices_seen = 0;      ///< of the grid, with a weight > 0
};

/// The scans that are fused, and the scanner's position for those without one.
struct RangeScans {
  const PointCloud& cloud;
  std::optional<Vec3d> sensor = {};
};

/// D and W of Curless and Levoy, equations (3) and (4), on the bricks near the range surfaces.
struct FusedField {
  BrickGrid grid;
  /// Signed distance along the lines of sight, voxels; > 0 behind the surfaces (inside), so that the surface is the
  /// level set 0 of extract_open_isosurface(). 0 where nothing was seen.
  Field<float> distance;
  Field<float> weight;  ///< >= 0; 0 where nothing was seen
};

/// For every scan, in order, and every vertex x near its range surface: the triangle that the ray from the scanner
/// through x meets (the nearest one to x) gives the signed distance d along this ray and the interpolated weight w; D =
/// sum w d / sum w, W = sum w. The result does not depend on the number of threads.
///
/// Throws ParameterError when a parameter is out of range, a sample is not finite, a scan lacks its range grid or its
/// viewpoint, or no triangle of the scans lies in the lattice.
FusedField fuse_scans(const RangeScans& scans, const Lattice& lattice, const VripParams& params, const Context& context,
                      VripReport& report);

}  // namespace soapfilm
