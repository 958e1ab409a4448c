// The stage that decides the grid: how fine it is, and where it lies.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "soapfilm/cloud.h"
#include "soapfilm/context.h"
#include "soapfilm/core/vec.h"
#include "soapfilm/grid/lattice.h"
#include "soapfilm/orient/local_surface.h"
#include "soapfilm/params.h"

namespace soapfilm {

struct Grid {
  Lattice lattice;
  double density = 0;  ///< samples per voxel^2 of surface
  double area = 0;     ///< of the surface, voxel^2, roughly; 0: unknown
  std::vector<std::string> warnings;
};

/// The voxel as given, or by the spacing of the samples and the thickness of sheets; the lattice around the samples'
/// box. `by_area`: the density is an average over the area, where it could be measured, not over the samples. Throws
/// ParameterError where no such lattice is possible.
Grid place_grid(const PointCloud& cloud, const Box3d& box, const LocalSurface& surface, const PlaceParams& params,
                bool by_area, const Context& context);

/// " (...)", if a thousandth of the samples makes the box at least twice as long: what the box would be without them,
/// and the position of one. Nothing otherwise.
std::string far_samples(const PointCloud& cloud, const Box3d& box);

}  // namespace soapfilm
