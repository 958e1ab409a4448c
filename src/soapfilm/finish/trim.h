// Removes surface without samples nearby: the minimal surface over areas that were not scanned.
#pragma once

#include <cstddef>
#include <optional>

#include "soapfilm/context.h"
#include "soapfilm/field/samples.h"
#include "soapfilm/finish/rays.h"
#include "soapfilm/grid/lattice.h"
#include "soapfilm/mesh.h"
#include "soapfilm/params.h"
#include "soapfilm/report.h"

namespace soapfilm {

/// Throws ParameterError.
void validate(const TrimParams& params);

/// What users set, and what the run knows.
struct TrimSetup : TrimParams {
  double density = 1;       ///< samples per voxel^2 of surface
  bool ends = false;        ///< the surface ends where it was not seen: an open one
  double least_beyond = 0;  ///< share of the area; where less is to be cut the surface is a closed one after all
  std::vector<Ray> rays{};  ///< of the scanners that are known
};

/// Cuts the mesh along the line where the distance to the nearest sample, smoothed a little along the surface, passes
/// params.distance; where the surface `ends`, also where the samples around look to its other side. What is nearer, and
/// faces them, stays, except in pieces of an area under 5 distance^2 that a cut leaves, such as around an outlier.
/// Which regions beyond are removed, and which stay as filled holes: choose_regions(). The rest of a manifold mesh is a
/// manifold with boundary; cut points are shared by the triangles of an edge, at least a fifth of the edge from its
/// near end. Normals, colors and attributes are dropped where anything is cut. The result does not depend on the number
/// of threads.
void trim(Mesh& mesh, const GridSamples& samples, const Lattice& lattice, const TrimSetup& params,
          const Context& context, TrimReport& report);

}  // namespace soapfilm
