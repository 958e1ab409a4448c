// Rays of scanners, and the made-up surface that they went through.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "soapfilm/cloud.h"
#include "soapfilm/context.h"
#include "soapfilm/core/vec.h"
#include "soapfilm/grid/lattice.h"
#include "soapfilm/mesh.h"

namespace soapfilm {

/// From a sample to the scanner that saw it, lattice coordinates. Between the two there is air.
struct Ray {
  Vec3f sample, scanner;
};

/// Rays of at most some 200,000 samples, evenly spread over the cloud, as far as their scanners are known; `sensor`: of
/// scans that have none.
std::vector<Ray> some_rays(const PointCloud& cloud, const std::optional<Vec3d>& sensor, const Lattice& lattice,
                           const Context& context);

/// For each vertex how many rays cross a triangle whose first corner it is, of the triangles that are made up
/// altogether: `level` > 1 at each corner (TrimLevels). A ray's first three voxels do not count: that is noise. Does
/// not depend on the number of threads.
std::vector<uint32_t> count_crossings(const Mesh& mesh, const std::vector<double>& level, const std::vector<Ray>& rays,
                                      const Lattice& lattice, const Context& context);

}  // namespace soapfilm
