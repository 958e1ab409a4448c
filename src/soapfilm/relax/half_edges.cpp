#include "soapfilm/relax/half_edges.h"

namespace soapfilm {

HalfEdges::HalfEdges(Mesh& mesh) : mesh_(mesh), twin_(3 * mesh.triangles.size(), none) {
  // The upward halves, sorted by the vertex where they start: about three each.
  std::vector<uint32_t> end(mesh.vertices.size());
  for (uint32_t h = 0; h < size(); ++h)
    if (upward(h)) ++end[from(h)];
  for (size_t v = 1; v < end.size(); ++v) end[v] += end[v - 1];
  std::vector<uint32_t> upwards(end.empty() ? 0 : end.back()), first = end;
  for (uint32_t h = 0; h < size(); ++h)
    if (upward(h)) upwards[--first[from(h)]] = h;
  for (uint32_t h = 0; h < size(); ++h) {
    if (upward(h)) continue;
    const uint32_t lower = to(h), upper = from(h);
    for (uint32_t i = first[lower]; i < end[lower]; ++i)
      if (to(upwards[i]) == upper) link(h, upwards[i]);
  }
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
