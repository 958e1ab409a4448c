#include "soapfilm/relax/flip.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "soapfilm/core/share.h"
#include "soapfilm/core/vec.h"

namespace soapfilm {

namespace {

constexpr int passes = 3;
constexpr double least_area = 0.01;  // voxel^2, of a new triangle projected along either old one's normal
constexpr size_t triangles_per_task = 1 << 13;

/// What exchanging the diagonal of an edge gains; 0 where it is not allowed.
double gain_of(const HalfEdges& edges, uint32_t h, std::span<const Vec3f> normals, double voxel, double least_gain) {
  const auto& at = edges.mesh().vertices;
  const uint32_t a = edges.from(h), b = edges.to(h);
  const double here = sag(at[a], at[b], normals[a], normals[b]);
  if (!(here > least_gain)) return 0;
  const uint32_t c = edges.opposite(h), d = edges.opposite(edges.twin(h));
  for (const uint32_t v : {a, b, c, d})
    if (normals[v] == Vec3f{}) return 0;
  const double gain = here - sag(at[c], at[d], normals[c], normals[d]);
  if (!(gain > least_gain) || c == d || edges.joins(HalfEdges::previous(h), d)) return 0;
  const auto twice = [&](uint32_t p, uint32_t q, uint32_t r) { return cross(at[q] - at[p], at[r] - at[p]); };
  const Vec3d old[] = {normalized(twice(a, b, c)), normalized(twice(b, a, d))};
  const double least = 2 * least_area * voxel * voxel;
  for (const Vec3d& fresh : {twice(d, b, c), twice(a, d, c)})
    for (const Vec3d& normal : old)
      if (!(dot(fresh, normal) > least)) return 0;
  return gain;
}

/// `open`, by triangle: whether one of its edges may gain. Kept up to date.
size_t flip_once(HalfEdges& edges, std::span<const Vec3f> normals, double voxel, double least_gain,
                 std::vector<uint8_t>& open, const Context& context) {
  struct Gain {
    float gain;
    uint32_t half_edge;
  };
  auto order = share_gather<Gain>(open.size(), triangles_per_task, context, [&](size_t t, std::vector<Gain>& found) {
    for (auto h = static_cast<uint32_t>(3 * t); h < 3 * t + 3; ++h) {
      if (!edges.upward(h) || edges.on_boundary(h) || (!open[t] && !open[edges.twin(h) / 3])) continue;
      const auto gain = static_cast<float>(gain_of(edges, h, normals, voxel, least_gain));
      if (gain > 0) found.push_back({gain, h});
    }
  });
  std::stable_sort(order.begin(), order.end(), [](const Gain& x, const Gain& y) { return x.gain > y.gain; });

  // A triangle changes once per pass, and a vertex gets at most one new edge: no two exchanges can make the same edge.
  std::vector<uint8_t> changed(edges.mesh().triangles.size()), joined(edges.mesh().vertices.size());
  std::fill(open.begin(), open.end(), uint8_t{0});
  size_t count = 0;
  for (const auto& [gain, h] : order) {
    if (edges.on_boundary(h)) continue;  // by now another edge of a triangle that has changed
    const uint32_t twin = edges.twin(h), c = edges.opposite(h), d = edges.opposite(twin);
    open[h / 3] = open[twin / 3] = 1;
    if (changed[h / 3] || changed[twin / 3] || joined[c] || joined[d]) continue;
    changed[h / 3] = changed[twin / 3] = joined[c] = joined[d] = 1;
    edges.flip(h);
    ++count;
  }
  return count;
}

}  // namespace

size_t flip_edges(HalfEdges& edges, std::span<const Vec3f> normals, double voxel, double least_gain,
                  const Context& context) {
  size_t count = 0;
  std::vector<uint8_t> open(edges.mesh().triangles.size(), 1);
  for (int pass = 0; pass < passes; ++pass) {
    const size_t flipped = flip_once(edges, normals, voxel, least_gain, open, context);
    count += flipped;
    if (flipped == 0) break;
  }
  return count;
}

}  // namespace soapfilm
