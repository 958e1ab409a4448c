// Removes surface without samples nearby: the minimal surface over areas that were not scanned.
#pragma once

#include <cstddef>
#include <optional>

#include "soapfilm/context.h"
#include "soapfilm/field/samples.h"
#include "soapfilm/grid/lattice.h"
#include "soapfilm/mesh.h"
#include "soapfilm/params.h"
#include "soapfilm/report.h"

namespace soapfilm {

/// Throws ParameterError.
void validate(const TrimParams& params);

/// Cuts the mesh along the line where the distance to the nearest sample, smoothed a little along the surface, passes
/// params.distance. `density` is in samples per voxel^2 of surface. Vertices nearer to a sample stay, except in pieces
/// of an area under 5 distance^2 that a cut leaves, such as around an outlier. Where the lattice is open, farther
/// regions that touch the mesh's border are removed; where it is closed, those of more than a tenth of the area. The
/// others stay as filled holes, unless params.holes.
/// The rest of a manifold mesh is a manifold with boundary; cut points are shared by the triangles of an edge, at least
/// a fifth of the edge from its near end. Normals, colors and attributes are dropped where anything is cut. The result
/// does not depend on the number of threads.
void trim(Mesh& mesh, const GridSamples& samples, const Lattice& lattice, double density, const TrimParams& params,
          const Context& context, TrimReport& report);

}  // namespace soapfilm
