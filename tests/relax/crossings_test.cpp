#include "soapfilm/relax/crossings.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <set>
#include <vector>

#include "relax/grid_torus.h"
#include "soapfilm/core/random.h"
#include "soapfilm/relax/half_edges.h"
#include "support/flat_sheet.h"

namespace soapfilm {
namespace TEST_FILE {

using namespace test;

using Pairs = std::set<CrossingSearch::Pair>;

/// Whether a segment pierces a triangle; in general position.
bool pierces(Vec3d p, Vec3d q, const std::array<Vec3d, 3>& t) {
  const auto volume = [](Vec3d a, Vec3d b, Vec3d c, Vec3d d) { return dot(b - a, cross(c - a, d - a)); };
  if ((volume(p, t[0], t[1], t[2]) > 0) == (volume(q, t[0], t[1], t[2]) > 0)) return false;
  const bool side = volume(p, q, t[0], t[1]) > 0;
  return (volume(p, q, t[1], t[2]) > 0) == side && (volume(p, q, t[2], t[0]) > 0) == side;
}

/// All pairs of triangles of which an edge of one, at none of the other's corners, pierces the other.
Pairs crossing_pairs(const std::vector<Triangle>& triangles, const std::vector<Vec3d>& at) {
  const auto is_corner = [](const Triangle& t, uint32_t v) { return std::find(t.begin(), t.end(), v) != t.end(); };
  const auto cuts = [&](const Triangle& edges, const Triangle& t) {
    for (size_t k = 0; k < 3; ++k) {
      const uint32_t p = edges[k], q = edges[(k + 1) % 3];
      if (!is_corner(t, p) && !is_corner(t, q) && pierces(at[p], at[q], {at[t[0]], at[t[1]], at[t[2]]})) return true;
    }
    return false;
  };
  std::vector<Box3d> box(triangles.size());
  for (size_t t = 0; t < triangles.size(); ++t)
    for (const uint32_t v : triangles[t]) box[t].extend(at[v]);
  const auto apart = [](const Box3d& a, const Box3d& b) {
    return a.lo.x > b.hi.x || b.lo.x > a.hi.x || a.lo.y > b.hi.y || b.lo.y > a.hi.y || a.lo.z > b.hi.z ||
           b.lo.z > a.hi.z;
  };
  Pairs found;
  for (uint32_t a = 0; a < triangles.size(); ++a)
    for (uint32_t b = a + 1; b < triangles.size(); ++b)
      if (!apart(box[a], box[b]) && (cuts(triangles[a], triangles[b]) || cuts(triangles[b], triangles[a])))
        found.insert({a, b});
  return found;
}

/// A mesh that changes, in some frame: diagonals, then places; some vertices have come somewhere on their way.
class Moving {
 public:
  double voxel;
  Mesh mesh;
  std::vector<Triangle> before;
  std::vector<Vec3d> target, now;

  /// `flips`: tries to change diagonals; one vertex in `every` moves by normal deviates of so many voxels.
  Moving(Mesh start, uint64_t seed, int flips, double deviation, uint64_t every, double voxel = 0.03)
      : voxel(voxel), mesh(std::move(start)) {
    for (Vec3d& v : mesh.vertices) v = v * voxel + Vec3d{-7, 11, 3};
    before = mesh.triangles;
    Random random(seed);
    flip(random, flips);
    for (const Vec3d& v : mesh.vertices) {
      const Vec3d step{random.normal(), random.normal(), random.normal()};
      target.push_back(v + step * (random.next() % every == 0 ? deviation * voxel : 0));
      now.push_back(v + (target.back() - v) * random.uniform());
    }
  }
  CrossingSearch search(const std::vector<uint8_t>& changing, const Context& context) const {
    return {{before, mesh.triangles, mesh.vertices, target, changing}, voxel, context};
  }

 private:
  /// As flip_edges() does: a triangle changes once, and no two are folded over each other.
  void flip(Random& random, int flips) {
    HalfEdges edges(mesh);
    const auto& at = mesh.vertices;
    std::set<uint32_t> changed;
    for (int k = 0; k < flips; ++k) {
      const auto h = static_cast<uint32_t>(random.next() % edges.size());
      if (edges.on_boundary(h)) continue;
      const uint32_t a = edges.from(h), b = edges.to(h), c = edges.opposite(h), d = edges.opposite(edges.twin(h));
      if (c == d || edges.joins(HalfEdges::previous(h), d)) continue;
      const auto normal = [&](uint32_t p, uint32_t q, uint32_t r) { return cross(at[q] - at[p], at[r] - at[p]); };
      bool folds = false;
      for (const Vec3d& fresh : {normal(d, b, c), normal(a, d, c)})
        for (const Vec3d& old : {normal(a, b, c), normal(b, a, d)}) folds |= !(dot(fresh, old) > 0);
      if (folds || changed.count(h / 3) != 0 || changed.count(edges.twin(h) / 3) != 0) continue;
      changed.insert({h / 3, edges.twin(h) / 3});
      edges.flip(h);
    }
  }
};

/// Two tori of about a voxel's triangles, by default so near each other that they meet when they move.
Mesh two_tori(Vec3d apart = {0, 0, 2.6}) {
  Mesh mesh = grid_torus({}, 3.5, 1.2, 18, 8);
  const Mesh other = grid_torus(apart, 3.3, 1.1, 17, 9);
  const auto first = static_cast<uint32_t>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), other.vertices.begin(), other.vertices.end());
  for (const Triangle& t : other.triangles) mesh.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  return mesh;
}

