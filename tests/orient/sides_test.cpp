#include "soapfilm/orient/sides.h"

#include <gtest/gtest.h>

#include <functional>

#include "soapfilm/core/random.h"
#include "soapfilm/orient/local_surface.h"
#include "soapfilm/orient/orient.h"
#include "tools/scanner/sample_surface.h"
#include "tools/scanner/shape.h"

namespace soapfilm {
namespace TEST_FILE {

SideStatistics sides_of(const PointCloud& cloud, int threads = 1) {
  return measure_local_surface(cloud.positions, cloud.normals, cloud.box(), Context(threads)).sides;
}

PointCloud ring(double outliers = 0) {
  SamplingParams params{.count = 20000};
  params.outliers = outliers;
  return sample_surface(*make_torus(), params, Context(1));
}

/// Turns normals round: single ones by lot, or all beyond a plane.
void turn(PointCloud& cloud, double share, uint64_t seed = 9) {
  Random random(seed);
  for (Vec3f& n : cloud.normals)
    if (random.uniform() < share) n = -n;
}
void turn_part(PointCloud& cloud, double from_x) {
  for (size_t i = 0; i < cloud.size(); ++i)
    if (cloud.positions[i].x > from_x) cloud.normals[i] = -cloud.normals[i];
}

/// Both sides of a square of 60 spacings, as thick as `thickness` spacings, noise 0.1.
PointCloud sheet(double thickness) {
  PointCloud cloud;
  Random random(4);
  for (int i = 0; i < 7200; ++i) {
    const float up = i % 2 == 0 ? 1.0F : -1.0F;
    const double x = random.uniform(0, 60), y = random.uniform(0, 60);
    cloud.positions.push_back({x, y, up * (thickness / 2 + 0.1 * random.normal())});
    cloud.normals.push_back({0, 0, up});
  }
  cloud.scans = {{"sheet", 0, cloud.size(), {}, {}, {}}};
  return cloud;
}

TEST(Sides, SoundNormalsDoNotContradict) {
  for (const char* name : {"part", "plate", "sheets"}) {
    SamplingParams params{.count = 20000};
    for (const double noise : {0.0, 0.006}) {
      params.noise = noise;
      const SideStatistics sides = sides_of(sample_surface(*make_shape(name), params, Context(1)));
      EXPECT_FALSE(sides.contradicts()) << name;
      EXPECT_LT(sides.contradicting(), 0.002) << name;
    }
  }
}

TEST(Sides, NeitherDoOutliersNorThinSheets) {
  for (const double share : {0.1, 0.4}) EXPECT_FALSE(sides_of(ring(share)).contradicts()) << share;
  for (const double thickness : {0.4, 0.7, 1.0, 1.5}) {
    const SideStatistics sides = sides_of(sheet(thickness));
    EXPECT_FALSE(sides.contradicts()) << thickness;
    EXPECT_GT(sides.on_sheets(), 0.3) << thickness;
  }
}

TEST(Sides, WrongSignsDo) {
  for (const double share : {0.04, 0.1, 0.3, 0.5}) {
    PointCloud cloud = ring();
    turn(cloud, share);
    const SideStatistics sides = sides_of(cloud);
    EXPECT_TRUE(sides.contradicts()) << share;
    // Where two lie together both ways are as likely: 2 p (1 - p), but for places that hold one of a kind.
    EXPECT_NEAR(sides.contradicting(), 2 * share * (1 - share), 0.05) << share;
  }
  PointCloud part = ring();
  turn_part(part, 0.2);
  EXPECT_TRUE(sides_of(part).contradicts());
}

TEST(Sides, KnowHowThickSheetsAre) {
  for (const double thickness : {0.5, 0.8}) {
    const SideStatistics::Thin thin = sides_of(sheet(thickness)).thinner_than(1.0 / 60);
    EXPECT_GT(thin.share, 0.5);
    EXPECT_NEAR(thin.thickness * 60, thickness, 0.2 * thickness);
  }
  EXPECT_LT(sides_of(sheet(1.5)).thinner_than(1.0 / 60).share, 0.05);
}

TEST(Sides, ThreadsDoNotMatter) {
  PointCloud cloud = ring(0.1);
  turn(cloud, 0.1);
  const SideStatistics one = sides_of(cloud), three = sides_of(cloud, 3);
  EXPECT_EQ(one.contradicting(), three.contradicting());
  EXPECT_EQ(one.thinner_than(0.1).share, three.thinner_than(0.1).share);
}

struct Doubted {
  bool changed = false;
  std::vector<Vec3f> directions;
  OrientReport report;
};

Doubted doubt(const PointCloud& cloud, DirectionSource source = DirectionSource::automatic) {
  Doubted result;
  OrientSetup params;
  params.source = source;
  const Context context(2);
  result.directions = orient(cloud, params, context, result.report);
  const LocalSurface surface = measure_local_surface(cloud.positions, result.directions, cloud.box(), context);
  result.changed = check_signs(cloud, params, surface.sides, context, result.directions, result.report);
  return result;
}

double right_share(const std::vector<Vec3f>& directions, const std::vector<Vec3f>& truth) {
  double right = 0;
  for (size_t i = 0; i < truth.size(); ++i) right += dot(directions[i], truth[i]) > 0;
  return right / static_cast<double>(truth.size());
}

TEST(DoubtSigns, TurnsNormalsByPropagation) {
  const PointCloud truth = ring();
  for (const double share : {0.1, 0.5}) {
    PointCloud cloud = truth;
    turn(cloud, share);
    const Doubted found = doubt(cloud);
    EXPECT_TRUE(found.changed);
    EXPECT_EQ(right_share(found.directions, truth.normals), 1);
    EXPECT_NEAR(static_cast<double>(found.report.reoriented), share * static_cast<double>(cloud.size()), 300);
    ASSERT_EQ(found.report.warnings.size(), 1u);
    EXPECT_NE(found.report.warnings[0].find("--directions normals"), std::string::npos);
  }
}

/// Some hundred samples of an ellipsoid, of which an estimator left all normals upward.
TEST(DoubtSigns, OfFewSamplesAreFoundToo) {
  const PointCloud sphere = sample_surface(*make_sphere(), 150, 1);
  for (const bool upward : {false, true}) {
    PointCloud cloud = sphere;
    if (upward)
      for (Vec3f& n : cloud.normals)
        if (n.z < 0) n = -n;
    const Doubted found = doubt(cloud);
    EXPECT_EQ(found.changed, upward);
    EXPECT_EQ(right_share(found.directions, sphere.normals), 1);
    EXPECT_EQ(found.report.warnings.size(), upward ? 1u : 0u);
  }
}

/// A hollow seen from within: most of the normals know.
TEST(DoubtSigns, FollowsTheMajorityOfAPart) {
  PointCloud truth = sample_surface(*make_sphere(), 20000, 1);
  for (Vec3f& n : truth.normals) n = -n;
  PointCloud cloud = truth;
  turn(cloud, 0.3);
  EXPECT_EQ(right_share(doubt(cloud).directions, truth.normals), 1);
}

TEST(DoubtSigns, TurnsNormalsToScanners) {
  PointCloud truth = sample_surface(*make_sphere(), 20000, 1);
  for (Vec3f& n : truth.normals) n = -n;
  PointCloud cloud = truth;
  turn(cloud, 0.5);
  cloud.sensors.assign(cloud.size(), {0.1, 0, 0});  // within
  const Doubted found = doubt(cloud);
  EXPECT_EQ(right_share(found.directions, truth.normals), 1);
  EXPECT_NE(found.report.warnings.at(0).find("oriented towards the scanners"), std::string::npos);
}

TEST(DoubtSigns, LeavesWhatWasAskedForAndWhatIsSound) {
  PointCloud cloud = ring();
  EXPECT_FALSE(doubt(cloud).changed);
  EXPECT_TRUE(doubt(cloud).report.warnings.empty());
  turn(cloud, 0.5);
  const Doubted asked = doubt(cloud, DirectionSource::normals);
  EXPECT_FALSE(asked.changed);
  EXPECT_GT(right_share(asked.directions, cloud.normals), 0.999);
  EXPECT_EQ(asked.report.warnings.size(), 1u);
  PointCloud thin = sheet(1.0);
  turn_part(thin, 30);
  thin.positions.push_back({0, 0, 30});  // spans a volume
  thin.normals.push_back({0, 0, 1});
  EXPECT_FALSE(doubt(thin).changed);
}

}  // namespace TEST_FILE
}  // namespace soapfilm
