// From where a scene without any known direction was seen: above, as a rule, unless it is a body or a room.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "orient/landscape.h"
#include "soapfilm/core/names.h"
#include "soapfilm/core/random.h"
#include "soapfilm/orient/orient.h"
#include "support/sanitized.h"
#include "tools/scanner/sample_surface.h"
#include "tools/scanner/shape.h"

namespace soapfilm {
namespace TEST_FILE {

using namespace test;

constexpr size_t samples = 6000;
constexpr double spacing = 0.026;  // of so many on a square of side 2
constexpr double nearly_all = 0.99, nearly_all_noisy = 0.97;

struct Oriented {
  std::vector<Vec3f> directions;
  OrientReport report;

  std::string lines() const {
    std::string all = report.assumed;
    for (const std::string& warning : report.warnings) all += "\n" + warning;
    return all;
  }
};

Oriented run(const PointCloud& cloud, std::optional<Axis> up = {}, int threads = 2) {
  Oriented found;
  OrientSetup params;
  params.up = up;
  found.directions = orient(cloud, params, Context(threads), found.report);
  return found;
}

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

void expect_right(const Seen& seen, double share, const std::string& what, std::optional<Axis> up = {}) {
  const Oriented found = run(bare(seen), up);
  EXPECT_GE(on_the_right_side(found.directions, seen.normals), share) << what << "\n" << found.lines();
}

TEST(Up, LandscapesAreSeenFromAbove) {
  for (const auto& [name, height] : landscapes())
    for (const size_t count : {size_t{4000}, size_t{20000}})
      expect_right(seen_from_above(height, count), nearly_all, name + ", " + std::to_string(count));
}

TEST(Up, NoiseDoesNotTurnThem) {
  for (const auto& [name, height] : landscapes())
    for (const double noise : {0.2, 0.5})
      expect_right(seen_from_above(height, samples, noise * spacing), nearly_all_noisy,
                   name + ", noise of " + std::to_string(noise) + " spacings");
}

TEST(Up, SlopesOfHalfARightAngleDoNotTurnThem) {
  for (const auto& [name, height] : landscapes())
    for (const double degrees : {30.0, 45.0}) {
      const std::string what = name + ", tilted by " + std::to_string(degrees);
      expect_right(tilted(seen_from_above(height, samples), degrees), nearly_all, what);
      expect_right(tilted(seen_from_above(height, samples, 0.3 * spacing), degrees), nearly_all_noisy,
                   what + ", noisy");
    }
}

TEST(Up, AnotherAxisIsAsGood) {
  for (int axis = sanitized ? 4 : 0; axis < (sanitized ? 5 : 6); ++axis) {
    const auto up = static_cast<Axis>(axis);
    for (const auto& [name, height] : landscapes()) {
      const Seen seen = turned_up(seen_from_above(height, samples), axis);
      expect_right(seen, nearly_all, name + " " + name_of(up), up);
      const Seen noisy = turned_up(tilted(seen_from_above(height, samples, 0.3 * spacing), 30), axis);
      expect_right(noisy, nearly_all_noisy, name + ", tilted and noisy " + name_of(up), up);
    }
  }
}

TEST(Up, TheOppositeAxisTurnsThemAll) {
  const Seen seen = seen_from_above(landscapes().back().second, samples);
  const Oriented from_below = run(bare(seen), Axis::minus_z);
  EXPECT_LE(on_the_right_side(from_below.directions, seen.normals), 1 - nearly_all);
}

Seen seen_of(const PointCloud& truth) {
  Seen seen;
  for (size_t i = 0; i < truth.size(); ++i) seen.add(truth.positions[i], static_cast<Vec3d>(truth.normals[i]));
  return seen;
}

TEST(Up, ClosedBodiesLookOutwardWhateverIsUp) {
  for (const char* shape : {"sphere", "torus", "part", "knot"}) {
    const Seen body = seen_of(sample_surface(*make_shape(shape), 10000, 1));
    for (const std::optional<Axis> up : {std::optional<Axis>{}, {Axis::z}, {Axis::minus_y}})
      expect_right(body, nearly_all, shape, up);
  }
}

/// Outliers are the extreme points of such a cloud; they must not decide for all.
TEST(Up, BodiesWithNoiseAmongOutliersLookOutward) {
  const std::vector<const char*> names = {"sphere", "torus", "part", "arch"};
  for (const char* name : sanitized ? std::vector{names[0]} : names)
    for (const double outliers : {0.05, 0.1, 0.3}) {
      const auto shape = make_shape(name);
      SamplingParams how{.count = 20000, .noise = 0.007, .outliers = outliers};  // 0.6 to 0.8 spacings
      PointCloud cloud = sample_surface(*shape, how, Context(2));
      const std::vector<Vec3f> truth = std::exchange(cloud.normals, {});
      const Oriented found = run(cloud);
      double right = 0, all = 0;
      for (size_t i = 0; i < truth.size(); ++i) {
        if (shape->distance(cloud.positions[i]) > 3 * how.noise) continue;
        ++all;
        right += dot(found.directions[i], truth[i]) > 0;
      }
      EXPECT_GE(right, 0.95 * all) << name << ", outliers " << outliers << "\n" << found.lines();
    }
}

/// A box sampled on all six sides.
Seen box(Vec3d size, size_t count) {
  const std::array<double, 3> areas{size.y * size.z, size.z * size.x, size.x * size.y};
  Random random(4);
  Seen seen;
  while (seen.positions.size() < count) {
    double which = random.uniform(0, areas[0] + areas[1] + areas[2]);
    int axis = 0;
    for (; axis < 2 && which > areas[static_cast<size_t>(axis)]; ++axis) which -= areas[static_cast<size_t>(axis)];
    Vec3d p{random.uniform(0, size.x), random.uniform(0, size.y), random.uniform(0, size.z)};
    Vec3d normal;
    normal[axis] = random.uniform() < 0.5 ? -1 : 1;
    p[axis] = normal[axis] > 0 ? size[axis] : 0;
    seen.add(p, normal);
  }
  return seen;
}

/// Wide and thin, but a body: its lower side is no ground. Its samples are 0.7 apart.
TEST(Up, BothSidesOfAPlateLookOutward) {
  const Seen plate = box({100, 100, 2}, 40000);
  for (const int axis : sanitized ? std::vector{2} : std::vector{2, 0, 4}) {
    const Seen turned = turned_up(plate, axis);
    const Oriented found = run(bare(turned));
    EXPECT_GE(on_the_right_side(found.directions, turned.normals), nearly_all) << axis << "\n" << found.lines();
    EXPECT_TRUE(found.report.assumed.empty()) << found.report.assumed;
  }
}

/// Two rooms beside each other, seen from within: floors, ceilings and walls, with a door between them.
Seen house() {
  Seen seen;
  const Seen room = box({4, 3, 2.5}, 9000);
  for (const double shift : {0.0, 4.2})
    for (size_t i = 0; i < room.positions.size(); ++i) {
      const Vec3d p = room.positions[i] + Vec3d{shift, 0, 0};
      const bool door = p.x > 3.9 && p.x < 4.3 && p.y > 1 && p.y < 2 && p.z < 2;
      if (!door) seen.add(p, -room.normals[i]);
    }
  return seen;
}

TEST(Up, AHouseIsNotSeenFromAbove) {
  for (const bool survey : {false, true}) {
    PointCloud cloud = bare(house());
    cloud.is_survey = survey;
    const Oriented found = run(cloud);
    EXPECT_TRUE(found.report.assumed.empty()) << found.report.assumed;
    EXPECT_GE(found.report.warnings.size(), 1u);
  }
}

/// Ground, and crowns of trees over it: positions that lie on no surface.
struct Forest {
  Seen ground;
  PointCloud cloud;

