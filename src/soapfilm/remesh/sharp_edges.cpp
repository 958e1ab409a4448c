#include "soapfilm/remesh/sharp_edges.h"

#include <algorithm>
#include <map>
#include <numeric>

namespace soapfilm {

namespace {

constexpr double sharp_cosine = 0.766;   // of 40 degrees
constexpr double smallest_region = 0.3;  // of the square of an edge

/// Faces that are joined by edges which are not sharp.
class Regions {
 public:
  Regions(const Connectivity& mesh, const Sides& sides, const std::vector<uint8_t>& marked)
      : joined_(mesh.triangles()), area_(mesh.triangles()) {
    std::iota(joined_.begin(), joined_.end(), 0u);
    for (uint32_t h = 0; h < marked.size(); ++h)
      if (!marked[h]) joined_[of(h / 3)] = of(mesh.twin(h) / 3);
    for (uint32_t f = 0; f < joined_.size(); ++f) area_[of(f)] += sides.area(f);
  }

  uint32_t of(uint32_t face) {
    while (joined_[face] != face) face = joined_[face] = joined_[joined_[face]];
    return face;
  }
  double area(uint32_t region) const { return area_[region]; }
  void join(uint32_t region, uint32_t to) {
    joined_[region] = to;
    area_[to] += area_[region];
  }

 private:
  std::vector<uint32_t> joined_;
  std::vector<double> area_;
};

}  // namespace

std::vector<uint8_t> sharp_edges(const Connectivity& mesh, const Sides& sides, double edge) {
  constexpr uint32_t none = Connectivity::none;
  std::vector<uint8_t> marked(3 * mesh.triangles());
  for (uint32_t h = 0; h < marked.size(); ++h) {
    const uint32_t g = mesh.twin(h);
    marked[h] = g == none || dot(sides.normal(h / 3), sides.normal(g / 3)) < sharp_cosine;
  }
  Regions regions(mesh, sides, marked);
  const double least = smallest_region * edge * edge;
  // Faces of small regions, and where these could go: the more edges in common the better, and the more alike.
  std::vector<uint8_t> was_small(mesh.triangles());
  for (uint32_t f = 0; f < was_small.size(); ++f) was_small[f] = regions.area(regions.of(f)) < least;
  std::map<std::array<uint32_t, 2>, double> shared;
  for (uint32_t h = 0; h < marked.size(); ++h)
    if (marked[h] && mesh.twin(h) != none && was_small[h / 3]) {
      const uint32_t from = regions.of(h / 3), to = regions.of(mesh.twin(h) / 3);
      if (from != to) shared[{from, to}] += 1 + dot(sides.normal(h / 3), sides.normal(mesh.twin(h) / 3));
    }
  for (auto begin = shared.begin(); begin != shared.end();) {
    auto best = begin, next = begin;
    for (; next != shared.end() && next->first[0] == begin->first[0]; ++next)
      if (next->second > best->second) best = next;
    const uint32_t from = regions.of(best->first[0]), to = regions.of(best->first[1]);
    if (from != to && regions.area(from) < least) regions.join(from, to);
    begin = next;
  }
  for (uint32_t h = 0; h < marked.size(); ++h)
    if (const uint32_t g = mesh.twin(h); marked[h] && g != none)
      marked[h] = !((was_small[h / 3] || was_small[g / 3]) && regions.of(h / 3) == regions.of(g / 3));
  return marked;
}

}  // namespace soapfilm
