#include "soapfilm/extract/isosurface.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "dense_reference.h"
#include "soapfilm/core/random.h"
#include "soapfilm/error.h"
#include "soapfilm/mesh/topology.h"
#include "support/sanitized.h"

namespace soapfilm {
namespace TEST_FILE {

/// Reported vertex 0 is lattice vertex 1 with one level: world coordinates are lattice coordinates.
Lattice unit_lattice() {
  Lattice lattice;
  lattice.first_vertex = {1, 1, 1};
  return lattice;
}

struct Band {
  BrickGrid grid;
  Field<float> value;
};

/// The bricks of `mask` with the values of `f` at their lattice vertices.
template <class Function>
Band sample(const BrickMask& mask, Function&& f) {
  const Context context(1);
  Band band{BrickGrid(mask, context), {}};
  band.value = Field<float>(band.grid);
  for (size_t b = 0; b < band.grid.size(); ++b) {
    for (int i = 0; i < brick_volume; ++i) {
      band.value.brick(b)[i] = f(band.grid.first_vertex(b) + vertex_in_brick(i));
    }
  }
  return band;
}

Mesh extract(const Band& band, const MissingBrickValue& missing, int threads = 1) {
  return extract_isosurface(band.grid, band.value, missing, 0.5f, unit_lattice(), Context(threads));
}

float zero_everywhere(Vec3i) { return 0.f; }

/// The corners' coordinates of all triangles, to 1e-9: what two meshes have in common whatever their numbering.
std::multiset<std::array<int64_t, 9>> triangle_soup(const Mesh& mesh) {
  std::multiset<std::array<int64_t, 9>> soup;
  for (const Triangle& t : mesh.triangles) {
    std::array<std::array<int64_t, 3>, 3> corners;
    for (int k = 0; k < 3; ++k) {
      for (int axis = 0; axis < 3; ++axis) corners[k][axis] = std::llround(mesh.vertices[t[k]][axis] * 1e9);
    }
    std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
    std::array<int64_t, 9> flat;
    for (int i = 0; i < 9; ++i) flat[i] = corners[i / 3][i % 3];
    soup.insert(flat);
  }
  return soup;
}

float ball(Vec3i v, Vec3d center, double radius) {
  return static_cast<float>(std::clamp(0.5 + 0.25 * (radius - norm(Vec3d(v) - center)), 0.0, 1.0));
}

/// The triangles of the whole surface that lie in the range, as a manifold that ends at its planes.
TEST(Isosurface, OfARangeIsThePartWithinIt) {
  const Vec3d center{20.3, 19.6, 20.1};
  const Band band = sample(BrickMask::whole({5, 5, 5}), [&](Vec3i v) { return ball(v, center, 13.2); });
  const Mesh whole = extract(band, zero_everywhere);
  for (const VertexRange& range : {VertexRange{{7, 9, 12}, {40, 40, 23}}, VertexRange{{16, 16, 16}, {24, 40, 40}},
                                   VertexRange{{0, 0, 0}, {39, 39, 39}}}) {
    const Mesh part =
        extract_isosurface(band.grid, band.value, zero_everywhere, 0.5f, unit_lattice(), Context(1), range);
    Mesh within = whole;
    std::erase_if(within.triangles, [&](const Triangle& t) {
      return std::any_of(t.begin(), t.end(), [&](uint32_t v) {
        const Vec3d& p = whole.vertices[v];
        bool in = true;
        for (int axis = 0; axis < 3; ++axis) in = in && p[axis] >= range.lo[axis] && p[axis] <= range.hi[axis];
        return !in;
      });
    });
    ASSERT_FALSE(part.triangles.empty());
    EXPECT_EQ(triangle_soup(part), triangle_soup(within));
    const TopologyReport topology = check_topology(part);
    EXPECT_TRUE(topology.manifold());
    EXPECT_EQ(topology.closed(), part.triangles.size() == whole.triangles.size());
    std::set<uint32_t> used;
    for (const Triangle& t : part.triangles) used.insert(t.begin(), t.end());
    EXPECT_EQ(used.size(), part.vertices.size());
  }
}

TEST(Isosurface, EqualsTheDenseReferenceOnNoiseInASparseBand) {
  for (uint64_t seed = 0; seed < (test::sanitized ? 8 : 20); ++seed) {
    Random random(seed);
    BrickMask mask({3, 2, 3});
    for (int b = 0; b < 18; ++b) mask.set({b % 3, b / 3 % 2, b / 6}, random.uniform() < 0.5);
    test::DenseField dense({24, 16, 24}, 0);
    const float density = static_cast<float>(random.uniform(0.05, 0.5));
    dense.for_each([&](Vec3i v) {
      if (mask.test(brick_of(v))) dense.at(v) = static_cast<float>(random.uniform()) * 0.5f / (1 - density);
    });
    const Band band = sample(mask, [&](Vec3i v) { return dense.at(v); });
    const Mesh mesh = extract(band, zero_everywhere);
    const Mesh expected = test::dense_isosurface(dense, 0.5f);
    EXPECT_EQ(mesh.vertices.size(), expected.vertices.size());
    EXPECT_TRUE(triangle_soup(mesh) == triangle_soup(expected)) << "seed " << seed;
    const TopologyReport report = check_topology(mesh);
    EXPECT_TRUE(report.triangles == 0 || report.watertight()) << summary(report);
  }
}

TEST(Isosurface, MissingBricksMayBeInside) {
  const Vec3d center{40.3, 39.8, 40.1};
  const double radius = 30;
  BrickMask mask({10, 10, 10});
  for (int b = 0; b < 1000; ++b) {
    const Vec3i coord{b % 10, b / 10 % 10, b / 100};
    const double d = norm(Vec3d(coord) * 8.0 + Vec3d{3.5, 3.5, 3.5} - center);
    mask.set(coord, std::abs(d - radius) < 9);
  }
  EXPECT_LT(mask.count(), 800u);
  const Band band = sample(mask, [&](Vec3i v) { return ball(v, center, radius); });
  const Mesh mesh = extract(band, [&](Vec3i b) { return norm(Vec3d(b) * 8.0 - center) < radius ? 1.f : 0.f; });
  const TopologyReport report = check_topology(mesh);
  EXPECT_TRUE(report.watertight()) << summary(report);
  EXPECT_EQ(report.components.size(), 1u);
  EXPECT_EQ(report.genus(), 0);
  for (const Vec3d& v : mesh.vertices) EXPECT_NEAR(norm(v - center), radius, 0.01);
  EXPECT_NEAR(mesh.volume() / (4.0 / 3 * 3.14159265358979 * radius * radius * radius), 1, 2e-3);
}

TEST(Isosurface, OneInsideBrickWithoutNeighborsIsClosed) {
  const Mesh mesh = extract(sample(BrickMask::whole({1, 1, 1}), [](Vec3i) { return 1.f; }), zero_everywhere);
  const TopologyReport report = check_topology(mesh);
  EXPECT_TRUE(report.watertight()) << summary(report);
  EXPECT_EQ(report.genus(), 0);
  const Box3d box = mesh.box();
  EXPECT_EQ(box.lo, (Vec3d{-0.5, -0.5, -0.5}));
  EXPECT_EQ(box.hi, (Vec3d{7.5, 7.5, 7.5}));
}

TEST(Isosurface, TheSameBytesForAnyNumberOfThreads) {
  const BrickMask mask = BrickMask::whole({8, 8, 8});
  Random random(3);
  std::vector<float> noise(1 << 18);
  for (float& n : noise) n = static_cast<float>(random.uniform(-0.3, 0.3));
  const Band band = sample(mask, [&](Vec3i v) {
    return ball(v, {32, 31, 30}, 22) + noise[static_cast<size_t>(v.x + 64 * (v.y + 64 * v.z))];
  });
  const Mesh one = extract(band, zero_everywhere, 1);
  EXPECT_TRUE(check_topology(one).watertight());
  for (const int threads : {2, 3, 8}) {
    const Mesh many = extract(band, zero_everywhere, threads);
    ASSERT_EQ(many.vertices, one.vertices);
    ASSERT_EQ(many.triangles, one.triangles);
  }
}

TEST(Isosurface, SmallTrianglesFaceWhereTheSurfaceDoes) {
  // Planes that all but meet a vertex, whose points must keep away from it together.
  const BrickMask mask = BrickMask::whole({2, 2, 2});
  Random random(5);
  for (int trial = 0; trial < 200; ++trial) {
    Vec3d normal = normalized(Vec3d{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)});
    const double rounding = trial < 20 ? 1e-6 : 0;  // on a plane of vertices
    if (trial < 20) normal = {0, 0, 1};
    const Vec3d through{8, 7, 9};
    const double offset = trial < 20 || trial % 4 == 0 ? 0 : random.uniform(-1, 1) * std::pow(10, -2 - trial % 4);
    const auto half_space = [&](Vec3i v) {  // within the box: missing bricks are outside
      if (std::min({v.x, v.y, v.z}) == 0 || std::max({v.x, v.y, v.z}) == 15) return 0.f;
      return static_cast<float>(0.5 + 0.1 * (dot(normal, Vec3d(v) - through) - offset + rounding * random.normal()));
    };
    const Mesh mesh = extract(sample(mask, half_space), zero_everywhere);
    double worst = 1;
    for (const Triangle& t : mesh.triangles) {
      const Vec3d corner[] = {mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]};
      if (std::any_of(corner, corner + 3, [&](Vec3d c) { return norm(c - through) > 3; })) continue;
      const Vec3d n = cross(corner[1] - corner[0], corner[2] - corner[0]);
      EXPECT_GT(norm(n), 1e-8);
      worst = std::min(worst, -dot(n, normal) / norm(n));
    }
    EXPECT_GT(worst, std::cos(0.03)) << "trial " << trial;
  }
}

