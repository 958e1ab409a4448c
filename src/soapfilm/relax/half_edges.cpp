#include "soapfilm/relax/half_edges.h"

#include <algorithm>

#include "soapfilm/core/share.h"

namespace soapfilm {

namespace {

/// The vertices that edges of some triangles may start at, going up.
ItemRange vertices_of(const Mesh& mesh, ItemRange triangles) {
  if (triangles.size() == mesh.triangles.size()) return {0, mesh.vertices.size()};
  size_t first = mesh.vertices.size(), last = 0;
  for (size_t t = triangles.begin; t < triangles.end; ++t)
    for (const uint32_t v : mesh.triangles[t]) {
      first = std::min<size_t>(first, v);
      last = std::max<size_t>(last, v);
    }
  return {first, std::max(first, last)};  // no edge goes up from the last one
}

}  // namespace

HalfEdges::HalfEdges(Mesh& mesh) : mesh_(mesh), twin_(3 * mesh.triangles.size(), none) {
  link_all({0, mesh.triangles.size()});
}

HalfEdges::HalfEdges(Mesh& mesh, const Context& context) : mesh_(mesh), twin_(3 * mesh.triangles.size(), none) {
  const size_t count = mesh.triangles.size();
  link_all(own_part(even_parts(count, context), context));
  bring_items(count, {twin_.data(), 3 * sizeof(uint32_t)}, context, [](size_t t) { return t; });
}

void HalfEdges::link_all(ItemRange wanted) {
  const ItemRange lower = vertices_of(mesh_, wanted);
  ItemRange triangles{0, mesh_.triangles.size()};
  // Calls visit(half edge, lower vertex from lower.begin on, upper vertex, whether it runs upwards).
  const auto for_halves = [&](auto&& visit) {
    for (size_t t = triangles.begin; t < triangles.end; ++t)
      for (uint32_t k = 0; k < 3; ++k) {
        const uint32_t from = mesh_.triangles[t][k], to = mesh_.triangles[t][k == 2 ? 0 : k + 1];
        const size_t low = std::min(from, to) - lower.begin;
        if (low < lower.size()) visit(static_cast<uint32_t>(3 * t + k), low, std::max(from, to), from < to);
      }
  };
  // The upward halves, sorted by the vertex where they start: about three each.
  std::vector<uint32_t> end(lower.size());
  ItemRange touching{mesh_.triangles.size(), 0};
  for_halves([&](uint32_t h, size_t low, uint32_t, bool up) {
    end[low] += up;
    touching = {std::min<size_t>(touching.begin, h / 3), h / 3 + size_t{1}};
  });
  triangles = {std::min(touching.begin, touching.end), touching.end};
  for (size_t v = 1; v < end.size(); ++v) end[v] += end[v - 1];
  std::vector<uint32_t> upwards(end.empty() ? 0 : end.back()), first = end;
  for_halves([&](uint32_t h, size_t low, uint32_t, bool up) {
    if (up) upwards[--first[low]] = h;
  });
  for_halves([&](uint32_t h, size_t low, uint32_t upper, bool up) {
    for (uint32_t i = first[low]; !up && i < end[low]; ++i)
      if (to(upwards[i]) == upper) link(h, upwards[i]);
  });
}

bool HalfEdges::joins(uint32_t h, uint32_t vertex) const {
  uint32_t out = h;
  do {
    if (to(out) == vertex || opposite(out) == vertex) return true;
    out = twin_[previous(out)];
  } while (out != h && out != none);
  if (out == h) return false;
  // At a vertex of the boundary, the other way round.
  for (out = h; !on_boundary(out);) {
    out = next(twin_[out]);
    if (to(out) == vertex) return true;
  }
  return false;
}

void HalfEdges::flip(uint32_t h) {
  const uint32_t back = twin_[h];
  const uint32_t a = from(h), b = to(h), c = opposite(h), d = opposite(back);
  const uint32_t bc = twin_[next(h)], ca = twin_[previous(h)], ad = twin_[next(back)], db = twin_[previous(back)];
  const uint32_t s = h / 3 * 3, t = back / 3 * 3;
  mesh_.triangles[s / 3] = {d, b, c};
  mesh_.triangles[t / 3] = {a, d, c};
  link(s, db);
  link(s + 1, bc);
  link(s + 2, t + 1);
  link(t, ad);
  link(t + 2, ca);
}

}  // namespace soapfilm
