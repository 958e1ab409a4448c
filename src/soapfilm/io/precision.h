// Whether 32-bit coordinates are precise enough.
#pragma once

#include <string>
#include <vector>

#include "soapfilm/mesh.h"

namespace soapfilm::io {

/// The largest change of a coordinate by rounding to float, input units. `origin` is subtracted before.
double float_rounding_error(const std::vector<Vec3d>& points, Vec3d origin = {});

/// Mean length of the triangles' edges, input units; an edge counts once for each of its triangles.
double mean_edge(const Mesh& mesh);

/// The precision for WriteOptions::coordinate_precision = `wanted`: 0 means 1e-3 of the mean edge.
double mesh_precision(const Mesh& mesh, double wanted);

/// Triangles that have an area and lose it when coordinates are rounded to float: at most one mesh in many has some,
/// because it lies far from the origin or has very small triangles.
size_t collapsed_by_float(const Mesh& mesh, Vec3d origin = {});

/// Whether a file of the mesh needs 64-bit coordinates: rounding would move a vertex by more than mesh_precision(), or
/// collapse a triangle.
bool needs_double(const Mesh& mesh, double wanted);

/// Throws OutputError for coordinates so large or small that float cannot hold them. `format` is named in the message.
void check_float_range(const std::string& path, const char* format, const Mesh& mesh, Vec3d origin = {});

/// Throws ParameterError for a mesh that no file can hold: columns of different lengths, an index out of range, a
/// non-finite coordinate, no triangle.
void check_mesh(const Mesh& mesh);

}  // namespace soapfilm::io
