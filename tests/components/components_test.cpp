#include "soapfilm/components/components.h"

#include <gtest/gtest.h>

#include <cmath>
#include <span>
#include <vector>

#include "components/drawn_level.h"
#include "soapfilm/components/parts.h"
#include "soapfilm/core/random.h"
#include "soapfilm/error.h"
#include "soapfilm/reconstruct.h"
#include "support/hash.h"
#include "support/problem.h"
#include "support/random_level.h"
#include "support/thread_ranks.h"

namespace soapfilm {
namespace TEST_FILE {

using namespace test;

struct Ball {
  Vec3d center;
  double radius;
  int samples;  ///< on it, looking out; into it when it is a void
  bool inside = true;
};

/// Balls drawn one over the other, one unit of length per voxel, and samples on them.
struct Drawing {
  Lattice lattice;
  Labels labels;
  GridSamples samples;

  explicit Drawing(const std::vector<Ball>& balls) {
    lattice.size = {80, 60, 60};
    const Level level = drawn_level(lattice.box(0), true, [&](Vec3i v) {
      bool inside = false;
      for (const Ball& ball : balls)
        if (norm(Vec3d(v) - ball.center) < ball.radius) inside = ball.inside;
      return inside;
    });
    labels = labels_of(level, 0.5f, Context(1));
    PointCloud cloud;
    Random random(7);
    for (const Ball& ball : balls)
      for (int i = 0; i < ball.samples; ++i) {
        const Vec3d n = normalized(Vec3d{random.normal(), random.normal(), random.normal()});
        cloud.positions.push_back(lattice.to_world(ball.center + n * (ball.radius - 0.5)));
        cloud.normals.push_back(Vec3f(ball.inside ? n : -n));
      }
    samples = sort_samples(cloud, cloud.normals, lattice, Context(1));
  }

