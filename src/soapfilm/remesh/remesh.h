// Even triangles, for simulation.
#pragma once

#include <optional>

#include "soapfilm/context.h"
#include "soapfilm/mesh.h"

namespace soapfilm {

struct RemeshParams {
  double edge = 0;                  ///< the length that edges shall have, input units, > 0
  std::optional<double> tolerance;  ///< input units, > 0; not given: half of `edge`, which may be missed
};

struct RemeshReport {
  size_t triangles_before = 0, triangles = 0;
  double proved = 0;          ///< input units: no point of either mesh is farther than this from the other
  double even_edges = 0;      ///< share of edges with a length of 0.7 to 1.4 times `edge`
  double good_angles = 0;     ///< share of triangles without an angle below 20 degrees
  double smallest_angle = 0;  ///< degrees
  size_t intersecting = 0;    ///< pairs of triangles, of a mesh that had such pairs
};

struct Remeshed {
  Mesh mesh;
  RemeshReport report;
};

/// A mesh of the same surface whose edges are about equally long: by splits, collapses, flips, and moves along the
/// original (docs/guide/simulation.md). Components, genus, borders and sharp edges stay. No two triangles intersect,
/// unless they did before. Where the surface is finer than `edge`, or the tolerance needs it, triangles are smaller.
/// Colors, normals and attributes are taken from the old surface. The same bytes for any number of threads.
/// Throws ParameterError for other parameters, a mesh that is not a 2-manifold (it names the edge), and a tolerance
/// that cannot be kept; Cancelled.
Remeshed remesh(const Mesh& mesh, const RemeshParams& params, const Context& context);

}  // namespace soapfilm
