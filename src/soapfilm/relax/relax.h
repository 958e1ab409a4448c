// From flat triangles of one voxel to triangles that follow the curvature of the surface.
#pragma once

#include "soapfilm/context.h"
#include "soapfilm/field/samples.h"
#include "soapfilm/grid/lattice.h"
#include "soapfilm/mesh.h"
#include "soapfilm/params.h"
#include "soapfilm/relax/smooth_field.h"
#include "soapfilm/report.h"

namespace soapfilm {

/// Throws ParameterError naming the first value that is out of its range, and the range.
void validate(const RelaxParams& params);

/// Half edges, and triangles including new ones, are counted in 32 bits: a mesh with more triangles stays as it is.
inline constexpr size_t most_relaxed = (size_t{1} << 30) - 1;

/// The memory of a mesh while it is relaxed, measured: 286 to 358 bytes per vertex.
constexpr uint64_t relax_bytes(uint64_t vertices) { return 320 * vertices; }

/// Exchanges diagonals that do not fit the surface of `field`, splits the edges of a mesh whose middle lies farther
/// than the tolerance from it, once each, and moves their middles and ends onto it; then moves every vertex towards the
/// samples within a voxel of it, by a weighted mean of their residuals. A sample farther from the surface than about
/// 4.7 `scale` (voxels) counts as an outlier.
///
/// Triangles are cut along their split edges into two, three or four, so a manifold stays one, with the same
/// components, genus and boundary, whose edges are not split. Diagonals and moves that would make the mesh intersect
/// itself are not applied (crossings.h says how they are found). New vertices and new triangles come after the old
/// ones, in an order that does not depend on the number of threads. `mesh` must be extracted from the values of which
/// `field` was made.
RelaxReport relax_mesh(Mesh& mesh, const SmoothField& field, const GridSamples& samples, double scale,
                       const Lattice& lattice, const RelaxParams& params, const Context& context);

}  // namespace soapfilm
