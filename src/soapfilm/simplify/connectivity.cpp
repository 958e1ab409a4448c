#include "soapfilm/simplify/connectivity.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <numeric>

#include "soapfilm/error.h"

namespace soapfilm {

namespace {

[[noreturn]] void refuse_edge(uint32_t a, uint32_t b, const char* why) {
  throw ParameterError(fmt::format("mesh: edge {}-{} {}, must be a 2-manifold", std::min(a, b), std::max(a, b), why));
}

}  // namespace

Connectivity::Connectivity(std::vector<Triangle> triangles, size_t vertices)
    : corner_(std::move(triangles)),
      twin_(3 * corner_.size(), none),
      first_(vertices, none),
      alive_(corner_.size(), 1) {
  find_twins();
  for (uint32_t h = 0; h < twin_.size(); ++h)
    if (uint32_t& first = first_[from(h)]; first == none) first = h;
  for (uint32_t& h : first_)
    if (h != none) h = rewound(h);
  check_fans();
}

/// Half edges grouped by their smaller end.
void Connectivity::find_twins() {
  std::vector<uint32_t> begin(first_.size() + 1), by_vertex(twin_.size());
  const auto low = [&](uint32_t h) { return std::min(from(h), to(h)); };
  const auto high = [&](uint32_t h) { return std::max(from(h), to(h)); };
  for (uint32_t h = 0; h < twin_.size(); ++h) ++begin[low(h) + 1];
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  std::vector<uint32_t> next(begin.begin(), begin.end() - 1);
  for (uint32_t h = 0; h < twin_.size(); ++h) by_vertex[next[low(h)]++] = h;
  for (size_t v = 0; v + 1 < begin.size(); ++v) {
    const auto some = by_vertex.begin() + begin[v], end = by_vertex.begin() + begin[v + 1];
    std::sort(some, end, [&](uint32_t g, uint32_t h) { return high(g) != high(h) ? high(g) < high(h) : g < h; });
    for (auto g = some; g != end;) {
      auto same = g + 1;
      while (same != end && high(*same) == high(*g)) ++same;
      if (same - g > 2) refuse_edge(from(*g), to(*g), fmt::format("is in {} triangles", same - g).c_str());
      if (same - g == 2) {
        if (from(g[0]) == from(g[1])) refuse_edge(from(*g), to(*g), "has two triangles of opposite orientation");
        link(g[0], g[1]);
      }
      g = same;
    }
  }
}

void Connectivity::check_fans() const {
  std::vector<uint32_t> seen(first_.size()), all(first_.size());
  for (const Triangle& t : corner_)
    for (const uint32_t v : t) ++all[v];
  for (uint32_t v = 0; v < first_.size(); ++v) {
    if (first_[v] == none) continue;
    uint32_t fan = 0;
    for_fan(v, [&](uint32_t) { ++fan; });
    if (fan != all[v])
      throw ParameterError(
          fmt::format("mesh: the triangles at vertex {} are more than one fan, must be a 2-manifold", v));
  }
}

uint32_t Connectivity::rewound(uint32_t h) const {
  for (uint32_t g = h;;) {
    if (twin_[g] == none) return g;
    g = next(twin_[g]);
    if (g == h) return h;
  }
}

uint32_t Connectivity::before_on_border(uint32_t vertex) const {
  uint32_t last = none;
  for_fan(vertex, [&](uint32_t h) { last = h; });
  return from(previous(last));
}

/// Gives a corner to all triangles of the fan that h leaves.
void Connectivity::relabel(uint32_t h, uint32_t vertex) {
  const uint32_t begin = rewound(h);
  uint32_t g = begin;
  do {
    corner_[g / 3][g % 3] = vertex;
    g = twin_[previous(g)];
  } while (g != begin && g != none);
}

void Connectivity::collapse(uint32_t h, uint32_t kept) {
  const uint32_t a = from(h), b = to(h), gone = kept == a ? b : a, g = twin_[h];
  const bool border = on_border(a) || on_border(b);
  const Triangle removed = corner_[h / 3], across = g == none ? removed : corner_[g / 3];
  relabel(kept == a ? next(h) : h, kept);
  corner_[h / 3] = removed;
  if (g != none) corner_[g / 3] = across;

  uint32_t at_kept = none;
  const auto close = [&](uint32_t edge) {
    const uint32_t x = twin_[next(edge)], y = twin_[previous(edge)], apex = from(previous(edge));
    const bool apex_on_border = on_border(apex);
    link(x, y);
    alive_[edge / 3] = 0;
    // x runs from the apex to the vertex that is kept, y back.
    const uint32_t at_apex = x != none ? x : next(y);
    first_[apex] = apex_on_border ? rewound(at_apex) : at_apex;
    at_kept = y != none ? y : next(x);
  };
  close(h);
  if (g != none) close(g);
  first_[kept] = border ? rewound(at_kept) : at_kept;
  first_[gone] = none;
}

void Connectivity::set(uint32_t triangle, const Triangle& corners, const std::array<uint32_t, 3>& twins) {
  corner_[triangle] = corners;
  for (uint32_t k = 0; k < 3; ++k) {
    twin_[3 * triangle + k] = twins[k];
    link(3 * triangle + k, twins[k]);
  }
}

uint32_t Connectivity::add_triangle() {
  corner_.push_back({});
  twin_.resize(twin_.size() + 3, none);
  alive_.push_back(1);
  return static_cast<uint32_t>(corner_.size() - 1);
}

void Connectivity::flip(uint32_t h) {
  const uint32_t g = twin_[h], t = h / 3, u = g / 3;
  const uint32_t a = from(h), b = to(h), c = from(previous(h)), d = from(previous(g));
  const uint32_t bc = twin_[next(h)], ca = twin_[previous(h)], ad = twin_[next(g)], db = twin_[previous(g)];
  set(t, {a, d, c}, {ad, 3 * u + 2, ca});
  set(u, {d, b, c}, {db, bc, 3 * t + 1});
  first_[a] = rewound(3 * t);
  first_[b] = rewound(3 * u + 1);
  first_[c] = rewound(3 * t + 2);
  first_[d] = rewound(3 * u);
}

uint32_t Connectivity::split(uint32_t h) {
  const uint32_t g = twin_[h], t = h / 3, u = g == none ? none : g / 3;
  const uint32_t a = from(h), b = to(h), c = from(previous(h));
  const uint32_t bc = twin_[next(h)], ca = twin_[previous(h)];
  const auto m = static_cast<uint32_t>(first_.size());
  first_.push_back(none);
  const uint32_t v = add_triangle(), w = u == none ? none : add_triangle();
  const uint32_t d = u == none ? none : from(previous(g));
  const uint32_t ad = u == none ? none : twin_[next(g)], db = u == none ? none : twin_[previous(g)];
  set(t, {a, m, c}, {w == none ? none : 3 * w, 3 * v + 2, ca});
  set(v, {m, b, c}, {u == none ? none : 3 * u, bc, 3 * t + 1});
  if (u != none) {
    set(u, {b, m, d}, {3 * v, 3 * w + 2, db});
    set(w, {m, a, d}, {3 * t, ad, 3 * u + 1});
    first_[d] = rewound(3 * u + 2);
  }
  first_[a] = rewound(3 * t);
  first_[b] = rewound(3 * v + 1);
  first_[c] = rewound(3 * t + 2);
  first_[m] = rewound(3 * v);
  return m;
}

void Connectivity::undo(uint32_t h, uint32_t kept) {
  const uint32_t a = from(h), b = to(h), gone = kept == a ? b : a, g = twin_[h];
  for (const uint32_t edge : {h, g}) {
    if (edge == none) continue;
    for (const uint32_t outer : {next(edge), previous(edge)})
      if (twin_[outer] != none) twin_[twin_[outer]] = outer;
    alive_[edge / 3] = 1;
  }
  const uint32_t from_gone = gone == b ? next(h) : h, from_kept = gone == b ? h : next(h);
  relabel(from_gone, gone);
  first_[gone] = rewound(from_gone);
  first_[kept] = rewound(from_kept);
  first_[from(previous(h))] = rewound(previous(h));
  if (g != none) first_[from(previous(g))] = rewound(previous(g));
}

}  // namespace soapfilm
