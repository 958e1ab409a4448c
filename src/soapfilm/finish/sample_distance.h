// Distance of each vertex of a mesh to the samples.
#pragma once

#include <vector>

#include "soapfilm/context.h"
#include "soapfilm/field/samples.h"
#include "soapfilm/grid/lattice.h"
#include "soapfilm/mesh.h"

namespace soapfilm {

/// Distance from each vertex to the nearest sample, input units. `samples` must not be empty. Takes 40 bytes per sample
/// and 4 per vertex while it works (finish/nearest_sample.h takes none, but more time where samples are far).
std::vector<float> distances_to_samples(const Mesh& mesh, const GridSamples& samples, const Lattice& lattice,
                                        const Context& context);

}  // namespace soapfilm