/// An uneven sheet of 36^2 squares, along an axis.
Mesh sheet(int axis, bool back) {
  Mesh mesh = flat_sheet(36, {}, 1);
  Random random(8);
  for (Vec3d& v : mesh.vertices) {
    v.z = 0.1 * random.normal();
    v = permuted(v, axis);
    if (back) v = v * -1.0;  // turned inside out
  }
  return mesh;
}

Pairs distinct(const std::vector<CrossingSearch::Pair>& pairs) { return {pairs.begin(), pairs.end()}; }

TEST(CrossingSearch, FindsThePairsThatBruteForceFinds) {
  const Context context(1);
  size_t all = 0;
  for (const double deviation : {0.2, 0.6, 2.0})
    for (const uint64_t every : {1, 10, 100}) {
      const Moving tori(two_tori(), every, 0, deviation, every);
      EXPECT_TRUE(crossing_pairs(tori.before, tori.mesh.vertices).empty());
      const std::vector<uint8_t> marked(tori.before.size(), 1);
      const CrossingSearch search = tori.search(marked, context);
      for (const auto& places : {tori.now, tori.target}) {
        const Pairs expected = crossing_pairs(tori.mesh.triangles, places);
        EXPECT_EQ(distinct(search.find(places, marked)), expected) << deviation << " " << every;
        all += expected.size();
      }
    }
  EXPECT_GT(all, 1000u);
}

TEST(CrossingSearch, FindsThemWhereDiagonalsChange) {
  const Context context(1);
  size_t all = 0;
  for (const int flips : {50, 400})
    for (const double deviation : {0.3, 1.0}) {
      const Moving tori(two_tori(), static_cast<uint64_t>(flips), flips, deviation, 3);
      const std::vector<uint8_t> marked(tori.before.size(), 1);
      const Pairs expected = crossing_pairs(tori.mesh.triangles, tori.now);
      EXPECT_EQ(distinct(tori.search(marked, context).find(tori.now, marked)), expected) << flips << " " << deviation;
      all += expected.size();
    }
  EXPECT_GT(all, 100u);
}

TEST(CrossingSearch, FindsTheOnlyPairThereIs) {
  const Context context(1);
  const std::vector<Triangle> triangles{{0, 1, 2}, {3, 4, 5}};
  const std::vector<Vec3d> start{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.2, 0.2, 0.3}, {0.3, 0.9, 0.4}, {0.9, 0.3, 0.4}};
  std::vector<Vec3d> target = start;
  target[3].z = -0.2;
  const std::vector<uint8_t> marked(2, 1);
  const CrossingSearch search({triangles, triangles, start, target, marked}, 2, context);  // all in one bin
  EXPECT_TRUE(search.find(start, marked).empty());
  EXPECT_EQ(distinct(search.find(target, marked)), (Pairs{{0, 1}}));
}

/// Where most bins are left out, since all of a sheet looks the same way but for a few folds.
TEST(CrossingSearch, FindsTheFoldsOfASheet) {
  const Context context(1);
  size_t all = 0;
  for (int axis = 0; axis < 3; ++axis)
    for (const bool back : {false, true})
      for (const int flips : {0, 2000}) {
        const Moving folded(sheet(axis, back), static_cast<uint64_t>(axis + 1), flips, 0.7, 20);
        const std::vector<uint8_t> marked(folded.before.size(), 1);
        const Pairs expected = crossing_pairs(folded.mesh.triangles, folded.target);
        EXPECT_EQ(distinct(folded.search(marked, context).find(folded.target, marked)), expected) << axis << back;
        all += expected.size();
      }
  EXPECT_GT(all, 100u);
}

