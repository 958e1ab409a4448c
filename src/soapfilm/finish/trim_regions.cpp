#include "soapfilm/finish/trim_regions.h"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "soapfilm/core/border_edges.h"
#include "soapfilm/core/disjoint_sets.h"
#include "soapfilm/core/vec.h"
#include "soapfilm/grid/layout.h"

namespace soapfilm {

namespace {

constexpr double membrane_share = 0.1;  // of a mesh's area: larger regions are no holes to fill
constexpr double back_share = 0.5;      // of a region's area, unfaced: more, and it is the back of something
constexpr double few_rays = 3, crossings_per_voxel2 = 0.01;  // more is no accident of a few outliers' rays
constexpr double widest_gap = 3;                             // radius of a disk of a gap's area, in trim distances
constexpr double film_share = 0.16;  // area over the square of the rim: a disk has 0.08, a half sphere 0.16
constexpr double along = 0.7;        // cosine of a gap's mean normal and that of its rim

/// What is known of a region, summed at its root.
struct Region {
  double area = 0, unfaced = 0, crossed = 0;
  double rim = 0;            ///< length, roughly: half of the edges that leave it
  Vec3d normal, rim_normal;  ///< sums over its triangles, and over those around it
  double width = 0;          ///< of the gap in the samples; only where it was asked for
  bool at_border = false;

  void operator+=(const Region& other) {
    area += other.area, unfaced += other.unfaced, crossed += other.crossed, rim += other.rim;
    normal += other.normal, rim_normal += other.rim_normal;
    at_border |= other.at_border;
  }
};

/// The largest distance between two of some points: between those that lie outermost along some directions, which are
/// at most 27 degrees from any other.
double diameter_of(const std::vector<Vec3d>& points) {
  std::vector<Vec3d> outermost;
  for (int slot = 14; slot < 27; ++slot) {  // one of each two opposite ones
    const Vec3d along(slot_offset(slot));
    const auto [low, high] = std::minmax_element(
        points.begin(), points.end(), [&](const Vec3d& a, const Vec3d& b) { return dot(a, along) < dot(b, along); });
    outermost.push_back(*low);
    outermost.push_back(*high);
  }
  double largest = 0;
  for (const Vec3d& a : outermost)
    for (const Vec3d& b : outermost) largest = std::max(largest, norm(a - b));
  return largest;
}

class Regions {
 public:
  Regions(const Mesh& mesh, const TrimLevels& levels, const std::vector<uint32_t>& crossings)
      : mesh_(mesh), levels_(levels), sets_(levels.level.size()), at_(levels.level.size()) {
    for (const Triangle& t : mesh.triangles) add(t);
    mark_border();
    for (uint32_t v = 0; v < crossings.size(); ++v) at_[v].crossed += crossings[v];
    for (uint32_t v = 0; v < at_.size(); ++v)
      if (const uint32_t root = sets_.root(v); far(v) && root != v) at_[root] += at_[v];
  }

  /// Sets all widths; `distance`: of the cut.
  void measure_widths(double distance) {
    std::vector<std::pair<uint32_t, uint32_t>> rim;  // root, vertex
    for (const Triangle& t : mesh_.triangles)
      for (const uint32_t v : t)
        if (far(v) && std::any_of(t.begin(), t.end(), [&](uint32_t w) { return !far(w); }))
          rim.emplace_back(sets_.root(v), v);
    std::sort(rim.begin(), rim.end());
    rim.erase(std::unique(rim.begin(), rim.end()), rim.end());
    for (uint32_t v = 0; v < at_.size(); ++v)
      if (far(v)) at_[v].width = 2 * distance;
    for (size_t begin = 0, end = 0; begin < rim.size(); begin = end) {
      std::vector<Vec3d> places;
      for (end = begin; end < rim.size() && rim[end].first == rim[begin].first; ++end)
        places.push_back(mesh_.vertices[rim[end].second]);
      at_[rim[begin].first].width += diameter_of(places);
    }
  }

