#include "soapfilm/finish/hole_list.h"

#include <algorithm>
#include <utility>

#include "soapfilm/core/border_edges.h"
#include "soapfilm/core/disjoint_sets.h"
#include "soapfilm/core/vec.h"

namespace soapfilm {

namespace {

/// What is known of a region, at its root.
struct UnseenRegion {
  double area = 0;
  Vec3d moment;  // sum of centers by area
  bool cut = false, at_border = false;
};

class UnseenRegions {
 public:
  UnseenRegions(const Mesh& mesh, const std::vector<uint8_t>& unseen, const std::vector<uint8_t>& cut)
      : mesh_(mesh), unseen_(unseen), sets_(unseen.size()), at_(unseen.size()), origin_(mesh.box().center()) {
    for (const Triangle& t : mesh.triangles)
      for (size_t k = 0; k < 3; ++k)
        if (unseen_[t[k]] && unseen_[t[(k + 1) % 3]]) sets_.join(t[k], t[(k + 1) % 3]);
    for (const Triangle& t : mesh.triangles) add(t);
    for (uint32_t v = 0; v < cut.size(); ++v)
      if (unseen_[v] && cut[v]) at_[sets_.root(v)].cut = true;
    mark_border();
    std::sort(rims_.begin(), rims_.end());
    rims_.erase(std::unique(rims_.begin(), rims_.end()), rims_.end());
  }

  std::vector<HoleFacts> list() {
    std::vector<std::pair<uint32_t, uint32_t>> inner;  // root and vertex
    for (uint32_t v = 0; v < unseen_.size(); ++v)
      if (unseen_[v]) inner.emplace_back(sets_.root(v), v);
    std::sort(inner.begin(), inner.end());
    std::vector<HoleFacts> holes;
    for (size_t begin = 0, end = 0; begin < inner.size(); begin = end) {
      const uint32_t root = inner[begin].first;
      while (end < inner.size() && inner[end].first == root) ++end;
      const UnseenRegion& region = at_[root];
      if (region.at_border || !(region.area > 0)) continue;
      const auto rim = std::equal_range(rims_.begin(), rims_.end(), std::pair(root, 0U),
                                        [](const auto& a, const auto& b) { return a.first < b.first; });
      const double diameter = rim.first != rim.second ? extent(&*rim.first, &*rim.first + (rim.second - rim.first))
                                                      : extent(inner.data() + begin, inner.data() + end);
      holes.push_back({origin_ + region.moment / region.area, diameter, region.area, region.cut});
    }
    std::stable_sort(holes.begin(), holes.end(),
                     [](const HoleFacts& a, const HoleFacts& b) { return a.area > b.area; });
    return holes;
  }

 private:
  void add(const Triangle& t) {
    size_t corners = 0;
    for (const uint32_t v : t) corners += unseen_[v];
    if (corners == 0) return;
    const Vec3d a = mesh_.vertices[t[0]] - origin_, b = mesh_.vertices[t[1]] - origin_,
                c = mesh_.vertices[t[2]] - origin_;
    const double area = norm(cross(b - a, c - a)) / 2;
    for (const uint32_t v : t) {
      if (!unseen_[v]) continue;
      const uint32_t root = sets_.root(v);
      at_[root].area += area / 3;
      at_[root].moment += (a + b + c) * (area / 9);
      for (const uint32_t other : t)
        if (!unseen_[other]) rims_.emplace_back(root, other);
    }
  }

  void mark_border() {
    for (const auto& [a, b] : border_edges(mesh_, [&](uint32_t v) { return unseen_[v] != 0; }))
      for (const uint32_t v : {a, b})
        if (unseen_[v]) at_[sets_.root(v)].at_border = true;
  }

  /// Of some vertices: from the one that is farthest from the first, to the one that is farthest from that.
  double extent(const std::pair<uint32_t, uint32_t>* begin, const std::pair<uint32_t, uint32_t>* end) const {
    Vec3d from = mesh_.vertices[begin->second];
    double longest = 0;
    for (int turn = 0; turn < 2; ++turn) {
      Vec3d farthest = from;
      longest = 0;
      for (const auto* at = begin; at != end; ++at)
        if (const double length = norm(mesh_.vertices[at->second] - from); length > longest) {
          longest = length;
          farthest = mesh_.vertices[at->second];
        }
      from = farthest;
    }
    return longest;
  }

  const Mesh& mesh_;
  const std::vector<uint8_t>& unseen_;
  DisjointSets sets_;
  std::vector<UnseenRegion> at_;
  std::vector<std::pair<uint32_t, uint32_t>> rims_;  // root of a region, and a seen vertex beside it
  Vec3d origin_;
};

}  // namespace

std::vector<HoleFacts> list_holes(const Mesh& mesh, const std::vector<uint8_t>& unseen,
                                  const std::vector<uint8_t>& cut) {
  return UnseenRegions(mesh, unseen, cut).list();
}

}  // namespace soapfilm
