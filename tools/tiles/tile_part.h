// A part of a mesh that is being tiled: its vertices know which of the whole mesh's they are.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "soapfilm/mesh.h"

namespace soapfilm {

struct TilePart {
  static constexpr uint32_t none = ~uint32_t{0};

  Mesh mesh;
  std::vector<uint32_t> whole;  ///< of each vertex: its number in the whole mesh; none: it has moved
};

/// Some triangles of the whole mesh.
TilePart part_of_mesh(const Mesh& whole, std::span<const uint32_t> triangles);
/// Parts that touch each other in vertices of the whole mesh, as one.
TilePart joined(std::span<const TilePart> parts, size_t whole_vertices);
/// A vertex whose triangles form several fans becomes one for each: the part is a 2-manifold if the whole is.
void split_fans(TilePart& part);

}  // namespace soapfilm
