// How much the mesh is, and how sure that is: area, volume, what was seen of it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "soapfilm/context.h"
#include "soapfilm/field/samples.h"
#include "soapfilm/grid/lattice.h"
#include "soapfilm/mesh.h"
#include "soapfilm/report.h"

namespace soapfilm {

/// What is farther than this from all samples counts as unseen, input units: three voxels, or three mean distances
/// between samples; `density` in samples per voxel^2 of surface.
double unseen_distance(double density, const Lattice& lattice);

/// What is known of the two fills of holes, flat and curved.
struct FillDifference {
  bool flat = false;   ///< holes were to stay flat: nobody knows how they would be curved
  int64_t gained = 0;  ///< vertices of the grid that came inside when holes were curved, less those that went outside
};

/// `trim`: if it looked for holes already, they are its list. Volumes are those of closed meshes alone, and are what a
/// surface encloses, whichever way its faces look. The result does not depend on the number of threads.
MeasureReport measure_result(const Mesh& mesh, const GridSamples& samples, const Lattice& lattice, double density,
                             const std::optional<TrimReport>& trim, const FillDifference& fill, const Context& context);

}  // namespace soapfilm
