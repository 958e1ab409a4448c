// Whether 32-bit coordinates are precise enough.
#pragma once

#include <vector>

#include "soapfilm/mesh.h"

namespace soapfilm::io {

/// The largest change of a coordinate by rounding to float, input units.
double float_rounding_error(const std::vector<Vec3d>& points);

/// Mean length of the triangles' edges, input units; an edge counts once for each of its triangles.
double mean_edge(const Mesh& mesh);

/// The precision for WriteOptions::coordinate_precision = `wanted`: 0 means 1e-3 of the mean edge.
double mesh_precision(const Mesh& mesh, double wanted);

/// Throws ParameterError for a mesh that no file can hold: columns of different lengths, an index out of range, a
/// non-finite coordinate, no triangle.
void check_mesh(const Mesh& mesh);

}  // namespace soapfilm::io
