#include "soapfilm/field/samples.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "soapfilm/core/random.h"
#include "support/problem.h"
#include "support/shuffled.h"

namespace soapfilm {
namespace TEST_FILE {

using namespace test;

TEST(Samples, EachIsInItsBrickByItsPlace) {
  const PointCloud cloud = sampled("part", 48, 1);
  const Problem problem = make_problem(cloud, 48);
  const GridSamples& samples = problem.samples;
  ASSERT_EQ(samples.size(), cloud.size());
  std::vector<bool> seen(cloud.size(), false);
  for (size_t b = 0; b < samples.bricks.size(); ++b) {
    EXPECT_LT(samples.begin[b], samples.begin[b + 1]) << "a brick without samples";
    for (uint32_t s = samples.begin[b]; s < samples.begin[b + 1]; ++s) {
      const uint32_t i = samples.source[s];
      EXPECT_FALSE(seen[i]);
      seen[i] = true;
      EXPECT_TRUE(s == samples.begin[b] || samples.local[s - 1].z <= samples.local[s].z);
      const Vec3d position = problem.lattice.to_lattice(cloud.positions[i]);
      const Vec3d stored = Vec3d(samples.bricks.first_vertex(b)) + Vec3d(samples.local[s]);
      for (int axis = 0; axis < 3; ++axis) {
        EXPECT_NEAR(stored[axis], position[axis], 1e-6);
        EXPECT_TRUE(samples.local[s][axis] >= 0 && samples.local[s][axis] <= brick_side);
      }
    }
  }
}

TEST(Samples, WithoutADirectionOrWeightSayNothing) {
  PointCloud cloud = sampled("sphere", 40, 1);
  const size_t all = cloud.size();
  cloud.normals[3] = {};
  cloud.weights.assign(all, 2.0f);
  cloud.weights[5] = 0;
  const Problem problem = make_problem(cloud, 40);
  EXPECT_EQ(problem.samples.size(), all - 2);
  for (const uint32_t i : problem.samples.source) EXPECT_TRUE(i != 3 && i != 5);
  EXPECT_EQ(problem.samples.direction[0], cloud.normals[problem.samples.source[0]] * 2.0f);
}

/// A weight of 3 is three samples at one place, in the data term as in whatever counts samples.
TEST(Samples, AWeightIsSoManySamples) {
  PointCloud weighted = sampled("part", 40, 1);
  weighted.scans.clear();
  PointCloud repeated;
  for (size_t i = 0; i < weighted.size(); ++i) {
    const size_t times = 1 + i % 3;
    weighted.weights.push_back(static_cast<float>(times));
    repeated.positions.insert(repeated.positions.end(), times, weighted.positions[i]);
    repeated.normals.insert(repeated.normals.end(), times, weighted.normals[i]);
  }
  const Problem few = make_problem(weighted, 40), many = make_problem(repeated, few.lattice);
  double counted = 0;
  for (size_t s = 0; s < few.samples.size(); ++s) counted += static_cast<double>(few.samples.weight_of(s));
  EXPECT_EQ(counted, static_cast<double>(many.samples.size()));
  ASSERT_EQ(few.support.grid.size(), many.support.grid.size());
  float largest = 0;
  for (size_t b = 0; b < few.support.grid.size(); ++b)
    for (size_t i = 0; i < brick_volume; ++i) {
      largest = std::max(largest, std::abs(many.support.f.brick(b)[i]));
      ASSERT_NEAR(few.support.f.brick(b)[i], many.support.f.brick(b)[i], 1e-5);
    }
  EXPECT_GT(largest, 0.1f);
}

/// What a sample pulls in the data term is weighed by its area, too; as a sample it counts as before.
TEST(Samples, WeighingDirectionsChangesNoCount) {
  PointCloud cloud = sampled("sphere", 40, 1);
  cloud.weights.assign(cloud.size(), 3.0f);
  GridSamples samples = make_problem(cloud, 40).samples;
  const std::vector<float> before = samples.weight;
  for (const int threads : {1, 3})
    samples.weigh_directions(Context(threads), [](size_t s) { return s % 2 ? 2.0f : 0.5f; });
  EXPECT_EQ(samples.weight, before);
  for (size_t s = 0; s < samples.size(); ++s)
    ASSERT_EQ(samples.direction[s], cloud.normals[samples.source[s]] * 3.0f * (s % 2 ? 4.0f : 0.25f));
}

/// Counted in several chunks, the order is the same; a part of the samples is what is left of it.
TEST(Samples, AreSortedAlikeByAnyNumberOfThreads) {
  const PointCloud cloud = sampled("knot", 40, 20);
  const Lattice lattice = lattice_of(cloud, 40);
  const GridSamples one = sort_samples(cloud, cloud.normals, lattice, Context(1));
  for (size_t s = 0; s < one.size(); ++s)
    ASSERT_EQ(one.sample_hash[s], sample_hash_of(cloud.positions[one.source[s]], cloud.box()));
  const auto third = [](size_t i) { return i % 3 == 0; };
  for (const int threads : {2, 3, 8}) {
    const GridSamples many = sort_samples(cloud, cloud.normals, lattice, Context(threads));
    EXPECT_EQ(many.begin, one.begin);
    EXPECT_EQ(many.source, one.source);
    EXPECT_EQ(many.local, one.local);
    EXPECT_EQ(many.direction, one.direction);
    const GridSamples part = sort_samples(cloud, cloud.normals, lattice, Context(threads), third);
    std::vector<uint32_t> expected;
    for (const uint32_t i : one.source)
      if (third(i)) expected.push_back(i);
    EXPECT_EQ(part.source, expected);
  }
}

TEST(Samples, AreSortedAlikeWhereTheyMayBeOnDisk) {
  const PointCloud cloud = sampled("knot", 40, 20);
  const Lattice lattice = lattice_of(cloud, 40);
  const GridSamples one = sort_samples(cloud, cloud.normals, lattice, Context(1));
  for (const size_t limit : {1, 100'000, 1'000'000, 1'000'000'000}) {
    Context context(2);
    context.set_scratch_folder("/tmp");
    context.limit_memory(limit);
    const GridSamples some = sort_samples(cloud, cloud.normals, lattice, context);
    EXPECT_EQ(some.begin, one.begin);
    EXPECT_EQ(some.source, one.source);
    EXPECT_EQ(some.local, one.local);
    EXPECT_EQ(some.direction, one.direction);
    EXPECT_EQ(some.sample_hash, one.sample_hash);
  }
}

/// Positions, directions and weights of a brick's samples are the same ones in whatever order a cloud has them.
TEST(Samples, AreSortedAlikeInAnyOrderOfTheCloud) {
  PointCloud cloud = sampled("knot", 40, 20);
  Random random(5);
  for (size_t i = 0; i < cloud.size(); ++i) cloud.weights.push_back(static_cast<float>(1 + random.uniform()));
  for (size_t i = 0; i < 200; ++i) {  // some at one place, of which some differ in nothing, some in their directions
    cloud.positions[2 * i] = cloud.positions[0];
    if (i % 2 == 0) cloud.normals[2 * i] = cloud.normals[0], cloud.weights[2 * i] = cloud.weights[0];
  }
  const Lattice lattice = lattice_of(cloud, 40);
  const GridSamples one = sort_samples(cloud, cloud.normals, lattice, Context(1));
  for (const uint64_t seed : {1, 2}) {
    const PointCloud other = shuffled(cloud, seed);
    const GridSamples many = sort_samples(other, other.normals, lattice, Context(2));
    EXPECT_NE(many.source, one.source);
    EXPECT_EQ(many.begin, one.begin);
    EXPECT_EQ(many.local, one.local);
    EXPECT_EQ(many.direction, one.direction);
    EXPECT_EQ(many.weight, one.weight);
    EXPECT_EQ(many.sample_hash, one.sample_hash);
  }
}

/// Three quarters of the samples are fitted, one is held out: two bits of the lots are even, and independent of those
/// of the next place on a line.
TEST(Samples, HashBitsAreEven) {
  constexpr size_t count = 60'000;
  Box3d box;
  box.extend(Vec3d{0, 0, 0});
  box.extend(Vec3d{1, 1, 1});
  for (const Vec3d along : {Vec3d{1, 0, 0}, Vec3d{0, 0, 1}, Vec3d{1, 1, 0}, Vec3d{1, 1, 1}}) {
    const auto lot = [&](size_t i) {
      return sample_hash_of(along * ((static_cast<double>(i) + 0.5) / 65536), box) & 3;
    };
    std::array<size_t, 4> found{}, after_zero{};
    for (size_t i = 0; i < count; ++i) {
      ++found[lot(i)];
      if (i > 0 && lot(i - 1) == 0) ++after_zero[lot(i)];
    }
    for (size_t k = 0; k < 4; ++k) {
      EXPECT_NEAR(static_cast<double>(found[k]), count / 4.0, 5 * std::sqrt(count * 3 / 16.0));
      EXPECT_NEAR(static_cast<double>(after_zero[k]), count / 16.0, 5 * std::sqrt(count * 15 / 256.0));
    }
  }
}

/// Offsets of 5e6 with detail of 1e-3: the grid sees the same samples.
TEST(Samples, GeoreferencedCoordinatesLoseNothing) {
  PointCloud near = sampled("part", 48, 1);
  // Multiples of 2^-20 are exact at either place.
  for (Vec3d& p : near.positions)
    for (int axis = 0; axis < 3; ++axis) p[axis] = std::round(p[axis] * 0x1p20) * 0x1p-20;
  const Vec3d offset{5e6, -4e6, 3e6};
  const PointCloud far = transformed(
      near, [&](Vec3d p) { return p + offset; }, [](Vec3f n) { return n; });
  const Problem a = make_problem(near, place_lattice(near.box(), 0x1p-5, 6));
  const Problem b = make_problem(far, place_lattice(far.box(), 0x1p-5, 6));
  EXPECT_EQ(a.lattice.size, b.lattice.size);
  EXPECT_EQ(a.samples.local, b.samples.local);
  EXPECT_EQ(a.samples.source, b.samples.source);
}

/// The samples of some bricks are those that a cloud of them alone would have there, with all of their columns.
TEST(Samples, OfSomeBricksKeepTheirColumns) {
  PointCloud cloud = sampled("part", 40, 1);
  Random random(3);
  for (size_t i = 0; i < cloud.size(); ++i) cloud.weights.push_back(static_cast<float>(1 + random.uniform()));
  const Problem problem = make_problem(cloud, 40);
  const GridSamples& all = problem.samples;
  BrickMask chosen(all.bricks.bricks());
  for (size_t b = 0; b < all.bricks.size(); ++b)
    if (random.uniform() < 0.4) chosen.set(all.bricks.coord(b));
  chosen.set({0, 0, 0});  // without samples
  for (const int threads : {1, 3}) {
    const GridSamples some = all.in(BrickGrid(chosen, Context(threads)), Context(threads));
    size_t next = 0;
    for (size_t b = 0; b < some.bricks.size(); ++b) {
      ASSERT_EQ(some.begin[b], next);
      const int32_t n = all.bricks.find(some.bricks.coord(b));
      if (n < 0) continue;
      for (uint32_t s = all.begin[static_cast<size_t>(n)]; s < all.begin[static_cast<size_t>(n) + 1]; ++s, ++next) {
        ASSERT_EQ(some.local[next], all.local[s]);
        ASSERT_EQ(some.direction[next], all.direction[s]);
        ASSERT_EQ(some.weight[next], all.weight[s]);
        ASSERT_EQ(some.source[next], all.source[s]);
        ASSERT_EQ(some.sample_hash[next], all.sample_hash[s]);
      }
    }
    EXPECT_EQ(some.size(), next);
    EXPECT_GT(next, all.size() / 10);
    EXPECT_LT(next, all.size());
  }
}

}  // namespace TEST_FILE
}  // namespace soapfilm
