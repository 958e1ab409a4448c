#include "soapfilm/orient/sign_tree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <tuple>
#include <vector>

#include "soapfilm/core/box_tree.h"
#include "soapfilm/core/disjoint_sets.h"
#include "soapfilm/core/random.h"
#include "support/sanitized.h"

namespace soapfilm {
namespace TEST_FILE {

/// Sites with planes, their targets and neighbors.
struct Scene {
  Sites sites;
  Targets targets;
  size_t neighbors;
  std::vector<uint32_t> near;
  std::vector<Plane> planes;
  std::vector<uint8_t> takes_part;

  SignGraph graph() const { return {sites, targets, near, neighbors, planes, takes_part}; }
};

/// `every`: so many sites have a target each. `steps`: normals have so many values along each axis; few make ties.
Scene scene(const std::vector<Vec3d>& positions, size_t neighbors, size_t every, int steps) {
  Scene made{Sites(positions, Context(1)), {}, neighbors, {}, {}, {}};
  std::vector<uint8_t> chosen(made.sites.size());
  for (size_t i = 0; i < chosen.size(); ++i) chosen[i] = i % every == 0;
  made.targets = Targets(chosen);
  const BoxTree tree(made.sites.points(), Context(1));
  NearestPoints nearest(neighbors, [&](uint32_t a, uint32_t b) { return made.sites.before(a, b); });
  Random random(8);
  for (size_t t = 0; t < made.targets.size(); ++t) {
    const uint32_t site = made.targets.site(t);
    nearest.restart(site);
    tree.search(made.sites[site], site, nearest);
    made.near.insert(made.near.end(), nearest.found().begin(), nearest.found().end());
    const auto part = [&] { return std::round(random.uniform(-1, 1) * steps) + 0.25; };
    made.planes.push_back({normalized(Vec3d{part(), part(), part()}), 0, 1});
    made.takes_part.push_back(random.uniform() < 0.9);
  }
  return made;
}

std::vector<Vec3d> some_positions(bool grid) {
  constexpr size_t count = test::sanitized ? 400 : 1500;
  Random random(2);
  std::vector<Vec3d> positions;
  for (size_t i = 0; i < count; ++i)
    positions.push_back(grid ? static_cast<Vec3d>(Vec3i{int(i % 40), int(i / 40), 0})
                             : Vec3d{random.uniform(), random.uniform(), 0.1 * random.uniform()});
  return positions;
}

/// Kruskal's algorithm over all edges at once.
SignedSets by_hand(const Scene& s) {
  struct Pair {
    int weight;
    uint32_t a, b;
    size_t rank;
  };
  std::vector<Pair> pairs;
  const auto is_near = [&](uint32_t a, uint32_t b) {
    const auto of_b = s.graph().near_to(b);
    return std::find(of_b.begin(), of_b.end(), s.targets.site(a)) != of_b.end();
  };
  const auto before = [&](uint32_t a, uint32_t b) { return s.sites.before(s.targets.site(a), s.targets.site(b)); };
  for (uint32_t a = 0; a < s.targets.size(); ++a)
    for (size_t rank = 0; rank < s.neighbors; ++rank) {
      const uint32_t b = s.targets.slot(s.graph().near_to(a)[rank]);
      if (b == Targets::none || !s.takes_part[a] || !s.takes_part[b] || (is_near(a, b) && before(b, a))) continue;
      const Vec3d step = s.sites[s.targets.site(b)] - s.sites[s.targets.site(a)];
      const Vec3d &n = s.planes[a].normal, &m = s.planes[b].normal;
      const bool beside = std::max(std::abs(dot(step, n)), std::abs(dot(step, m))) <= 0.7 * norm(step);
      pairs.push_back({static_cast<int>((beside ? 1 - std::abs(dot(n, m)) : 1) * 65535), a, b, rank});
    }
  std::sort(pairs.begin(), pairs.end(), [&](const Pair& p, const Pair& q) {
    if (p.weight != q.weight) return p.weight < q.weight;
    return p.a != q.a ? before(p.a, q.a) : p.rank < q.rank;
  });
  SignedSets sets(s.targets.size());
  for (const Pair& p : pairs) sets.join(p.a, p.b, dot(s.planes[p.a].normal, s.planes[p.b].normal) < 0 ? -1 : 1);
  return sets;
}

TEST(SignTree, OfBlocksIsThatOfAllEdgesOnAnyNumberOfThreads) {
  for (const bool grid : {false, true})
    for (const size_t every : {1, 3})
      for (const int steps : {1, 1000}) {
        const Scene s = scene(some_positions(grid), 7, every, steps);
        SignedSets expected = by_hand(s);
        for (const size_t block : {size_t{1}, size_t{2}, size_t{13}, size_t{200}, size_t{1} << 16})
          for (const int threads : {1, 3}) {
            SignedSets found = spread_signs(s.graph(), Context(threads), block);
            for (uint32_t t = 0; t < s.targets.size(); ++t) {
              const auto a = expected.find(t), b = found.find(t);
              ASSERT_TRUE(a.index == b.index && a.sign == b.sign) << t << ", blocks of " << block << ", grid " << grid;
            }
          }
      }
}

TEST(SignTree, WithoutNeighborsEachIsAlone) {
  const Scene s = scene({{1, 2, 3}}, 0, 1, 1);
  EXPECT_EQ(spread_signs(s.graph(), Context(1)).find(0).index, 0u);
}

}  // namespace TEST_FILE
}  // namespace soapfilm
