#include "soapfilm/extract/flip.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace soapfilm {

namespace {

constexpr int passes = 3;
constexpr double least_area = 0.01;  // voxel^2, of a new triangle seen along either old one's normal
constexpr size_t edges_per_task = 1 << 13;

/// The edges of a closed mesh, by their lower end.
struct EdgeTable {
  struct Edge {
    uint32_t lower, upper;
    uint32_t up, down;  ///< half edges 3 t + k: corner k of triangle t and the next are (lower, upper), (upper, lower)
  };
  std::vector<uint32_t> first_of;  ///< by vertex; one more at the end
  std::vector<Edge> edges;

  explicit EdgeTable(const Mesh& mesh) : first_of(mesh.vertices.size() + 1) {
    const auto for_half_edges = [&](bool upwards, auto&& visit) {
      for (uint32_t h = 0; h < 3 * mesh.triangles.size(); ++h) {
        const uint32_t a = from(mesh, h), b = to(mesh, h);
        if ((a < b) == upwards) visit(h, std::min(a, b), std::max(a, b));
      }
    };
    for_half_edges(true, [&](uint32_t, uint32_t lower, uint32_t) { ++first_of[lower + 1]; });
    for (size_t v = 1; v < first_of.size(); ++v) first_of[v] += first_of[v - 1];
    edges.resize(first_of.back());
    std::vector<uint32_t> next(first_of.begin(), first_of.end() - 1);
    for_half_edges(true, [&](uint32_t h, uint32_t lower, uint32_t upper) {
      edges[next[lower]++] = {lower, upper, h, h};
    });
    for_half_edges(false, [&](uint32_t h, uint32_t lower, uint32_t upper) {
      for (uint32_t e = first_of[lower]; e < first_of[lower + 1]; ++e)
        if (edges[e].upper == upper) edges[e].down = h;
    });
  }

  static uint32_t from(const Mesh& mesh, uint32_t half_edge) { return mesh.triangles[half_edge / 3][half_edge % 3]; }
  static uint32_t to(const Mesh& mesh, uint32_t half_edge) {
    return mesh.triangles[half_edge / 3][(half_edge + 1 - half_edge / 3 * 3) % 3];
  }
  /// The triangle's third corner.
  static uint32_t opposite(const Mesh& mesh, uint32_t half_edge) {
    return mesh.triangles[half_edge / 3][(half_edge + 2 - half_edge / 3 * 3) % 3];
  }

  bool holds(uint32_t a, uint32_t b) const {
    const uint32_t lower = std::min(a, b), upper = std::max(a, b);
    for (uint32_t e = first_of[lower]; e < first_of[lower + 1]; ++e)
      if (edges[e].upper == upper) return true;
    return false;
  }
};

/// What the exchange of an edge's diagonal gains; 0 where it is not allowed.
double gain_of(const Mesh& mesh, const EdgeTable& table, const EdgeTable::Edge& edge, std::span<const Vec3f> normals,
               double voxel, double least_gain) {
  const uint32_t a = edge.lower, b = edge.upper;
  const auto& at = mesh.vertices;
  const double here = sag(at[a], at[b], normals[a], normals[b]);
  if (!(here > least_gain)) return 0;
  const uint32_t c = EdgeTable::opposite(mesh, edge.up), d = EdgeTable::opposite(mesh, edge.down);
  for (const uint32_t v : {a, b, c, d})
    if (normals[v] == Vec3f{}) return 0;
  const double gain = here - sag(at[c], at[d], normals[c], normals[d]);
  if (!(gain > least_gain) || c == d || table.holds(c, d)) return 0;
  const auto twice = [&](uint32_t p, uint32_t q, uint32_t r) { return cross(at[q] - at[p], at[r] - at[p]); };
  const Vec3d old[] = {normalized(twice(a, b, c)), normalized(twice(b, a, d))};
  const double least = 2 * least_area * voxel * voxel;
  for (const Vec3d& fresh : {twice(d, b, c), twice(a, d, c)})
    for (const Vec3d& normal : old)
      if (!(dot(fresh, normal) > least)) return 0;
  return gain;
}

size_t flip_once(Mesh& mesh, std::span<const Vec3f> normals, double voxel, double least_gain,
                 const Parallel& parallel) {
  const EdgeTable table(mesh);
  std::vector<float> gain(table.edges.size());
  parallel.for_each(gain.size(), edges_per_task, [&](size_t e) {
    gain[e] = static_cast<float>(gain_of(mesh, table, table.edges[e], normals, voxel, least_gain));
  });
  std::vector<uint32_t> order;
  for (uint32_t e = 0; e < gain.size(); ++e)
    if (gain[e] > 0) order.push_back(e);
  std::stable_sort(order.begin(), order.end(), [&](uint32_t x, uint32_t y) { return gain[x] > gain[y]; });

  // A triangle changes once in a pass, and a vertex gains one edge: no two exchanges can make the same edge.
  std::vector<uint8_t> changed(mesh.triangles.size()), joined(mesh.vertices.size());
  size_t count = 0;
  for (const uint32_t e : order) {
    const auto [a, b, up, down] = table.edges[e];
    const uint32_t c = EdgeTable::opposite(mesh, up), d = EdgeTable::opposite(mesh, down);
    if (changed[up / 3] || changed[down / 3] || joined[c] || joined[d]) continue;
    changed[up / 3] = changed[down / 3] = joined[c] = joined[d] = 1;
    mesh.triangles[up / 3] = {d, b, c};
    mesh.triangles[down / 3] = {a, d, c};
    ++count;
  }
  return count;
}

}  // namespace

size_t flip_edges(Mesh& mesh, std::span<const Vec3f> normals, double voxel, double least_gain,
                  const Parallel& parallel) {
  size_t count = 0;
  for (int pass = 0; pass < passes; ++pass) {
    const size_t flipped = flip_once(mesh, normals, voxel, least_gain, parallel);
    count += flipped;
    if (flipped == 0) break;
  }
  return count;
}

}  // namespace soapfilm