  Forest() {
    Random random(8);
    for (int i = 0; i < 8000; ++i) {
      const double x = random.uniform(0, 80), y = random.uniform(0, 80);
      ground.add({x, y, 0.3 * std::sin(0.2 * x) + 0.03 * random.normal()}, {0, 0, 1});
    }
    cloud = bare(ground);
    for (int tree = 0; tree < 30; ++tree) {
      const Vec3d middle{random.uniform(5, 75), random.uniform(5, 75), 9};
      for (int i = 0; i < 200; ++i)
        cloud.positions.push_back(middle + 2.0 * Vec3d{random.normal(), random.normal(), random.normal()});
    }
    cloud.scans[0].end = cloud.size();
    cloud.is_survey = true;
  }
};

TEST(Up, TheGroundOfASurveyedForestLooksUp) {
  const Forest forest;
  Oriented found = run(forest.cloud);
  found.directions.resize(forest.ground.positions.size());
  EXPECT_GE(on_the_right_side(found.directions, forest.ground.normals), nearly_all) << found.lines();
  EXPECT_TRUE(contains(found.report.assumed, "they come from a survey's file")) << found.lines();
}

/// Whatever is assumed is said in one line that names the option against it.
TEST(Up, SaysWhatIsAssumedAndHowToSayOtherwise) {
  const auto waves = [](double x, double) { return Height{0.1 * std::sin(3 * x), 0.3 * std::cos(3 * x), 0}; };
  const Seen terrain = seen_from_above(waves, samples);
  const Oriented layer = run(bare(terrain));
  EXPECT_TRUE(contains(layer.report.assumed, "from above (+z), since they are a flat wide layer")) << layer.lines();
  EXPECT_TRUE(contains(layer.report.assumed, "--up")) << layer.lines();
  EXPECT_TRUE(layer.report.warnings.empty()) << layer.lines();
  const Oriented below = run(bare(terrain), Axis::minus_z);
  EXPECT_TRUE(contains(below.report.assumed, "seen from above (-z)")) << below.lines();
  const Oriented sheet = run(bare(tilted(terrain, 45)));
  ASSERT_EQ(sheet.report.warnings.size(), 1u) << sheet.lines();
  EXPECT_TRUE(contains(sheet.report.warnings[0], "sheets towards +z")) << sheet.lines();
  EXPECT_TRUE(contains(sheet.report.warnings[0], "--up")) << sheet.lines();
}

/// A wall that stands upright could have been seen from either side.
TEST(Up, OfAnUprightWallTheSideIsAGuessThatIsSaid) {
  const Seen wall = turned_up(seen_from_above([](double, double) { return Height{0, 0, 0}; }, samples), 1);
  const Oriented guessed = run(bare(wall));
  EXPECT_TRUE(guessed.report.assumed.empty()) << guessed.lines();
  ASSERT_EQ(guessed.report.warnings.size(), 1u) << guessed.lines();
  EXPECT_TRUE(contains(guessed.report.warnings[0], "hardly tells")) << guessed.lines();
  EXPECT_TRUE(contains(guessed.report.warnings[0], "--up")) << guessed.lines();
  for (const auto& [up, share] : {std::pair{Axis::y, 1.0}, {Axis::minus_y, 0.0}})
    EXPECT_NEAR(on_the_right_side(run(bare(wall), up).directions, wall.normals), share, 1 - nearly_all) << name_of(up);
}

/// A scanner's place says more than any guess.
TEST(Up, KnownScannersAreBelievedInstead) {
  const Seen seen = seen_from_above(landscapes().front().second, samples);
  PointCloud cloud = bare(seen);
  cloud.scans[0].sensor = Vec3d{0, 0, -5};
  cloud.is_survey = true;
  const Oriented found = run(cloud);
  EXPECT_TRUE(found.report.assumed.empty()) << found.report.assumed;
  EXPECT_EQ(on_the_right_side(found.directions, seen.normals), 0);
}

TEST(Up, IsTheSameForAnyNumberOfThreads) {
  const Forest forest;
  for (const PointCloud& cloud :
       {forest.cloud, bare(seen_from_above(landscapes().back().second, samples)), bare(box({20, 20, 2}, samples))}) {
    const std::vector<Vec3f> one = run(cloud, {}, 1).directions;
    for (const int threads : {2, 3}) EXPECT_EQ(run(cloud, {}, threads).directions, one) << threads;
  }
}

}  // namespace TEST_FILE
}  // namespace soapfilm