/// Found by lot: the old diagonal 0-1 and the new one 2-3, between them nothing but the tip 4 of a spike on 5,
/// 6, 7. It pierces the new triangles only, but meets them on their way, in bins that only the old ones
/// reach. Elsewhere all look the same way.
TEST(CrossingSearch, FindsWhatTheWayFromTheOldDiagonalsMeets) {
  const Context context(1);
  const std::vector<Triangle> one{{4, 5, 6}, {4, 6, 7}, {4, 7, 5}}, other{{4, 6, 5}, {4, 7, 6}, {4, 5, 7}};
  struct Case {
    std::vector<Vec3d> at;
    std::vector<Triangle> spike;
  };
  const std::vector<Case> cases{{{{5.839, 6.120, 6.235},
                                  {6.582, 3.624, 3.301},
                                  {5.951, 5.009, 6.491},
                                  {4.709, 6.048, 5.391},
                                  {6.102, 4.949, 4.940},
                                  {3.383, 7.444, 7.894},
                                  {6.216, 3.075, 7.784},
                                  {5.114, 4.051, 6.912}},
                                 one},
                                {{{5.151, 4.259, 6.309},
                                  {4.430, 6.273, 3.256},
                                  {6.765, 6.365, 4.793},
                                  {4.478, 3.739, 4.752},
                                  {4.793, 4.499, 5.127},
                                  {6.461, 5.529, 5.869},
                                  {7.155, 2.600, 6.951},
                                  {6.692, 4.054, 2.060}},
                                 other},
                                {{{5.405, 3.230, 5.872},
                                  {6.401, 3.537, 4.382},
                                  {3.132, 5.735, 4.849},
                                  {6.961, 3.843, 4.838},
                                  {5.627, 3.830, 5.060},
                                  {5.005, 7.733, 7.311},
                                  {2.845, 7.545, 6.272},
                                  {7.063, 6.759, 3.611}},
                                 one}};
  for (size_t k = 0; k < cases.size(); ++k) {
    std::vector<Vec3d> at = cases[k].at;
    std::vector<Triangle> before{{0, 1, 2}, {1, 0, 3}}, after{{3, 1, 2}, {0, 3, 2}};
    for (auto* triangles : {&before, &after})
      triangles->insert(triangles->end(), cases[k].spike.begin(), cases[k].spike.end());
    EXPECT_TRUE(crossing_pairs(before, at).empty()) << k;
    const Pairs expected = crossing_pairs(after, at);
    EXPECT_GE(expected.size(), 3u);
    // So many others, far away, that no two bins share a slot of the table of half spaces.
    at.insert(at.end(), {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
    for (auto* triangles : {&before, &after}) triangles->resize(600, {8, 9, 10});
    std::vector<uint8_t> changed(before.size());
    changed[0] = changed[1] = 1;
    const CrossingSearch search({before, after, at, at, changed}, 1, context);
    EXPECT_EQ(distinct(search.find(at, changed)), expected) << k;
  }
}

/// Of the marked triangles all pairs, of others none.
TEST(CrossingSearch, FindsOnlyPairsWithATriangleThatChanged) {
  const Context context(1);
  const Moving tori(two_tori(), 4, 0, 1, 1);
  std::vector<uint8_t> some(tori.before.size());
  for (size_t t = 0; t < some.size(); t += 5) some[t] = 1;
  Pairs expected = crossing_pairs(tori.mesh.triangles, tori.now);
  const size_t all = expected.size();
  std::erase_if(expected, [&](const auto& pair) { return !some[pair[0]] && !some[pair[1]]; });
  EXPECT_LT(expected.size(), all);
  EXPECT_GT(expected.size(), all / 10);
  const std::vector<uint8_t> marked(tori.before.size(), 1);
  EXPECT_EQ(distinct(tori.search(marked, context).find(tori.now, some)), expected);
}

/// Triangles that do not change meet none of their kind: what the search is not asked for it does not look at.
TEST(CrossingSearch, NeedsOnlyTheTrianglesThatMoveToBeMarked) {
  const Context context(1);
  size_t all = 0;
  for (const uint64_t every : {5, 20, 100}) {
    const Moving tori(two_tori(), every, 0, 1.5, every);
    std::vector<uint8_t> moving;
    for (const Triangle& t : tori.mesh.triangles)
      moving.push_back(
          std::any_of(t.begin(), t.end(), [&](uint32_t v) { return !(tori.target[v] == tori.mesh.vertices[v]); }));
    const Pairs expected = crossing_pairs(tori.mesh.triangles, tori.target);
    EXPECT_EQ(distinct(tori.search(moving, context).find(tori.target, moving)), expected) << every;
    all += expected.size();
  }
  EXPECT_GT(all, 50u);
}

TEST(CrossingSearch, FindsThemInBoxesAsLargeAsALatticeMayBe) {
  const Context context(1);
  for (const double voxel : {1e-9, 1.0, 1e6}) {
    const Moving tori(two_tori({20000, 30000, 32000}), 6, 0, 1, 2, voxel);
    const std::vector<uint8_t> marked(tori.before.size(), 1);
    const Pairs expected = crossing_pairs(tori.mesh.triangles, tori.now);
    EXPECT_GT(expected.size(), 50u);
    EXPECT_EQ(distinct(tori.search(marked, context).find(tori.now, marked)), expected) << voxel;
  }
}

TEST(CrossingSearch, GivesTheSamePairsInTheSameOrderOnAnyNumberOfThreads) {
  const Moving tori(two_tori(), 7, 30, 0.8, 1);
  const std::vector<uint8_t> marked(tori.before.size(), 1);
  const auto run = [&](int threads) {
    const Context context(threads);
    return tori.search(marked, context).find(tori.now, marked);
  };
  const auto expected = run(1);
  EXPECT_FALSE(expected.empty());
  for (const auto& [a, b] : expected) EXPECT_LT(a, b);
  for (const int threads : {2, 3, 8}) EXPECT_EQ(run(threads), expected) << threads;
}

}  // namespace TEST_FILE
}  // namespace soapfilm
