// The stage that decides the grid: how fine it is, and where it lies.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "soapfilm/core/box.h"
#include "soapfilm/core/context.h"
#include "soapfilm/core/point_cloud.h"
#include "soapfilm/grid/lattice.h"
#include "soapfilm/orient/local_surface.h"

namespace soapfilm {

/// Where the grid lies and how fine it is. At most one of `voxel` and `resolution` may be given.
struct PlaceParams {
  std::optional<double> voxel;    ///< edge of a cell, input units, > 0 and <= the samples' box
  std::optional<int> resolution;  ///< grid vertices along the longest axis, padding included, > 2 padding
  double samples_per_voxel2 = 1;  ///< without both: the voxel that holds this many samples per voxel^2 of surface, > 0
  int padding = 6;                ///< cells between the samples and the border, 2..4096
  int levels = 0;                 ///< of the pyramid, 1..12; 0: until the coarsest has at most 24 vertices per axis
};

struct Grid {
  Lattice lattice;
  double density = 0;  ///< samples per voxel^2 of surface
  double area = 0;     ///< of the surface, voxel^2, roughly; 0: not known
  std::vector<std::string> warnings;
};

/// The voxel as asked for, or by the spacing of the samples and the thickness of sheets; the lattice around the
/// samples' box. `by_area`: the density is that over the area, where it could be measured, not over the samples. Throws
/// ParameterError where no such lattice fits.
Grid place_grid(const PointCloud& cloud, const Box3d& box, const LocalSurface& surface, const PlaceParams& params,
                bool by_area, const Context& context);

/// " (...)", where a thousandth of the samples makes the box at least twice as long: what the box would be without
/// them, and where one is. Nothing otherwise.
std::string far_samples(const PointCloud& cloud, const Box3d& box);

}  // namespace soapfilm
