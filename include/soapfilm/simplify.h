// Fewer triangles, within a distance that is proved.
#pragma once

#include "soapfilm/context.h"
#include "soapfilm/mesh.h"

namespace SOAPFILM_API soapfilm {

struct SimplifyReport {
  size_t triangles_before = 0, triangles = 0;
  double tolerance = 0;  ///< input units: as given, or the one that reached the number of triangles
  double proved = 0;     ///< input units: no point of either mesh is farther than this from the other; <= tolerance
};

struct Simplified {
  Mesh mesh;
  SimplifyReport report;
};

/// Collapses edges of a closed or open 2-manifold while every point of the old and of the new mesh, and of their
/// borders, stays within `tolerance` (input units, > 0) of the other one: proved, for coordinates as they are written
/// (docs/guide/smaller.md). Components, genus and borders stay; no triangle turns over; no two come to intersect that
/// did not before. Colors, normals and attributes are taken from the old surface. The same bytes for any number of
/// threads.
/// Throws ParameterError for another tolerance or a mesh that is not a 2-manifold, naming the edge; Cancelled.
Simplified simplify(const Mesh& mesh, double tolerance, const Context& context);

/// The same with the smallest tolerance, of a fine series, that leaves at most so many triangles, or as few as the
/// topology allows.
Simplified simplify_to(const Mesh& mesh, size_t triangles, const Context& context);

}  // namespace soapfilm
