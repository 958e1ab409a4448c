#include "soapfilm/core/box_tree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "soapfilm/core/random.h"
#include "support/sanitized.h"

namespace soapfilm {
namespace TEST_FILE {

using Points = std::vector<Vec3d>;

double squared(Vec3d a, Vec3d b) { return dot(a - b, a - b); }

/// Clouds whose boxes, distances or ties are awkward.
std::vector<std::pair<std::string, Points>> clouds() {
  constexpr size_t count = test::sanitized ? 300 : 1000;
  Random random(4);
  const auto made = [&](const std::function<Vec3d(size_t)>& place) {
    Points points;
    for (size_t i = 0; i < count; ++i) points.push_back(place(i));
    return points;
  };
  const auto in_cube = [&] { return Vec3d{random.uniform(), random.uniform(), random.uniform()}; };
  return {{"none", {}},
          {"one", {{1, 2, 3}}},
          {"fewer than asked for", {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}},
          {"cube", made([&](size_t) { return in_cube(); })},
          {"line", made([&](size_t) {
             return Vec3d{random.uniform(), 0, 0};
           })},
          {"grid", made([&](size_t i) {
             return static_cast<Vec3d>(Vec3i{int(i % 10), int(i / 10 % 10), int(i / 100)});
           })},
          {"copies", made([&](size_t i) {
             return static_cast<Vec3d>(Vec3i{int(i % 3), int(i % 5), 0});
           })},
          {"dense cluster far from a sparse one", made([&](size_t i) {
             return i % 10 == 0 ? in_cube() * 1e9 : in_cube() * 1e-3 + Vec3d{4e9, -1e9, 1};
           })},
          {"beyond the floats", made([&](size_t i) { return in_cube() * (i % 3 == 0 ? -1e100 : 1e100); })}};
}

/// As neighbors are looked for, by comparing with all points.
template <class Before>
std::vector<uint32_t> nearest_by_hand(const Points& points, Vec3d p, size_t most, uint32_t excluded, Before before) {
  std::vector<uint32_t> all;
  for (uint32_t i = 0; i < points.size(); ++i)
    if (i != excluded) all.push_back(i);
  std::sort(all.begin(), all.end(), [&](uint32_t a, uint32_t b) {
    const double to_a = squared(p, points[a]), to_b = squared(p, points[b]);
    return to_a != to_b ? to_a < to_b : before(a, b);
  });
  all.resize(std::min(all.size(), most));
  return all;
}

TEST(BoxTree, FindsTheNearestPointsInTheirOrder) {
  const auto by_index = [](uint32_t a, uint32_t b) { return a < b; };
  const auto by_lot = [](uint32_t a, uint32_t b) { return Random(a).next() < Random(b).next(); };
  const auto check = [](const std::string& name, const Points& points, auto before) {
    const BoxTree tree(points, Context(2));
    for (const size_t most : {1, 16, 40}) {
      NearestPoints nearest(most, before);
      for (uint32_t i = 0; i < points.size(); i += 7) {
        nearest.restart(i);
        tree.search(points[i], i, nearest);
        const std::vector<uint32_t> found(nearest.found().begin(), nearest.found().end());
        ASSERT_EQ(found, nearest_by_hand(points, points[i], most, i, before)) << name << ", " << most << " of " << i;
      }
    }
  };
  for (const auto& [name, points] : clouds()) {
    check(name, points, by_index);
    check(name, points, by_lot);
  }
}

TEST(BoxTree, FindsTheSameFromWhereverItStarts) {
  const auto by_index = [](uint32_t a, uint32_t b) { return a < b; };
  for (const auto& [name, points] : clouds()) {
    const BoxTree tree(points, Context(1));
    NearestPoints nearest(12, by_index);
    const Vec3d elsewhere{0.3, 0.7, -2};
    const auto expected = nearest_by_hand(points, elsewhere, 12, ~uint32_t{0}, by_index);
    for (size_t start = 0; start <= points.size(); start += 11) {
      nearest.restart();
      tree.search(elsewhere, start, nearest);
      ASSERT_EQ(std::vector<uint32_t>(nearest.found().begin(), nearest.found().end()), expected) << name;
    }
  }
}

TEST(BoxTree, ShowsAllPointsWithinALimit) {
  struct Within {
    double most;
    std::vector<uint32_t> found;
    double limit() const { return most; }
    void add(uint32_t i, double to) {
      EXPECT_LE(to, most);
      found.push_back(i);
    }
  };
  for (const auto& [name, points] : clouds())
    for (const double most : {0.0, 1e-8, 0.04, 2.0, 1e300}) {
      const BoxTree tree(points, Context(1));
      for (uint32_t i = 0; i < points.size(); i += 50) {
        Within within{most, {}};
        tree.search(points[i], i, within);
        std::sort(within.found.begin(), within.found.end());
        std::vector<uint32_t> expected;
        for (uint32_t k = 0; k < points.size(); ++k)
          if (squared(points[i], points[k]) <= most) expected.push_back(k);
        ASSERT_EQ(within.found, expected) << name << ", " << most;
      }
    }
}

}  // namespace TEST_FILE
}  // namespace soapfilm
