// Curless and Levoy 1996, "A volumetric method for building complex models from range images": the weighted mean of
// the signed distances to all range surfaces that a vertex of the grid lies near. The paper's rival of figure 3 a.
#pragma once

#include <cstddef>

#include "soapfilm/core/parallel.h"
#include "soapfilm/core/point_cloud.h"
#include "soapfilm/core/progress.h"
#include "soapfilm/fuse/range_surface.h"
#include "soapfilm/grid/brick_grid.h"
#include "soapfilm/grid/field.h"
#include "soapfilm/grid/lattice.h"

namespace soapfilm {

struct VripParams {
  /// A scan says something about the vertices up to this far in front of and behind its surface, voxels, > 0; its
  /// weight falls linearly over the outer half. Measured at right angles to the surface, so that 2 and more reach all
  /// corners of a cell that the surface crosses, however obliquely it was seen. Surfaces back to back that are less
  /// than this apart push each other away.
  double ramp = 3;
  RangeSurfaceParams surface;
};

struct VripReport {
  size_t scans = 0;
  size_t triangles = 0;          ///< of all range surfaces
  size_t dropped_triangles = 0;  ///< across steps in depth
  size_t vertices_seen = 0;      ///< of the grid, with a weight > 0
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
/// through x meets (the nearest one to x) gives the signed distance d along this ray and the interpolated weight w;
/// D = sum w d / sum w, W = sum w. The result does not depend on the number of threads.
///
/// Throws ParameterError when a parameter is out of range, a sample is not finite, a scan lacks its range grid or its
/// viewpoint, or no triangle of the scans lies in the lattice.
FusedField fuse_scans(const PointCloud& cloud, const Lattice& lattice, const VripParams& params,
                      const Parallel& parallel, Progress& progress, VripReport& report);

}  // namespace soapfilm
