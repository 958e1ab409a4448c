// What the samples say for each vertex of a mesh: how far the nearest is, and how many are near.
#pragma once

#include <vector>

#include "soapfilm/context.h"
#include "soapfilm/field/samples.h"
#include "soapfilm/grid/lattice.h"
#include "soapfilm/mesh.h"

namespace soapfilm {

struct VertexEvidence {
  std::vector<float> distance;  ///< to the nearest sample, input units
  std::vector<float> support;   ///< samples per voxel^2: sum of weights within support_radius, over the disk's area
};

inline constexpr double support_radius = 1.5;  ///< voxels

/// Per vertex, of what is wanted. `samples` must not be empty. Takes 40 bytes per sample while it works
/// (finish/nearest_sample.h takes none, but more time where samples are far).
VertexEvidence vertex_evidence(const Mesh& mesh, const GridSamples& samples, const Lattice& lattice, bool distance,
                               bool support, const Context& context);

}  // namespace soapfilm
