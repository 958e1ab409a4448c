#include "soapfilm/relax/half_edges.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <utility>
#include <vector>

#include "relax/grid_torus.h"
#include "soapfilm/core/random.h"
#include "support/flat_sheet.h"
#include "support/thread_ranks.h"

namespace soapfilm {
namespace TEST_FILE {

using namespace test;

/// Closed, and with a border; the numbers of the vertices are mixed, and some are no triangle's.
class HalfEdgesOf : public testing::TestWithParam<bool> {
 protected:
  Mesh mesh = [] {
    Mesh plain = GetParam() ? flat_sheet(6, {}, 1) : grid_torus({}, 4, 1.5, 9, 6);
    Random random(2);
    std::vector<uint32_t> number;
    for (uint32_t v = 0; v < plain.vertices.size() + 9; ++v) number.push_back(v);
    for (size_t k = number.size(); k > 1; --k) std::swap(number[k - 1], number[random.next() % k]);
    Mesh mixed;
    mixed.vertices.resize(number.size());
    for (Triangle t : plain.triangles) {
      for (uint32_t& v : t) v = number[v];
      std::rotate(t.begin(), t.begin() + random.next() % 3, t.end());
      mixed.triangles.push_back(t);
    }
    return mixed;
  }();

  /// The half edge that runs back, of all.
  static uint32_t slow_twin(const HalfEdges& edges, uint32_t h) {
    for (uint32_t other = 0; other < edges.size(); ++other)
      if (edges.from(other) == edges.to(h) && edges.to(other) == edges.from(h)) return other;
    return HalfEdges::none;
  }
  static bool slow_joins(const Mesh& mesh, uint32_t a, uint32_t b) {
    return a != b && std::any_of(mesh.triangles.begin(), mesh.triangles.end(), [&](const Triangle& t) {
             return std::find(t.begin(), t.end(), a) != t.end() && std::find(t.begin(), t.end(), b) != t.end();
           });
  }
  static void expect_right(const HalfEdges& edges) {
    size_t border = 0;
    for (uint32_t h = 0; h < edges.size(); ++h) {
      const Triangle& t = edges.mesh().triangles[h / 3];
      ASSERT_EQ(edges.from(h), t[h % 3]);
      ASSERT_EQ(edges.to(h), t[(h + 1) % 3]);
      ASSERT_EQ(edges.opposite(h), t[(h + 2) % 3]);
      ASSERT_EQ(HalfEdges::next(h) / 3, h / 3);
      ASSERT_EQ(edges.from(HalfEdges::next(h)), edges.to(h));
      ASSERT_EQ(HalfEdges::previous(HalfEdges::next(h)), h);
      ASSERT_EQ(edges.twin(h), slow_twin(edges, h));
      ASSERT_EQ(edges.on_boundary(h), edges.twin(h) == HalfEdges::none);
      if (edges.on_boundary(h))
        ++border;
      else
        ASSERT_NE(edges.upward(h), edges.upward(edges.twin(h)));
    }
    EXPECT_EQ(border, GetParam() ? 4u * 6 : 0u);
  }
};

TEST_P(HalfEdgesOf, TwinsAreThoseOfASearch) { expect_right(HalfEdges(mesh)); }

TEST_P(HalfEdgesOf, RanksFindTheSameTwins) {
  const auto twins_on = [&](const Context& context) {
    Mesh own = mesh;
    const HalfEdges edges(own, context);
    std::vector<uint32_t> twins;
    for (uint32_t h = 0; h < edges.size(); ++h) twins.push_back(edges.twin(h));
    return twins;
  };
  const std::vector<uint32_t> alone = twins_on(Context(1));
  for (uint64_t cut = 1; cut <= 12; ++cut)
    for (const auto& found : on_ranks<std::vector<uint32_t>>(1 + static_cast<int>(cut % 7), 1, {cut}, twins_on))
      EXPECT_EQ(found, alone) << "cut " << cut;
}

TEST_P(HalfEdgesOf, JoinsIsWhetherAnyTriangleHasBoth) {
  const HalfEdges edges(mesh);
  for (uint32_t h = 0; h < edges.size(); ++h)
    for (uint32_t v = 0; v < mesh.vertices.size(); ++v)
      ASSERT_EQ(edges.joins(h, v), slow_joins(mesh, edges.from(h), v)) << h << " " << v;
}

/// An exchange replaces two triangles by those at the other diagonal, turned the same way, under the same numbers.
TEST_P(HalfEdgesOf, FlipsChangeTwoTrianglesAndKeepTwins) {
  HalfEdges edges(mesh);
  Random random(5);
  const auto turned_alike = [](Triangle a, const Triangle& b) {
    for (int k = 0; k < 3; ++k, std::rotate(a.begin(), a.begin() + 1, a.end()))
      if (a == b) return true;
    return false;
  };
  int flips = 0;
  while (flips < 60) {
    const auto h = static_cast<uint32_t>(random.next() % edges.size());
    if (edges.on_boundary(h)) continue;
    const uint32_t back = edges.twin(h), a = edges.from(h), b = edges.to(h), c = edges.opposite(h),
                   d = edges.opposite(back);
    if (c == d || slow_joins(mesh, c, d)) continue;
    std::vector<Triangle> expected = mesh.triangles;
    edges.flip(h);
    ++flips;
    const Triangle &first = mesh.triangles[h / 3], &second = mesh.triangles[back / 3];
    ASSERT_TRUE((turned_alike(first, {d, b, c}) && turned_alike(second, {a, d, c})) ||
                (turned_alike(second, {d, b, c}) && turned_alike(first, {a, d, c})));
    expected[h / 3] = first;
    expected[back / 3] = second;
    ASSERT_EQ(mesh.triangles, expected) << "others stay";
    expect_right(edges);
  }
}

INSTANTIATE_TEST_SUITE_P(ClosedAndOpen, HalfEdgesOf, testing::Bool());

TEST(HalfEdges, OfNothing) {
  Mesh nothing;
  EXPECT_EQ(HalfEdges(nothing).size(), 0u);
}

}  // namespace TEST_FILE
}  // namespace soapfilm
