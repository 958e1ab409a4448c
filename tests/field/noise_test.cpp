#include "soapfilm/field/noise.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <string_view>
#include <utility>
#include <vector>

#include "soapfilm/core/random.h"
#include "support/shuffled.h"

namespace soapfilm {
namespace TEST_FILE {

constexpr size_t samples = 40000;
constexpr double tolerance = 0.25;  // of the noise

struct Surface {
  const char* name;
  double area;
  std::function<Vec3d(Random&, double noise)> sample;
};

Vec3d any_direction(Random& random) { return normalized(Vec3d{random.normal(), random.normal(), random.normal()}); }

/// A plane askew in its box, and a ball.
std::vector<Surface> surfaces() {
  const Vec3d normal = normalized(Vec3d{1, 2, 3}), a = normalized(cross(normal, Vec3d{1, 0, 0})), b = cross(normal, a);
  return {{"plane", 4,
           [=](Random& random, double noise) {
             const double x = random.uniform(-1, 1), y = random.uniform(-1, 1);
             return a * x + b * y + normal * (noise * random.normal());
           }},
          {"sphere", 4 * M_PI,
           [](Random& random, double noise) { return any_direction(random) * (1 + noise * random.normal()); }}};
}

std::vector<Vec3d> sampled(const Surface& surface, size_t count, double noise, uint64_t seed = 1) {
  Random random(seed);
  std::vector<Vec3d> points;
  for (size_t i = 0; i < count; ++i) points.push_back(surface.sample(random, noise));
  return points;
}

double spacing_of(const Surface& surface, size_t count) { return std::sqrt(surface.area / static_cast<double>(count)); }

double noise_of(const std::vector<Vec3d>& points, int threads = 2) {
  return measure_noise(points, std::vector<Vec3f>(points.size()), Context(threads));
}

TEST(Noise, IsMeasuredWithinAQuarter) {
  for (const Surface& surface : surfaces())
    for (const double spacings : {0.2, 1.0, 3.0}) {
      const double noise = spacings * spacing_of(surface, samples);
      // The larger neighborhoods that more noise needs are curved.
      const double allowed = std::string_view(surface.name) == "sphere" && spacings > 2 ? 2 * tolerance : tolerance;
      EXPECT_NEAR(noise_of(sampled(surface, samples, noise)), noise, allowed * noise)
          << surface.name << ", " << spacings << " spacings";
    }
}

TEST(Noise, OfCleanSamplesIsFarBelowTheirSpacing) {
  for (const Surface& surface : surfaces())
    EXPECT_LT(noise_of(sampled(surface, samples, 0)), 0.05 * spacing_of(surface, samples)) << surface.name;
}

TEST(Noise, OfWhatIsNoSurfaceIsUnknown) {
  Random random(3);
  std::vector<Vec3d> ball;
  for (size_t i = 0; i < 8000; ++i) ball.push_back(any_direction(random) * std::cbrt(random.uniform()));
  EXPECT_EQ(noise_of(ball), 0);
  EXPECT_EQ(noise_of({}), 0);
  EXPECT_EQ(noise_of(std::vector<Vec3d>(1000, Vec3d{1, 2, 3})), 0);
  EXPECT_EQ(noise_of(sampled(surfaces()[0], 50, 0.1)), 0) << "too few to tell";
}

/// Hills with trees: neither the height of the trees nor that of the hills is noise, where samples are dense.
TEST(Noise, TreesAreNone) {
  constexpr double noise = 0.03, tree = 60;  // of the ground; area of one tree
  const auto ground = [](double x, double y) { return 4 * std::sin(0.03 * x) + 3 * std::cos(0.04 * y); };
  for (const auto& [tile, crowns] : {std::pair{100.0, 0.3}, {100.0, 0.5}, {400.0, 0.3}}) {
    Random random(1);
    std::vector<Vec3d> tops, points;
    while (static_cast<double>(tops.size()) * tree < tile * tile)
      tops.push_back({random.uniform(0, tile), random.uniform(0, tile), random.uniform(8, 20)});
    while (points.size() < samples) {
      double x = random.uniform(0, tile), y = random.uniform(0, tile), height = noise * random.normal();
      if (random.uniform() < crowns) {
        const Vec3d top = tops[random.next() % tops.size()];
        const double down = std::sqrt(random.uniform()), angle = random.uniform(0, 2 * M_PI);  // a cone
        const double radius = 3 * down * std::sqrt(random.uniform());
        x = top.x + radius * std::cos(angle), y = top.y + radius * std::sin(angle);
        height = top.z * (1 - 0.7 * down);
      }
      points.push_back({x, y, ground(x, y) + height});
    }
    EXPECT_LT(noise_of(points), 2 * noise) << tile << " m, " << crowns << " of the samples in crowns";
  }
}

TEST(Noise, HasTheUnitOfTheSamples) {
  std::vector<Vec3d> points = sampled(surfaces()[1], samples, 0.01);
  const double measured = noise_of(points);
  for (const double factor : {1e-3, 25.4, 4096.0}) {
    std::vector<Vec3d> scaled = points;
    for (Vec3d& p : scaled) p = p * factor;
    EXPECT_NEAR(noise_of(scaled), factor * measured, 1e-3 * factor * measured) << factor;
  }
}

/// Coordinates of a map in meters, of samples with noise of millimeters.
TEST(Noise, LosesNothingFarFromTheOrigin) {
  std::vector<Vec3d> points = sampled(surfaces()[0], samples, 0.005);
  const double measured = noise_of(points);
  for (Vec3d& p : points) p += Vec3d{691000, 5334000, 500};
  EXPECT_NEAR(noise_of(points), measured, 1e-3 * measured);
}

/// The two sides of a sheet, as far apart as some samples of one side are: their distance is no noise where directions
/// say which side a sample is on.
TEST(Noise, IsNotTheThicknessOfASheet) {
  const Surface plane = surfaces()[0];
  const double spacing = spacing_of(plane, samples / 2);
  const Vec3d normal = normalized(Vec3d{1, 2, 3});
  for (const double thickness : {0.5, 1.0, 3.0, 10.0}) {
    std::vector<Vec3d> points = sampled(plane, samples, 0.05 * spacing);
    std::vector<Vec3f> directions;
    for (size_t i = 0; i < points.size(); ++i) {
      const double side = i % 2 == 0 ? 1 : -1;
      points[i] += normal * (side * thickness * spacing / 2);
      directions.push_back(Vec3f(normal * side));
    }
    EXPECT_NEAR(measure_noise(points, directions, Context(2)), 0.05 * spacing, 0.02 * spacing) << thickness;
  }
}

/// A second frame of the same surface is no reason for a finer grid: its samples have the same noise.
TEST(Noise, IsThatOfOneFrameHoweverManyOverlap) {
  for (const Surface& surface : surfaces()) {
    const double noise = spacing_of(surface, samples);
    std::vector<Vec3d> frames;
    for (const uint64_t frame : {1, 2, 3, 4}) {
      const std::vector<Vec3d> one = sampled(surface, samples, noise, frame);
      frames.insert(frames.end(), one.begin(), one.end());
      EXPECT_NEAR(noise_of(frames), noise, tolerance * noise) << surface.name << ", " << frame << " frames";
    }
  }
}

TEST(Noise, IsTheSameForAnyNumberOfThreads) {
  const std::vector<Vec3d> points = sampled(surfaces()[1], samples, 0.02);
  const double one = noise_of(points, 1);
  EXPECT_GT(one, 0);
  for (const int threads : {2, 3}) EXPECT_EQ(noise_of(points, threads), one);
}

TEST(Noise, DoesNotDependOnTheOrderOfTheSamples) {
  for (const Surface& surface : surfaces()) {
    const std::vector<Vec3d> points = sampled(surface, 3 * samples, 0.5 * spacing_of(surface, samples));
    for (uint64_t seed = 1; seed < 3; ++seed)
      EXPECT_EQ(noise_of(test::in_order(points, test::random_order(points.size(), seed))), noise_of(points));
  }
}

}  // namespace TEST_FILE
}  // namespace soapfilm
