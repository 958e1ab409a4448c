// Everything that a reconstruction can be told, one struct per stage; every default is written here or beside the stage
// it belongs to, and nowhere else.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "soapfilm/orient/orient.h"
#include "soapfilm/solve/primal_dual.h"

namespace soapfilm {

/// Where the grid lies and how fine it is. At most one of `voxel` and `resolution` may be given.
struct PlaceParams {
  std::optional<double> voxel;    ///< edge of a cell, input units, > 0
  std::optional<int> resolution;  ///< grid vertices along the longest axis, padding included, > 2 padding
  double samples_per_voxel2 = 1;  ///< without both: the voxel that holds this many samples per voxel^2 of surface, > 0
  int padding = 6;                ///< cells between the samples and the border, >= 2
};

/// What the energy weighs.
struct EnergyParams {
  std::optional<double> lambda;      ///< the paper's: weight of a voxel face of area against one unit vector, > 0
  double lambda_per_density = 0.02;  ///< without it: lambda is this times the samples per voxel^2 of surface, > 0
};

/// From the relaxed indicator to the surface (section 4.4).
struct SurfaceParams {
  double threshold = 0.5;          ///< mu, in (0, 1)
  std::optional<double> isovalue;  ///< of the smoothed indicator, in (0, 1); without it: its mean at the samples
};

struct ReconstructParams {
  OrientParams orient;
  PlaceParams place;
  EnergyParams energy;
  PrimalDualParams solve;
  SurfaceParams surface;
  std::optional<size_t> memory_limit;  ///< bytes; without it: what the machine has free
};

/// Throws ParameterError naming the first value that is out of its range, and the range.
void validate(const ReconstructParams& params);

/// All parameters by name; absent ones as null.
std::string to_json(const ReconstructParams& params);
/// The inverse; a key that is absent keeps its default. Throws ParameterError for text that is not JSON, an unknown
/// key, a value of the wrong type or out of range.
ReconstructParams params_from_json(const std::string& text);

}  // namespace soapfilm
