// Fewer triangles or samples, for pages that browsers turn smoothly.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "soapfilm/mesh.h"
#include "soapfilm/vec.h"

namespace soapfilm::view_detail {

/// A part of a mesh in a good order to draw: triangles of vertices[k], which are numbers of the mesh's own vertices.
struct DrawnMesh {
  std::vector<uint32_t> indices;   ///< three for each triangle, of `vertices`
  std::vector<uint32_t> vertices;  ///< of the mesh, without those in no triangle
  double error = 0;                ///< about the largest distance that the surface moved; 0 where it was not simplified
};

/// With at most about `triangles` triangles (0: all). `positions` are the vertices in float.
DrawnMesh drawn_mesh(const Mesh& mesh, const std::vector<Vec3f>& positions, size_t triangles);

/// Numbers of at most `most` (0: all) of `count` samples, in increasing order: those whose hash is least, so that scan
/// lines leave no pattern.
std::vector<uint32_t> thinned(size_t count, size_t most);

/// The same samples, neighbors in space after each other.
std::vector<uint32_t> sorted_in_space(const std::vector<uint32_t>& samples, const std::vector<Vec3f>& positions);

}  // namespace soapfilm::view_detail
