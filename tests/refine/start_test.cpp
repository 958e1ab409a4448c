#include "soapfilm/refine/topology/start.h"

#include <gtest/gtest.h>

#include <map>
#include <tuple>

#include "refine/band_support.h"
#include "soapfilm/refine/fit/prolong_distance.h"
#include "support/dense.h"
#include "support/problem.h"

namespace soapfilm {
namespace TEST_FILE {

using namespace test;

const Context one_thread(1);

class EverySecondVertex : public testing::TestWithParam<int> {
 protected:
  const Context context{GetParam()};
};

TEST_P(EverySecondVertex, HasTheLabelsOfTheFinerGrid) {
  const Problem problem = make_problem(sampled("knot", 61, 1), 61);
  const Labels fine = labels_of(solve(problem, 0.02, 1e-3).finest, 0.5f, context);
  const Labels coarse = every_second_vertex(fine, context);
  const Dense<uint8_t> expected = dense_labels(fine), found = dense_labels(coarse);
  size_t inside = 0;
  found.for_each([&](Vec3i v) {
    EXPECT_EQ(found[v], expected.get(v * 2)) << v.x << ' ' << v.y << ' ' << v.z;
    inside += found[v] > 0;
    EXPECT_EQ(coarse.box.is_free(v), fine.box.is_free(v * 2));
  });
  EXPECT_GT(inside, 500u);
  EXPECT_LT(coarse.grid.size(), fine.grid.size() / 3);
}

TEST_P(EverySecondVertex, KeepsEverySampleInItsPlace) {
  const GridSamples fine = random_samples(3, 2700, 7);
  GridSamples edge = fine;
  // The last float of a brick that is the upper half of a coarse one.
  edge.local[edge.begin[static_cast<size_t>(edge.bricks.find({1, 1, 1}))]] =
      Vec3f{1, 1, 1} * std::nextafter(8.0f, 0.0f);
  for (const GridSamples& samples : {fine, edge}) {
    const GridSamples coarse = on_every_second_vertex(samples, context);
    ASSERT_EQ(coarse.size(), samples.size());
    const auto listed = [](const GridSamples& of, double scale) {
      std::multimap<std::tuple<float, float, float>, std::pair<Vec3d, uint8_t>> list;  // by direction: all differ
      for (size_t b = 0; b < of.bricks.size(); ++b)
        for (uint32_t s = of.begin[b]; s < of.begin[b + 1]; ++s) {
          const Vec3f local = of.local[s], d = of.direction[s];
          for (const float x : {local.x, local.y, local.z}) {
            EXPECT_GE(x, 0);
            EXPECT_LT(x, brick_side);
          }
          list.insert(
              {{d.x, d.y, d.z}, {(Vec3d(of.bricks.first_vertex(b)) + Vec3d(local)) * scale, of.sample_hash[s]}});
        }
      return list;
    };
    const auto before = listed(samples, 1), after = listed(coarse, 2);
    auto it = after.begin();
    for (const auto& [direction, sample] : before) {
      EXPECT_EQ(it->first, direction);
      EXPECT_LT(norm(it->second.first - sample.first), 1e-5);
      EXPECT_EQ(it->second.second, sample.second);
      ++it;
    }
  }
}

/// A whole band of `bricks`^3 bricks.
NarrowBand whole_band(int bricks) { return random_band(bricks, 1.1, 1); }

template <class Function>
RowArray values_of(const NarrowBand& band, Function&& function) {
  RowArray array = band.make_array();
  for (size_t b = 0; b < band.grid().size(); ++b)
    for_each_vertex(band.grid().coord(b), [&](Vec3i v, int i) {
      const uint32_t row = band.row(static_cast<int32_t>(b), i >> 3 & 7, i >> 6);
      if (band.mask(row) >> (i & 7) & 1)
        array.data()[size_t{row} * brick_side + static_cast<size_t>(i & 7)] = static_cast<float>(function(Vec3d(v)));
    });
  return array;
}

/// Calls visit(vertex, value) for every vertex of a band.
template <class Visit>
void for_each_value(const NarrowBand& band, const RowArray& array, Visit&& visit) {
  for (size_t b = 0; b < band.grid().size(); ++b)
    for_each_vertex(band.grid().coord(b), [&](Vec3i v, int i) {
      const uint32_t row = band.row(static_cast<int32_t>(b), i >> 3 & 7, i >> 6);
      if (band.mask(row) >> (i & 7) & 1)
        visit(v, static_cast<double>(array.data()[size_t{row} * brick_side + static_cast<size_t>(i & 7)]));
    });
}

TEST_P(EverySecondVertex, ProlongedDistancesAreExactForCubics) {
  // Distances in each grid's own voxels: f(2 I) / 2 on the coarse one.
  const auto cubic = [](Vec3d v) {
    const Vec3d q = v * (1 / 16.0) - Vec3d{1, 0.8, 1.2};
    return 3 * q.x * q.x * q.x * q.y - 2 * q.y * q.y * q.z * q.z * q.z + q.x * q.z - q.y + 0.3;
  };
  const auto linear = [](Vec3d v) { return 0.2 * v.x - 0.7 * v.y + 0.4 * v.z - 3; };
  const NarrowBand fine = random_band(4, 0.7, 3), coarse = whole_band(2);
  const auto prolonged = [&](auto&& function) {
    return prolong_distance(coarse, values_of(coarse, [&](Vec3d v) { return function(v * 2.0) / 2; }), fine,
                            values_of(fine, [](Vec3d) { return 99; }), context);
  };
  size_t cubics = 0, kept = 0;
  const RowArray of_cubic = prolonged(cubic), of_linear = prolonged(linear);
  for_each_value(fine, of_cubic, [&](Vec3i v, double value) {
    // An odd vertex reads coarse ones up to three away, of 0 to 15.
    const auto deep = [](int x) { return x % 2 == 0 || (x >= 3 && x <= 27); };
    if (!deep(v.x) || !deep(v.y) || !deep(v.z)) return;
    EXPECT_NEAR(value, cubic(Vec3d(v)), 1e-4) << v.x << ' ' << v.y << ' ' << v.z;
    ++cubics;
  });
  for_each_value(fine, of_linear, [&](Vec3i v, double value) {
    const bool beyond = std::max({v.x, v.y, v.z}) == 31;  // its cell ends where the coarse band ends
    EXPECT_NEAR(value, beyond ? 99 : linear(Vec3d(v)), 1e-4) << v.x << ' ' << v.y << ' ' << v.z;
    kept += beyond;
  });
  EXPECT_GT(cubics, 10000u);
  EXPECT_GT(kept, 1000u);
}

TEST_P(EverySecondVertex, ProlongationNeedsTheCellsCornersAlone) {
  // A coarse band with holes: if all corners of a vertex's cell exist the result is the linear function, elsewhere the
  // value is unchanged.
  const auto linear = [](Vec3d v) { return 0.3 * v.x + 0.1 * v.y - 0.5 * v.z + 1; };
  const NarrowBand fine = whole_band(4), coarse = random_band(2, 0.9, 5);
  Dense<double> there({16, 16, 16});
  for_each_value(coarse, values_of(coarse, linear), [&](Vec3i v, double) { there[v] = 1; });
  const RowArray out = prolong_distance(coarse, values_of(coarse, [&](Vec3d v) { return linear(v * 2.0) / 2; }), fine,
                                        values_of(fine, [](Vec3d) { return 99; }), context);
  size_t met = 0, kept = 0;
  for_each_value(fine, out, [&](Vec3i v, double value) {
    bool whole = true;
    for (int corner = 0; corner < 8; ++corner)
      whole =
          whole && there.get({(v.x + (corner & 1)) / 2, (v.y + (corner >> 1 & 1)) / 2, (v.z + (corner >> 2)) / 2}) > 0;
    EXPECT_NEAR(value, whole ? linear(Vec3d(v)) : 99, 1e-4) << v.x << ' ' << v.y << ' ' << v.z;
    ++(whole ? met : kept);
  });
  EXPECT_GT(met, 10000u);
  EXPECT_GT(kept, 5000u);
}

INSTANTIATE_TEST_SUITE_P(Threads, EverySecondVertex, testing::Values(1, 3), testing::PrintToStringParamName());

}  // namespace TEST_FILE
}  // namespace soapfilm
