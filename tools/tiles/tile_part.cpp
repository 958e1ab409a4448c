#include "tools/tiles/tile_part.h"

#include <algorithm>
#include <utility>

#include "soapfilm/core/disjoint_sets.h"

namespace soapfilm {

namespace {

/// Appends a vertex with all that it has; `to` may be `from`.
void append_vertex(const Mesh& from, uint32_t v, Mesh& to) {
  to.vertices.push_back(from.vertices[v]);
  if (!from.normals.empty()) to.normals.push_back(from.normals[v]);
  if (!from.colors.empty()) to.colors.push_back(from.colors[v]);
  for (size_t k = 0; k < from.attributes.size(); ++k) to.attributes[k].values.push_back(from.attributes[k].values[v]);
}

/// A mesh without vertices that can get those of `like`.
Mesh empty_like(const Mesh& like) {
  Mesh mesh;
  for (const Column& column : like.attributes) mesh.attributes.push_back({column.name, {}, column.is_label});
  return mesh;
}

}  // namespace

TilePart part_of_mesh(const Mesh& whole, std::span<const uint32_t> triangles) {
  TilePart part;
  part.mesh = empty_like(whole);
  for (const uint32_t t : triangles)
    for (const uint32_t v : whole.triangles[t]) part.whole.push_back(v);
  std::sort(part.whole.begin(), part.whole.end());
  part.whole.erase(std::unique(part.whole.begin(), part.whole.end()), part.whole.end());
  for (const uint32_t v : part.whole) append_vertex(whole, v, part.mesh);
  const auto number = [&](uint32_t v) {
    return static_cast<uint32_t>(std::lower_bound(part.whole.begin(), part.whole.end(), v) - part.whole.begin());
  };
  for (const uint32_t t : triangles) {
    const Triangle& corners = whole.triangles[t];
    part.mesh.triangles.push_back({number(corners[0]), number(corners[1]), number(corners[2])});
  }
  return part;
}

TilePart joined(std::span<const TilePart> parts, size_t whole_vertices) {
  TilePart all;
  all.mesh = empty_like(parts.front().mesh);
  std::vector<uint32_t> at(whole_vertices, TilePart::none);  // the new number of each of the whole mesh's vertices
  for (const TilePart& part : parts) {
    std::vector<uint32_t> number(part.mesh.vertices.size());
    for (uint32_t v = 0; v < number.size(); ++v) {
      const uint32_t whole = part.whole[v];
      number[v] = whole == TilePart::none ? TilePart::none : at[whole];
      if (number[v] != TilePart::none) continue;
      number[v] = static_cast<uint32_t>(all.mesh.vertices.size());
      append_vertex(part.mesh, v, all.mesh);
      all.whole.push_back(whole);
      if (whole != TilePart::none) at[whole] = number[v];
    }
    for (const Triangle& t : part.mesh.triangles)
      all.mesh.triangles.push_back({number[t[0]], number[t[1]], number[t[2]]});
  }
  return all;
}

void split_fans(TilePart& part) {
  Mesh& mesh = part.mesh;
  // Corners at the ends of an edge, by its ends: two triangles that share it share the fans of both.
  struct Side {
    uint32_t a, b, corner_a, corner_b;
  };
  std::vector<Side> sides;
  for (uint32_t t = 0; t < mesh.triangles.size(); ++t)
    for (uint32_t k = 0; k < 3; ++k) {
      uint32_t a = 3 * t + k, b = 3 * t + (k + 1) % 3;
      const auto vertex = [&](uint32_t corner) { return mesh.triangles[corner / 3][corner % 3]; };
      if (vertex(a) > vertex(b)) std::swap(a, b);
      sides.push_back({vertex(a), vertex(b), a, b});
    }
  std::sort(sides.begin(), sides.end(), [](const Side& x, const Side& y) {
    return std::pair(x.a, x.b) != std::pair(y.a, y.b) ? std::pair(x.a, x.b) < std::pair(y.a, y.b)
                                                      : x.corner_a < y.corner_a;
  });
  DisjointSets fans(3 * mesh.triangles.size());
  for (size_t i = 1; i < sides.size(); ++i)
    if (sides[i].a == sides[i - 1].a && sides[i].b == sides[i - 1].b) {
      fans.join(sides[i].corner_a, sides[i - 1].corner_a);
      fans.join(sides[i].corner_b, sides[i - 1].corner_b);
    }
  std::vector<uint32_t> fan_of(mesh.vertices.size(), TilePart::none);  // the first fan keeps the vertex
  std::vector<uint32_t> vertex_of(3 * mesh.triangles.size(), TilePart::none);
  for (uint32_t corner = 0; corner < vertex_of.size(); ++corner) {
    uint32_t& vertex = mesh.triangles[corner / 3][corner % 3];
    const uint32_t fan = fans.root(corner);
    if (fan == corner) {
      if (fan_of[vertex] == TilePart::none) {
        fan_of[vertex] = fan;
        vertex_of[fan] = vertex;
      } else {
        vertex_of[fan] = static_cast<uint32_t>(mesh.vertices.size());
        append_vertex(mesh, vertex, mesh);
        part.whole.push_back(part.whole[vertex]);
      }
    }
    vertex = vertex_of[fan];
  }
}

}  // namespace soapfilm