/// Where the field is steep somewhere, every crowded vertex asks its neighbors what moves it; else most need not. Far
/// inside, a steep place draws nothing itself.
TEST(Isosurface, WhatMovesCrowdedVerticesDoesNotDependOnOtherPlaces) {
  const BrickMask mask = BrickMask::whole({6, 6, 6});
  for (const double radius : {15.0, 15.0002, 15.4, 16.0}) {
    const Vec3d center{24, 24, 24};
    Band band = sample(mask, [&](Vec3i v) { return ball(v, center, radius); });
    const Mesh mesh = extract(band, zero_everywhere);
    band.value.brick(static_cast<size_t>(band.grid.find({3, 3, 3})))[0] = 1e9f;
    const Mesh beside_steep = extract(band, zero_everywhere);
    ASSERT_GT(mesh.triangles.size(), 1000u);
    EXPECT_TRUE(mesh.vertices == beside_steep.vertices) << radius;
    EXPECT_TRUE(mesh.triangles == beside_steep.triangles) << radius;
  }
}

TEST(Isosurface, VerticesAreInTheWorldFrameAtFullAccuracy) {
  const Vec3d center{15.2, 16.1, 15.7};
  const Band band = sample(BrickMask::whole({4, 4, 4}), [&](Vec3i v) { return ball(v, center, 10); });
  Lattice lattice;
  lattice.voxel = 1e-3;
  lattice.first_vertex = {5e6, -5e6, 5e6};
  const Mesh mesh = extract_isosurface(band.grid, band.value, zero_everywhere, 0.5f, lattice, Context(1));
  const Vec3d world_center = lattice.to_world(center);
  for (const Vec3d& v : mesh.vertices) EXPECT_NEAR(norm(v - world_center), 0.01, 3e-5);
  EXPECT_TRUE(check_topology(mesh).watertight());
}

TEST(Isosurface, NothingInsideGivesAnEmptyMesh) {
  const Mesh mesh = extract(sample(BrickMask::whole({2, 2, 2}), [](Vec3i) { return 0.5f; }), zero_everywhere);
  EXPECT_TRUE(mesh.vertices.empty());
  EXPECT_TRUE(mesh.triangles.empty());
}

TEST(Isosurface, MissingBricksThatDisagreeAreRefused) {
  BrickMask mask({3, 3, 3});
  mask.set({0, 1, 1});
  const Band band = sample(mask, [](Vec3i) { return 0.f; });
  EXPECT_THROW(extract(band, [](Vec3i b) { return b == Vec3i{1, 1, 1} ? 1.f : 0.f; }), ParameterError);
}

TEST(Isosurface, AFieldOfAnotherGridIsRefused) {
  BrickMask mask({2, 1, 1});
  mask.set({0, 0, 0});
  Band band = sample(mask, [](Vec3i) { return 0.f; });
  band.value = Field<float>(2);
  EXPECT_THROW(extract(band, zero_everywhere), ParameterError);
}

}  // namespace TEST_FILE
}  // namespace soapfilm
