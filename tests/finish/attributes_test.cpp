#include "soapfilm/finish/attributes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "soapfilm/core/random.h"
#include "soapfilm/error.h"
#include "soapfilm/reconstruct.h"

namespace soapfilm {
namespace TEST_FILE {

constexpr float none = std::numeric_limits<float>::quiet_NaN();

/// A plane of samples whose red, and whose height, is their x; on one half the label is 7, on the other 9.
struct Plane {
  PointCloud cloud;
  Lattice lattice;
  GridSamples samples;
  Mesh mesh;

  explicit Plane(size_t count = 4000) {
    Random random(5);
    cloud.columns = {{"height", {}, false}, {"classification", {}, true}};
    for (size_t i = 0; i < count; ++i) {
      const double x = random.uniform(), y = random.uniform();
      cloud.positions.push_back({x, y, 0.01 * random.uniform()});
      cloud.colors.push_back({static_cast<uint8_t>(std::lround(255 * x)), 10, 20});
      cloud.columns[0].values.push_back(static_cast<float>(x));
      cloud.columns[1].values.push_back(x < 0.5 ? 7.0f : 9.0f);
    }
    cloud.scans.push_back({"plane", 0, count, {}, {}, {}});
    lattice = place_lattice(cloud.box(), 0.02, 6);
    const std::vector<Vec3f> directions(count, Vec3f{0, 0, 1});
    samples = sort_samples(cloud, directions, lattice, Context(1));
    for (int i = 0; i < 500; ++i) mesh.vertices.push_back({random.uniform(), random.uniform(), 0});
  }

  Mesh carried(const std::vector<std::string>& names, int threads = 1) const {
    Mesh result = mesh;
    carry_attributes(sort_attributes(cloud, samples, names), samples, lattice, Context(threads), result);
    return result;
  }
};

TEST(Attributes, AreThoseOfTheSamplesAroundAVertex) {
  const Plane plane;
  const Mesh mesh = plane.carried({"all"});
  ASSERT_EQ(mesh.attributes.size(), 2u);
  ASSERT_EQ(mesh.colors.size(), mesh.vertices.size());
  for (size_t v = 0; v < mesh.vertices.size(); ++v) {
    const double x = mesh.vertices[v].x;
    EXPECT_NEAR(mesh.colors[v][0], 255 * x, 6) << x;
    EXPECT_EQ(mesh.colors[v][1], 10);
    EXPECT_NEAR(mesh.attributes[0].values[v], x, 0.02);
    const float label = mesh.attributes[1].values[v];
    EXPECT_TRUE(label == 7 || label == 9) << "a label is one of those that samples have: " << label;
    if (std::abs(x - 0.5) > 0.03) {
      EXPECT_EQ(label, x < 0.5 ? 7 : 9);
    }
  }
  EXPECT_TRUE(mesh.attributes[1].is_label);
}

TEST(Attributes, OnlyThoseThatAreNamedComeAlong) {
  const Plane plane(400);
  EXPECT_TRUE(sort_attributes(plane.cloud, plane.samples, {}).empty());
  const Mesh heights = plane.carried({"height"});
  EXPECT_TRUE(heights.colors.empty());
  ASSERT_EQ(heights.attributes.size(), 1u);
  EXPECT_EQ(heights.attributes[0].name, "height");
  EXPECT_EQ(plane.carried({"color"}).attributes.size(), 0u);
  EXPECT_NO_THROW(check_attributes(plane.cloud, std::vector<std::string>{"color", "height"}));
  try {
    check_attributes(plane.cloud, std::vector<std::string>{"hight"});
    FAIL();
  } catch (const ParameterError& error) {
    EXPECT_STREQ(error.what(), "attributes = hight, must be among all, color, height, classification");
  }
}

TEST(Attributes, WhereNoSampleIsWithinReachTheNearestOneCounts) {
  Plane plane(400);
  plane.mesh.vertices = {{0.25, 0.5, 3}, {0.9, 0.1, -2}};
  const Mesh mesh = plane.carried({"height"});
  EXPECT_NEAR(mesh.attributes[0].values[0], 0.25, 0.1);
  EXPECT_NEAR(mesh.attributes[0].values[1], 0.9, 0.1);
}

TEST(Attributes, ValuesThatAreNoNumberDoNotCount) {
  Plane plane;
  for (size_t i = 0; i < plane.cloud.size(); i += 2) plane.cloud.columns[0].values[i] = none;
  const Mesh half = plane.carried({"height"});
  for (size_t v = 0; v < half.vertices.size(); ++v) EXPECT_NEAR(half.attributes[0].values[v], half.vertices[v].x, 0.05);
  plane.cloud.columns[0].values.assign(plane.cloud.size(), none);
  EXPECT_TRUE(std::isnan(plane.carried({"height"}).attributes[0].values[0]));
}

TEST(Attributes, DoNotDependOnThreads) {
  const Plane plane;
  const Mesh one = plane.carried({"all"}), three = plane.carried({"all"}, 3);
  EXPECT_EQ(one.colors, three.colors);
  EXPECT_EQ(one.attributes[0].values, three.attributes[0].values);
}

TEST(Attributes, OfACloudReachItsMesh) {
  Random random(2);
  PointCloud cloud;
  cloud.columns = {{"intensity", {}, false}};
  for (int i = 0; i < 6000; ++i) {
    const Vec3d n = normalized(Vec3d{random.normal(), random.normal(), random.normal()});
    cloud.positions.push_back(n);
    cloud.normals.push_back(static_cast<Vec3f>(n));
    cloud.colors.push_back({static_cast<uint8_t>(n.z > 0 ? 200 : 40), 0, 0});
    cloud.columns[0].values.push_back(static_cast<float>(n.x));
  }
  cloud.scans.push_back({"sphere", 0, cloud.size(), {}, {}, {}});
  ReconstructParams params;
  params.place.resolution = 40;
  const Mesh plain = reconstruct(cloud, params, Context(1)).mesh;
  EXPECT_EQ(plain.colors.size(), plain.vertices.size()) << "colors come along by default, columns when they are named";
  EXPECT_TRUE(plain.attributes.empty());
  params.surface.attributes = {"intensity"};
  const Mesh mesh = reconstruct(std::move(cloud), params, Context(2)).mesh;
  EXPECT_TRUE(mesh.colors.empty());
  EXPECT_EQ(mesh.vertices, plain.vertices);
  ASSERT_EQ(mesh.attributes.size(), 1u);
  for (size_t v = 0; v < mesh.vertices.size(); ++v) EXPECT_NEAR(mesh.attributes[0].values[v], mesh.vertices[v].x, 0.06);
  for (size_t v = 0; v < plain.vertices.size(); ++v)
    if (std::abs(plain.vertices[v].z) > 0.15) {
      EXPECT_EQ(plain.colors[v][0], plain.vertices[v].z > 0 ? 200 : 40);
    }
}

}  // namespace TEST_FILE
}  // namespace soapfilm
