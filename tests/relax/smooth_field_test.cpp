#include "soapfilm/relax/smooth_field.h"

#include <gtest/gtest.h>

#include "soapfilm/core/random.h"
#include "soapfilm/relax/residuals.h"

namespace soapfilm {
namespace TEST_FILE {

struct Sampled {
  BrickGrid grid;
  Field<float> value;
};

/// A function at the vertices of 3^3 bricks.
template <class Function>
Sampled sampled(Function&& function) {
  Sampled result{BrickGrid(BrickMask::whole({3, 3, 3}), Context(1)), {}};
  result.value = Field<float>(result.grid);
  for (size_t b = 0; b < result.grid.size(); ++b)
    for (int i = 0; i < brick_volume; ++i)
      result.value.brick(b)[i] = static_cast<float>(function(Vec3d(result.grid.first_vertex(b) + vertex_in_brick(i))));
  return result;
}

TEST(SmoothField, IsExactForQuadraticsButForItsShareOfTheLaplacian) {
  const auto quadratic = [](Vec3d p) {
    const Vec3d q = (p - Vec3d{12, 12, 12}) / 10.0;
    return 0.3 + q.x - 2 * q.y + q.x * q.x - 0.5 * q.y * q.y + 2 * q.z * q.z + q.x * q.y - q.y * q.z;
  };
  const double laplacian = (2 - 1 + 4) / 100.0;
  const Sampled field = sampled(quadratic);
  const SmoothField smooth(field.grid, field.value, Context(2));
  Random random(3);
  for (int i = 0; i < 200; ++i) {
    const Vec3d p{random.uniform(3, 20), random.uniform(3, 20), random.uniform(3, 20)};
    const auto jet = smooth.at(p);
    ASSERT_TRUE(jet);
    const double share = (jet->value - quadratic(p)) / laplacian;
    EXPECT_NEAR(share, 0.075, 2e-3);
    for (int axis = 0; axis < 3; ++axis) {
      Vec3d step;
      step[axis] = 1e-3;
      EXPECT_NEAR(jet->gradient[axis], (quadratic(p + step) - quadratic(p - step)) / 2e-3, 1e-4);
    }
  }
}

TEST(SmoothField, IsNotKnownBeyondTheBricks) {
  const Sampled field = sampled([](Vec3d p) { return p.x - 12; });
  const SmoothField smooth(field.grid, field.value, Context(1));
  EXPECT_TRUE(smooth.at({12, 12, 12}));
  EXPECT_FALSE(smooth.at({0.5, 12, 12})) << "needs the vertex before the first";
  EXPECT_FALSE(smooth.at({12, 12, 23.5}));
  EXPECT_FALSE(smooth.at({-20, 12, 12}));
}

TEST(SmoothField, ProjectsOntoASphereNearerThanChordsDo) {
  const double radius = 4;
  const Vec3d center{12, 12, 12};
  const auto distance = [&](Vec3d p) { return radius - norm(p - center); };
  const Sampled field = sampled(distance);
  const SmoothField smooth(field.grid, field.value, Context(1));
  Random random(4);
  for (int i = 0; i < 100; ++i) {
    const Vec3d direction = normalized(Vec3d{random.normal(), random.normal(), random.normal()});
    const auto p = smooth.project(center + direction * (radius + random.uniform(-0.2, 0.2)), 0.5);
    ASSERT_TRUE(p);
    // The field's share of the Laplacian, 2 / radius, is inside.
    EXPECT_NEAR(norm(*p - center), radius - 0.075 * 2 / radius, 0.012);
  }
  EXPECT_FALSE(smooth.project(center + Vec3d{radius - 1, 0, 0}, 0.5)) << "no surface within reach";
}

/// Samples on x = 12 + shift(y, z), seen along `direction`, evenly 4 per unit of area.
template <class Shift>
GridSamples near_plane(Vec3f direction, Shift&& shift) {
  GridSamples samples;
  samples.bricks = BrickGrid(BrickMask::whole({3, 3, 3}), Context(1));
  samples.begin.push_back(0);
  for (size_t b = 0; b < samples.bricks.size(); ++b) {
    if (samples.bricks.coord(b).x == 1)
      for (int y = 0; y < 16; ++y)
        for (int z = 0; z < 16; ++z) {
          const Vec3d local{4, 0.25 + 0.5 * y, 0.25 + 0.5 * z};
          const Vec3d at = Vec3d(samples.bricks.first_vertex(b)) + local;
          samples.local.push_back(Vec3f(local + Vec3d{shift(at.y, at.z), 0, 0}));
          samples.direction.push_back(direction);
          samples.sample_hash.push_back(static_cast<uint8_t>(Random(samples.sample_hash.size() + 1).next()));
        }
    samples.begin.push_back(static_cast<uint32_t>(samples.local.size()));
  }
  return samples;
}

GridSamples on_plane(double shift, Vec3f direction) {
  return near_plane(direction, [&](double, double) { return shift; });
}

TEST(Residuals, MeasureHowFarTheSamplesLieInwards) {
  const Sampled field = sampled([](Vec3d p) { return p.x - 12; });  // inside: larger x
  const SmoothField smooth(field.grid, field.value, Context(1));
  const Vec3d inwards{1, 0, 0}, at{12, 12.3, 11.9};
  const auto mean = [&](double shift, Vec3f direction, double scale) {
    const GridSamples samples = on_plane(shift, direction);
    return Residuals(samples, smooth, scale, Context(2)).mean_at(at, inwards);
  };
  EXPECT_NEAR(mean(0.1, {-1, 0, 0}, 0.1), 0.1, 2e-3);
  EXPECT_NEAR(mean(-0.05, {-1, 0, 0}, 0.1), -0.05, 2e-3);
  EXPECT_EQ(mean(0.1, {1, 0, 0}, 0.1), 0) << "seen from inside";
  EXPECT_EQ(mean(0.6, {-1, 0, 0}, 0.1), 0) << "outliers";
  EXPECT_NEAR(mean(0.6, {-1, 0, 0}, 1), 0.6, 0.05) << "none at this scale";
  const GridSamples samples = on_plane(0.1, {-1, 0, 0});
  const Residuals leftover(samples, smooth, 0.1, Context(1));
  EXPECT_EQ(leftover.mean_at(at, -inwards), 0) << "the other side of a sheet";
  EXPECT_EQ(leftover.mean_at(at + Vec3d{2, 0, 0}, inwards), 0) << "no sample within a voxel";
}

TEST(Residuals, IsWhatTheSurfaceMissesAndNotNoise) {
  const Sampled field = sampled([](Vec3d p) { return p.x - 12; });
  const SmoothField smooth(field.grid, field.value, Context(1));
  const auto wave = [](double y, double z) { return 0.05 * std::sin(0.8 * y) * std::cos(0.7 * z); };
  for (const double noise : {0.0, 0.005, 0.05}) {
    for (const double height : {0.0, 1.0}) {
      Random random(3);
      const GridSamples samples =
          near_plane({-1, 0, 0}, [&](double y, double z) { return height * wave(y, z) + noise * random.normal(); });
      const Residuals leftover(samples, smooth, 1, Context(2));
      double error = 0, still = 0;
      int count = 0;
      for (double y = 4; y < 20; y += 0.37)
        for (double z = 4; z < 20; z += 0.37, ++count) {
          error += std::abs(leftover.mean_at({12, y, z}, {1, 0, 0}) - height * wave(y, z));
          still += std::abs(height * wave(y, z));
        }
      if (height == 0)
        EXPECT_LE(error / count, 0.05 * noise) << noise;
      else
        EXPECT_LT(error, (noise < 0.05 ? 0.15 : 0.8) * still) << noise;
    }
  }
}

}  // namespace TEST_FILE
}  // namespace soapfilm