  ComponentReport drop(const ComponentParams& params = {}, double density = 1, int threads = 2) {
    ComponentReport report;
    drop_components(labels, samples, density, {params}, Context(threads), report);
    return report;
  }
  bool inside(Vec3d v) const { return dense_labels(labels)[Vec3i(v)] != 0; }
};

constexpr double big_radius = 20;
constexpr int big_samples = 5000;  // one per voxel^2
const Ball big{{30, 30, 30}, big_radius, big_samples};

TEST(Components, AreDroppedForLackOfSamplesAndSamplesPerArea) {
  // Of radius 5: 314 voxel^2.
  const Vec3d center{64, 30, 30};
  const auto dropped = [&](int count, const ComponentParams& params) {
    Drawing drawing({big, {center, 5, count}});
    const ComponentReport report = drawing.drop(params);
    EXPECT_TRUE(drawing.inside(big.center));
    EXPECT_EQ(drawing.inside(center), report.objects.dropped == 0);
    EXPECT_EQ(report.objects.kept + report.objects.dropped, 2u);
    return report.objects.dropped == 1;
  };
  EXPECT_TRUE(dropped(0, {}));
  EXPECT_TRUE(dropped(30, {})) << "a tenth of what its area asks for";
  EXPECT_FALSE(dropped(90, {}));
  EXPECT_TRUE(dropped(90, {.min_support = 0.5}));
  EXPECT_FALSE(dropped(200, {.min_support = 2})) << "many samples";
  EXPECT_TRUE(dropped(200, {.min_support = 2, .many_samples = 500}));
  EXPECT_TRUE(dropped(200, {.min_support = 2, .sparse_support = 1}));
  EXPECT_FALSE(dropped(9, {.min_support = 0}));
  EXPECT_TRUE(dropped(9, {.min_support = 0, .few_samples = 10}));
}

TEST(Components, ASparselySampledObjectIsKeptForItsManySamples) {
  // 1 sample per 10 voxel^2, on a surface of 1250 voxel^2; the other has 1 per voxel^2.
  Drawing drawing({{{24, 30, 30}, 15, 2800}, {{60, 30, 30}, 10, 125}});
  EXPECT_EQ(drawing.drop().objects.dropped, 0u);
  EXPECT_EQ(drawing.drop({.sparse_support = 0.05}).objects.dropped, 0u);
  EXPECT_EQ(drawing.drop({.sparse_support = 0.2}).objects.dropped, 1u);
  Drawing again({{{24, 30, 30}, 15, 2800}, {{60, 30, 30}, 10, 125}});
  EXPECT_EQ(again.drop({.many_samples = 130}).objects.dropped, 1u);
}

TEST(Components, SamplesCountByTheirWeight) {
  Drawing drawing({big, {{64, 30, 30}, 5, 30}});
  for (size_t s = 0; s < drawing.samples.size(); ++s)
    if (drawing.samples.source[s] >= big_samples) drawing.samples.direction[s] = 5.0f * drawing.samples.direction[s];
  EXPECT_EQ(drawing.drop().objects.dropped, 0u);
}

TEST(Components, CavitiesAreFilledUnlessTheyAreSampled) {
  const Vec3d bubble{22, 30, 30}, hollow{38, 30, 30};
  Drawing drawing({big, {bubble, 4, 6, false}, {hollow, 6, 300, false}});
  const ComponentReport report = drawing.drop();
  EXPECT_EQ(report.cavities.dropped, 1u);
  EXPECT_EQ(report.cavities.kept, 1u);
  EXPECT_EQ(report.objects.dropped, 0u);
  EXPECT_TRUE(drawing.inside(bubble));
  EXPECT_FALSE(drawing.inside(hollow));
}

TEST(Components, SamplesThatLookTheWrongWayDoNotCount) {
  Drawing drawing({big, {{64, 30, 30}, 5, 300}});
  for (Vec3f& direction : drawing.samples.direction)
    if (direction.x != 0) direction = -direction;
  // All look inwards now: the part with most samples, none, is the first.
  EXPECT_EQ(drawing.drop().objects.kept, 1u);
}

/// What lies in a dropped part goes with it: no void stays where an island of a bubble was.
TEST(Components, WithinADroppedCavityAreDroppedWithIt) {
  Drawing drawing({big, {{30, 30, 30}, 12, 3, false}, {{30, 30, 30}, 5, 2}});
  const ComponentReport report = drawing.drop();
  EXPECT_EQ(report.cavities.dropped, 1u);
  EXPECT_EQ(report.objects.dropped, 1u);
  EXPECT_EQ(Parts(drawing.labels, Context(1)).size(), 2u);
  EXPECT_TRUE(drawing.inside({30, 30, 30}));
  EXPECT_TRUE(drawing.inside({30, 30, 40}));
}

TEST(Components, OneObjectIsAlwaysKept) {
  Drawing drawing({big, {{64, 30, 30}, 5, 300}});
  const ComponentReport report = drawing.drop({.min_support = 1e9, .many_samples = 1000000});
  EXPECT_EQ(report.objects.kept, 1u);
  EXPECT_TRUE(drawing.inside(big.center));
  EXPECT_FALSE(drawing.inside({64, 30, 30}));
  EXPECT_EQ(report.vertices, Parts(Drawing({{{64, 30, 30}, 5, 1}}).labels, Context(1))[1].vertices);
}

/// In noise with thousands of parts and samples at random: what is done is done, and threads do not matter.
TEST(Components, DroppingTwiceChangesNothingMore) {
  Lattice lattice;
  lattice.size = {60, 50, 100};
  Random random(11);
  PointCloud cloud;
  for (int i = 0; i < 200000; ++i) {
    cloud.positions.push_back(lattice.to_world({random.uniform(3, 57), random.uniform(3, 47), random.uniform(3, 97)}));
    cloud.normals.push_back(random_in_ball(random, 1));
  }
  const GridSamples samples = sort_samples(cloud, cloud.normals, lattice, Context(1));
  const auto noise = [&] {
    Random dice(5);
    const LevelBox box = lattice.box(0);
    return labels_of(
        drawn_level(box, false, [&](Vec3i v) { return dice.uniform() < (v.z < 50 ? 0.95 : 0.2) && box.is_free(v); }),
        0.5f, Context(1));
  };
  const ComponentParams params{.min_support = 0.9, .few_samples = 2, .many_samples = 12, .sparse_support = 0.7};
  Dense<uint8_t> first;
  for (const int threads : {1, 2, 3, 8}) {
    Labels labels = noise();
    ComponentReport once, twice;
    drop_components(labels, samples, 0.5, {params}, Context(threads), once);
    EXPECT_GT(once.objects.dropped, 100u);
    EXPECT_GT(once.objects.kept, 100u);
    EXPECT_GT(once.cavities.dropped, 100u);
    EXPECT_GT(once.cavities.kept, 100u);
    const Dense<uint8_t> after = dense_labels(labels);
    if (threads == 1) first = after;
    EXPECT_EQ(count_differences(after, first), 0u) << threads << " threads";
    drop_components(labels, samples, 0.5, {params}, Context(threads), twice);
    EXPECT_EQ(twice.objects.dropped + twice.cavities.dropped, 0u);
    EXPECT_EQ(count_differences(dense_labels(labels), after), 0u);
  }
}

TEST(Components, ParametersOutOfRangeAreRefused) {
  EXPECT_THROW(validate(ComponentParams{.min_support = -0.1}), ParameterError);
  EXPECT_THROW(validate(ComponentParams{.min_support = std::nan("")}), ParameterError);
  EXPECT_THROW(validate(ComponentParams{.few_samples = -1}), ParameterError);
  EXPECT_NO_THROW(validate(ComponentParams{}));
}

constexpr int resolution = 64;

/// A weight of area so small that outliers pay for films of their own.
Reconstruction reconstructed(const PointCloud& cloud, bool drop) {
  ReconstructParams params;
  params.place.resolution = resolution;
  params.energy.lambda_per_density = 0.0003;
  params.surface.drop_components = drop;
  return reconstruct(cloud, params, Context(2));
}

TEST(Components, OfOutliersAreDroppedAndTheSphereIsKept) {
  const auto sphere = make_shape("sphere");
  const double voxel = voxel_of_resolution(sphere->box(), resolution, 6);
  SamplingParams scan;
  scan.count = static_cast<size_t>(4 * area_of(*sphere) / (voxel * voxel));
  scan.outliers = 0.03;
  const PointCloud cloud = sample_surface(*sphere, scan, Context(2));
  EXPECT_GT(check_topology(reconstructed(cloud, false).mesh).components.size(), 20u) << "nothing to drop";
  const Reconstruction result = reconstructed(cloud, true);
  const TopologyReport topology = check_topology(result.mesh);
  EXPECT_TRUE(topology.watertight());
  EXPECT_EQ(topology.components.size(), 1u);
  EXPECT_EQ(topology.genus(), 0);
  const ComponentReport& dropped = result.report.components.value();
  EXPECT_EQ(dropped.objects.kept, 1u);
  EXPECT_EQ(dropped.cavities.kept, 0u);
  EXPECT_GT(dropped.cavities.dropped, 0u);
  EXPECT_LT(static_cast<double>(dropped.samples), 0.05 * static_cast<double>(cloud.size()));
}

/// Ranks share the samples and the contacts of bricks.
TEST(Components, OnRanksAreThoseOfOneProcess) {
  const auto run = [](const Context& context) {
    Drawing drawing({big, {{22, 30, 30}, 4, 6, false}, {{38, 30, 30}, 6, 300, false}, {{64, 30, 30}, 5, 30}});
    ComponentReport report;
    drop_components(drawing.labels, drawing.samples, 1, {}, context, report);
    EXPECT_EQ(report.objects.dropped, 1u);
    EXPECT_EQ(report.cavities.dropped, 1u);
    const std::vector<double> facts{report.lowest_kept, report.highest_dropped, report.area,
                                    static_cast<double>(report.samples), static_cast<double>(report.vertices)};
    return hash_bytes(std::span<const BrickBits>(drawing.labels.bits), hash_bytes(std::span<const double>(facts)));
  };
  const uint64_t alone = run(Context(1));
  for (uint64_t cut = 1; cut <= 12; ++cut)
    for (const uint64_t found : on_ranks<uint64_t>(1 + static_cast<int>(cut % 7), 1, {cut}, run))
      EXPECT_EQ(found, alone) << "cut " << cut;
}

}  // namespace TEST_FILE
}  // namespace soapfilm
