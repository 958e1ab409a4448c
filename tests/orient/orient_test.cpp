#include "soapfilm/orient/orient.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "soapfilm/core/random.h"
#include "soapfilm/error.h"
#include "tools/scanner/sample_surface.h"
#include "tools/scanner/shape.h"
#include "tools/scanner/virtual_scan.h"

namespace soapfilm {
namespace TEST_FILE {

struct Oriented {
  std::vector<Vec3f> directions;
  OrientReport report;
};

Oriented run(const PointCloud& cloud, const OrientSetup& params = {}, int threads = 2) {
  Oriented result;
  result.directions = orient(cloud, params, Context(threads), result.report);
  return result;
}

OrientSetup asking_for(DirectionSource source) {
  OrientSetup params;
  params.source = source;
  return params;
}

PointCloud without_normals(PointCloud cloud) {
  cloud.normals.clear();
  return cloud;
}

PointCloud cloud_of(std::vector<Vec3d> positions) {
  PointCloud cloud;
  cloud.positions = std::move(positions);
  cloud.scans.push_back({"test", 0, cloud.positions.size(), {}, {}, {}});
  return cloud;
}

struct Agreement {
  double right_side = 0;  ///< share of the samples
  double mean_degrees = 0;
};

Agreement compare(const std::vector<Vec3f>& directions, const std::vector<Vec3f>& truth) {
  Agreement a;
  for (size_t i = 0; i < truth.size(); ++i) {
    const double cosine = dot(static_cast<Vec3d>(directions[i]), static_cast<Vec3d>(truth[i]));
    a.right_side += cosine > 0.0;
    a.mean_degrees += std::acos(std::clamp(cosine, -1.0, 1.0)) * 57.29577951308232;
  }
  a.right_side /= static_cast<double>(truth.size());
  a.mean_degrees /= static_cast<double>(truth.size());
  return a;
}

std::string refusal(const PointCloud& cloud, const OrientSetup& params) {
  try {
    run(cloud, params);
  } catch (const ParameterError& error) {
    return error.what();
  }
  return "accepted";
}

void expect_unit(const std::vector<Vec3f>& directions) {
  for (const Vec3f& d : directions) ASSERT_NEAR(norm(d), 1.0f, 1e-6f);
}

TEST(Orient, EstimatesAgreeInSignOnSmoothShapes) {
  for (const char* name : {"sphere", "torus", "knot"}) {
    const PointCloud truth = sample_surface(*make_shape(name), 30000, 1);
    const Oriented found = run(without_normals(truth));
    expect_unit(found.directions);
    const Agreement agreement = compare(found.directions, truth.normals);
    EXPECT_EQ(agreement.right_side, 1.0) << name;
    EXPECT_LT(agreement.mean_degrees, std::string(name) == "knot" ? 4.0 : 2.5) << name;
    EXPECT_EQ(found.report.estimated, truth.size());
  }
}

TEST(Orient, EstimatesAgreeInSignOnASharpPart) {
  const PointCloud truth = sample_surface(*make_part(), 60000, 1);
  const Agreement agreement = compare(run(without_normals(truth)).directions, truth.normals);
  EXPECT_GE(agreement.right_side, 0.9999);
  EXPECT_LT(agreement.mean_degrees, 4.0);
}

TEST(Orient, EachComponentLooksOutward) {
  const PointCloud truth = sample_surface(*make_sheets(), 40000, 1);
  const Oriented found = run(without_normals(truth));
  EXPECT_GE(compare(found.directions, truth.normals).right_side, 0.999);
  ASSERT_EQ(found.report.warnings.size(), 1u);
  EXPECT_NE(found.report.warnings[0].find("40000 of 40000 samples have no direction"), std::string::npos);
  EXPECT_NE(found.report.warnings[0].find("over 2 connected parts"), std::string::npos);
}

/// Where a run's arrays may be on disk; not with normals, and not where there is enough memory.
TEST(Orient, WarnsWhereNeighborsWouldBeLookedUpOnDisk) {
  const PointCloud cloud = sample_surface(*make_shape("sphere"), 2000, 1);
  const auto warned = [](const PointCloud& of, size_t limit, const char* folder) {
    Context context(1);
    context.limit_memory(limit);
    context.set_scratch_folder(folder);
    OrientReport report;
    orient(of, {}, context, report);
    return std::any_of(report.warnings.begin(), report.warnings.end(), [](const std::string& line) {
      return line.find("2000 samples without normals: finding them on disk is very slow") != std::string::npos;
    });
  };
  const PointCloud bare = without_normals(cloud);
  EXPECT_TRUE(warned(bare, 20000, "/tmp"));
  EXPECT_FALSE(warned(bare, 40000, "/tmp"));
  EXPECT_FALSE(warned(bare, 20000, ""));
  EXPECT_FALSE(warned(cloud, 20000, "/tmp"));
}

TEST(Orient, AFewOutliersDoNotTurnTheEstimate) {
  PointCloud truth = sample_surface(*make_sphere(), 20000, 1);
  PointCloud cloud = without_normals(truth);
  Random random(5);
  for (int i = 0; i < 1000; ++i) {
    const double x = random.uniform(-1, 1), y = random.uniform(-1, 1), z = random.uniform(-1, 1);
    cloud.positions.push_back({x, y, z});
  }
  cloud.scans[0].end = cloud.size();
  std::vector<Vec3f> directions = run(cloud).directions;
  directions.resize(truth.size());
  EXPECT_GE(compare(directions, truth.normals).right_side, 0.99);
}

TEST(Orient, MoreNeighborsSmoothNoise) {
  PointCloud truth = sample_surface(*make_sphere(), 20000, 1);
  PointCloud cloud = without_normals(truth);
  Random random(2);
  for (size_t i = 0; i < cloud.size(); ++i)
    cloud.positions[i] += static_cast<Vec3d>(truth.normals[i]) * (0.005 * random.normal());
  OrientSetup params;
  params.neighbors = 12;
  const double few = compare(run(cloud, params).directions, truth.normals).mean_degrees;
  params.neighbors = 60;
  const double many = compare(run(cloud, params).directions, truth.normals).mean_degrees;
  EXPECT_LT(many, 0.5 * few);
  params.neighbors = 12;
  params.radius = 0.11;
  const double within = compare(run(cloud, params).directions, truth.normals).mean_degrees;
  EXPECT_LT(within, 0.5 * few);
}

TEST(Orient, OffsetsOfMillionsChangeNothing) {
  const PointCloud near = without_normals(sample_surface(*make_torus(), 5000, 1));
  PointCloud far = near;
  const double step = std::ldexp(1.0, -28);  // positions that stay exact at 5e6
  PointCloud rounded = near;
  for (size_t i = 0; i < near.size(); ++i) {
    const Vec3d p = near.positions[i] / step;
    rounded.positions[i] = Vec3d{std::round(p.x), std::round(p.y), std::round(p.z)} * step;
    far.positions[i] = rounded.positions[i] + Vec3d{5e6, -5e6, 4e6};
  }
  EXPECT_EQ(run(rounded).directions, run(far).directions);
}

TEST(Orient, ResultDoesNotDependOnThreads) {
  const PointCloud cloud = without_normals(sample_surface(*make_part(), 20000, 4));
  const std::vector<Vec3f> one = run(cloud, {}, 1).directions;
  for (const int threads : {2, 3, 8}) EXPECT_EQ(run(cloud, {}, threads).directions, one);
}

TEST(Orient, NormalsComeFirstAndAreMadeUnit) {
  PointCloud cloud = sample_surface(*make_sphere(), 100, 1);
  const std::vector<Vec3f> truth = cloud.normals;
  for (Vec3f& n : cloud.normals) n = n * 7.5f;
  cloud.scans[0].sensor = Vec3d{0, 0, 9};
  for (const auto source : {DirectionSource::automatic, DirectionSource::normals}) {
    const Oriented found = run(cloud, asking_for(source));
    EXPECT_EQ(found.report.from_normals, 100u);
    EXPECT_TRUE(found.report.warnings.empty());
    for (size_t i = 0; i < truth.size(); ++i) EXPECT_LE(norm(found.directions[i] - truth[i]), 1e-6f);
  }
}

/// A radius that holds fewer than the nearest ones changes nothing; one that holds all makes one plane of them.
TEST(Orient, ARadiusAddsToTheNearest) {
  const PointCloud cloud = without_normals(sample_surface(*make_part(), 3000, 1));
  OrientSetup params;
  const std::vector<Vec3f> nearest = run(cloud, params).directions;
  params.radius = 1e-6;
  EXPECT_EQ(run(cloud, params).directions, nearest);
  params.radius = 1e3;
  const std::vector<Vec3f> all = run(cloud, params).directions;
  for (const Vec3f& d : all) EXPECT_GT(std::abs(dot(d, all[0])), 0.999f);
  for (const int threads : {2, 5}) {
    params.radius = 0.1;
    EXPECT_EQ(run(cloud, params, threads).directions, run(cloud, params, 1).directions);
  }
}

TEST(Orient, SeenFromWithinPropagatedSignsAreTurned) {
  const PointCloud cloud = without_normals(sample_surface(*make_part(), 5000, 1));
  OrientSetup params;
  const std::vector<Vec3f> outward = run(cloud, params).directions;
  params.from_within = true;
  const Oriented inward = run(cloud, params);
  ASSERT_EQ(inward.report.warnings.size(), 1u);
  EXPECT_NE(inward.report.warnings[0].find("oriented inward"), std::string::npos);
  for (size_t i = 0; i < cloud.size(); ++i) EXPECT_EQ(inward.directions[i], -outward[i]);
  // A scanner tells the side whatever is said.
  params.sensor = Vec3d{0, 0, 50};
  const std::vector<Vec3f> told = run(cloud, params).directions;
  params.from_within = false;
  EXPECT_EQ(run(cloud, params).directions, told);
}

/// A file whose normals point inward is a mistake often made; its film wraps the outside of the shape.
TEST(Orient, InwardNormalsAreNoticed) {
  ShapeParams far;
  far.center = {1e6, -2e6, 3e6};
  for (const std::string& name : shape_names()) {
    PointCloud cloud = sample_surface(*make_shape(name, far), 4000, 1);
    EXPECT_FALSE(run(cloud).report.inward) << name;
    for (Vec3f& n : cloud.normals) n = -n;
    const Oriented found = run(cloud);
    EXPECT_TRUE(found.report.inward) << name;
    EXPECT_EQ(compare(found.directions, cloud.normals).right_side, 1.0) << "nothing is turned";
  }
}

TEST(Orient, SensorIsTheSamplesOwnThenItsScansThenTheCallers) {
  PointCloud cloud = cloud_of({{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}});
  const double nan = std::numeric_limits<double>::quiet_NaN();
  cloud.sensors = {{5, 0, 0}, {nan, nan, nan}, {nan, nan, nan}, {nan, nan, nan}};
  cloud.scans = {{"a", 0, 2, Vec3d{0, 9, 0}, Vec3d{1, 0, 0}, {}}, {"b", 2, 4, {}, Vec3d{0, 0, -1}, {}}};
  Oriented found = run(cloud);
  EXPECT_EQ(found.report.from_sensor, 2u);
  EXPECT_EQ(found.report.from_scan, 2u);
  EXPECT_EQ(found.directions[0], (Vec3f{1, 0, 0}));
  EXPECT_EQ(found.directions[1], (Vec3f{0, 1, 0}));
  EXPECT_EQ(found.directions[2], (Vec3f{0, 0, -1}));

  OrientSetup params;
  params.sensor = Vec3d{0, 0, 7};
  found = run(cloud, params);
  EXPECT_EQ(found.report.from_sensor, 4u);
  EXPECT_EQ(found.directions[1], (Vec3f{0, 1, 0}));
  EXPECT_EQ(found.directions[2], (Vec3f{0, 0, 1}));
}

/// Whatever run of samples a thread takes.
TEST(Orient, EachSampleLooksToItsOwnScanner) {
  std::vector<Vec3d> positions;
  Random random(1);
  for (int i = 0; i < 50000; ++i) positions.push_back({random.uniform(), random.uniform(), random.uniform()});
  PointCloud cloud = cloud_of(positions);
  cloud.scans.clear();
  std::vector<Vec3f> expected(positions.size());
  size_t begin = 0;
  for (const size_t size : {size_t{1}, size_t{16383}, size_t{3}, size_t{30000}, size_t{3613}}) {
    const Vec3d sensor{2, -3, 4 + static_cast<double>(cloud.scans.size())};
    cloud.scans.push_back({"scan", begin, begin + size, sensor, {}, {}});
    for (const size_t end = begin + size; begin < end; ++begin)
      expected[begin] = static_cast<Vec3f>(normalized(sensor - positions[begin]));
  }
  ASSERT_EQ(begin, positions.size());
  for (const int threads : {1, 2, 3, 8}) {
    const Oriented found = run(cloud, {}, threads);
    EXPECT_EQ(found.directions, expected) << threads << " threads";
    EXPECT_EQ(found.report.from_sensor, positions.size());
  }
}

TEST(Orient, ScanGivesOneDirectionForAll) {
  PointCloud cloud = cloud_of({{-1, 0, 0}, {1, 0, 0}});
  cloud.scans[0].sensor = Vec3d{0, 0, 4};
  Oriented found = run(cloud, asking_for(DirectionSource::scan));
  EXPECT_EQ(found.report.from_scan, 2u);
  EXPECT_EQ(found.directions[0], (Vec3f{0, 0, 1}));  // from the scan's mean towards its scanner
  cloud.scans[0].view_direction = Vec3d{0, 3, 0};
  found = run(cloud, asking_for(DirectionSource::scan));
  EXPECT_EQ(found.directions[0], (Vec3f{0, 1, 0}));
  EXPECT_EQ(found.directions[1], (Vec3f{0, 1, 0}));
}

TEST(Orient, AZeroNormalFallsBackToTheNextSource) {
  PointCloud cloud = sample_surface(*make_sphere(), 5000, 1);
  const std::vector<Vec3f> truth = cloud.normals;
  for (size_t i = 0; i < 1000; ++i) cloud.normals[i] = {};
  cloud.normals[1000] = {NAN, 0, 0};
  for (const auto source : {DirectionSource::automatic, DirectionSource::normals}) {
    Oriented found = run(cloud, asking_for(source));
    EXPECT_EQ(found.report.from_normals, 3999u);
    EXPECT_EQ(found.report.estimated, 1001u);
    EXPECT_EQ(compare(found.directions, truth).right_side, 1.0);
    EXPECT_EQ(found.report.warnings.size(), 1u);
  }
  cloud.scans[0].sensor = Vec3d{0, 0, 9};
  EXPECT_EQ(run(cloud).report.from_sensor, 1001u);
}

TEST(Orient, OnlyTheScanThatLacksADirectionIsEstimated) {
  // Half of a sphere has normals, the other half none: the known half decides the sign, even an inward one.
  PointCloud cloud = sample_surface(*make_sphere(), 20000, 1);
  std::vector<Vec3f> inward = cloud.normals;
  for (Vec3f& n : inward) n = -n;
  cloud.normals = inward;
  size_t lacking = 0;
  for (size_t i = 0; i < cloud.size(); ++i) {
    if (cloud.positions[i].z > 0.0) continue;
    cloud.normals[i] = {};
    ++lacking;
  }
  const Oriented found = run(cloud);
  EXPECT_EQ(found.report.estimated, lacking);
  EXPECT_EQ(compare(found.directions, inward).right_side, 1.0);
}

TEST(Orient, EstimatesAreTurnedToAKnownScanner) {
  ScannerParams scanner;
  scanner.views = 4;
  scanner.columns = scanner.rows = 100;
  scanner.normals = true;
  PointCloud cloud = virtual_scan(*make_part(), scanner, Context(2)).cloud;
  const std::vector<Vec3f> truth = std::exchange(cloud.normals, {});
  const Oriented found = run(cloud, asking_for(DirectionSource::estimate));
  EXPECT_EQ(found.report.estimated, cloud.size());
  EXPECT_TRUE(found.report.warnings.empty());
  const Agreement estimated = compare(found.directions, truth);
  const Agreement viewing = compare(run(cloud).directions, truth);
  EXPECT_GE(estimated.right_side, 0.98);  // at silhouettes neighbors belong to other faces
  EXPECT_LT(estimated.mean_degrees, 0.25 * viewing.mean_degrees);
}

TEST(Orient, ScansOutOfOrderAreRefused) {
  PointCloud cloud = sample_surface(*make_sphere(), 100, 1);
  cloud.scans = {{"b", 50, 100, {}, {}, {}}, {"a", 0, 50, {}, {}, {}}};
  EXPECT_EQ(refusal(cloud, {}), "scan 1: samples 0 to 50, must be in order from 100 to 100");
  cloud.scans = {{"a", 0, 101, {}, {}, {}}};
  EXPECT_EQ(refusal(cloud, {}), "scan 0: samples 0 to 101, must be in order from 0 to 100");
}

TEST(Orient, AnAbsentSourceIsRefusedByName) {
  const PointCloud bare = without_normals(sample_surface(*make_sphere(), 100, 1));
  EXPECT_EQ(refusal(bare, asking_for(DirectionSource::normals)), "directions = normals: no sample has a normal");
  EXPECT_EQ(refusal(bare, asking_for(DirectionSource::sensor)),
            "directions = sensor: no sample or scan has a scanner position, give one with --sensor");
  EXPECT_EQ(refusal(bare, asking_for(DirectionSource::scan)),
            "directions = scan: no scan has a viewing direction or a scanner position");
  OrientSetup params;
  params.neighbors = 2;
  EXPECT_EQ(refusal(bare, params), "neighbors = 2, must be in [3, 1000]");
  params = {};
  params.radius = 0;
  EXPECT_EQ(refusal(bare, params), "radius = 0, must be > 0");
  params = {};
  params.sensor = Vec3d{0, INFINITY, 0};
  EXPECT_EQ(refusal(bare, params), "sensor: its coordinates must be finite");
}

TEST(Orient, WhatSpansNoPlaneHasNoDirection) {
  std::vector<Vec3d> line;
  for (int i = 0; i < 50; ++i) line.push_back(Vec3d{1, 2, 3} * (0.125 * i));
  for (const auto& positions : {std::vector<Vec3d>{{1, 2, 3}}, std::vector<Vec3d>(40, Vec3d{4, 5, 6}), line}) {
    const Oriented found = run(cloud_of(positions));
    EXPECT_EQ(found.report.without_direction, positions.size());
    EXPECT_EQ(found.report.estimated, 0u);
    for (const Vec3f& d : found.directions) EXPECT_EQ(d, Vec3f{});
    ASSERT_EQ(found.report.warnings.size(), 1u);
    EXPECT_NE(found.report.warnings[0].find("no neighbors that span a plane"), std::string::npos);
  }
  EXPECT_TRUE(run(PointCloud{}).directions.empty());
}

TEST(Orient, CoplanarSamplesShareOneNormal) {
  Random random(3);
  std::vector<Vec3d> positions;
  for (int i = 0; i < 3000; ++i) {
    const double x = random.uniform(), y = random.uniform();
    positions.push_back({x, y, 0.5});
  }
  const Oriented found = run(cloud_of(positions));
  expect_unit(found.directions);
  for (const Vec3f& d : found.directions) {
    EXPECT_EQ(d, found.directions[0]);
    EXPECT_NEAR(std::abs(d.z), 1.0f, 1e-6f);
  }
}

TEST(Orient, RepeatedPositionsCountOnce) {
  const PointCloud truth = sample_surface(*make_torus(), 3000, 1);
  const std::vector<Vec3f> once = run(without_normals(truth)).directions;
  PointCloud repeated;
  for (size_t i = 0; i < 30 * truth.size(); ++i) repeated.positions.push_back(truth.positions[i % truth.size()]);
  repeated.scans.push_back({"test", 0, repeated.size(), {}, {}, {}});
  const std::vector<Vec3f> often = run(repeated).directions;
  for (size_t i = 0; i < often.size(); ++i) ASSERT_EQ(often[i], once[i % once.size()]);
}

TEST(Orient, CanBeCancelled) {
  Progress progress;
  progress.cancel();
  OrientReport report;
  EXPECT_THROW(orient(without_normals(sample_surface(*make_sphere(), 100, 1)), {}, Context(1, progress), report),
               Cancelled);
}

}  // namespace TEST_FILE
}  // namespace soapfilm