  bool far(uint32_t v) const { return levels_.level[v] > 1; }
  uint32_t root(uint32_t v) { return sets_.root(v); }
  const Region& operator[](uint32_t root) const { return at_[root]; }
  double whole() const { return whole_; }

 private:
  void add(const Triangle& t) {
    const auto place = [&](size_t k) { return mesh_.vertices[t[k]]; };
    const Vec3d normal = cross(place(1) - place(0), place(2) - place(0)) / 2.0;
    const double area = norm(normal);
    whole_ += area;
    size_t far_corners = 0;
    for (const uint32_t v : t) far_corners += far(v);
    if (far_corners == 0) return;
    for (size_t k = 0; k < 3; ++k) {
      const uint32_t a = t[k], b = t[(k + 1) % 3];
      if (far(a) && far(b)) sets_.join(a, b);
      if (!far(a)) continue;
      Region& region = at_[a];
      region.area += area / 3;
      if (!levels_.unfaced.empty() && levels_.unfaced[a]) region.unfaced += area / 3;
      region.normal += normal / 3.0;
      if (far_corners == 3) continue;
      const double share = 1.0 / static_cast<double>(far_corners);
      region.rim_normal += normal * share;
      region.rim += share * across(t);
    }
  }

  /// Length of the rim in a triangle that it crosses: between the middles of two of its edges, half of the third.
  double across(const Triangle& t) const {
    for (size_t k = 0; k < 3; ++k) {
      const uint32_t a = t[k], b = t[(k + 1) % 3], c = t[(k + 2) % 3];
      if (far(a) == far(b) && far(a) != far(c)) return norm(mesh_.vertices[a] - mesh_.vertices[b]) / 2;
    }
    return 0;
  }

  /// Regions with a vertex on an edge of one triangle alone.
  void mark_border() {
    for (const auto& [a, b] : border_edges(mesh_, [&](uint32_t v) { return far(v); }))
      for (const uint32_t v : {a, b})
        if (far(v)) at_[v].at_border = true;
  }

  const Mesh& mesh_;
  const TrimLevels& levels_;
  DisjointSets sets_;
  std::vector<Region> at_;  // of each far vertex, then of each root
  double whole_ = 0;
};

bool is_crossed(const Region& region, double voxel) {
  return region.crossed > std::max(few_rays, crossings_per_voxel2 * region.area / (voxel * voxel));
}

bool is_narrow(const Region& region, const RegionRules& rules) {
  if (rules.widest) return region.width <= *rules.widest;
  constexpr double pi = 3.141592653589793;
  const double radius = widest_gap * rules.distance;
  return region.area <= pi * radius * radius;
}

bool fills_gap(const Region& region, const RegionRules& rules) {
  if (region.at_border || !is_narrow(region, rules)) return false;
  if (region.unfaced > back_share * region.area || is_crossed(region, rules.voxel)) return false;
  if (region.area > film_share * region.rim * region.rim) return false;
  return dot(region.normal, region.rim_normal) > along * norm(region.normal) * norm(region.rim_normal);
}

}  // namespace

bool choose_regions(const Mesh& mesh, TrimLevels& levels, const std::vector<uint32_t>& crossings,
                    const RegionRules& rules, TrimReport& report) {
  Regions regions(mesh, levels, crossings);
  if (rules.widest) regions.measure_widths(rules.distance);
  const auto goes = [&](const Region& region) {
    if (rules.holes) return true;
    if (rules.open) return !fills_gap(region, rules);
    return rules.widest ? !is_narrow(region, rules) : region.area > membrane_share * regions.whole();
  };
  std::vector<double> chosen = levels.level;
  for (uint32_t v = 0; v < chosen.size(); ++v) {
    if (!regions.far(v)) continue;
    const uint32_t root = regions.root(v);
    const Region& region = regions[root];
    const bool removed = goes(region);
    if (!removed) chosen[v] = 0;
    if (root != v) continue;
    ++(removed ? report.removed : report.filled);
    report.unfaced += removed && region.unfaced > back_share * region.area;
    report.crossed += removed && is_crossed(region, rules.voxel);
  }
  levels.level = std::move(chosen);
  return report.removed > 0;
}

}  // namespace soapfilm
