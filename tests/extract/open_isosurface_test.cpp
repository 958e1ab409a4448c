#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "dense_reference.h"
#include "soapfilm/core/random.h"
#include "soapfilm/error.h"
#include "soapfilm/extract/isosurface.h"
#include "soapfilm/mesh/topology.h"

namespace soapfilm {
namespace TEST_FILE {

/// Reported vertex 0 is lattice vertex 1 with one level: world coordinates are lattice coordinates.
Lattice unit_lattice() {
  Lattice lattice;
  lattice.first_vertex = {1, 1, 1};
  return lattice;
}

struct Seen {
  BrickGrid grid;
  Field<float> value;
  Field<float> weight;
};

template <class Value, class Weight>
Seen sample(const BrickMask& mask, Value&& value, Weight&& weight) {
  Seen seen{BrickGrid(mask, Context(1)), {}, {}};
  seen.value = Field<float>(seen.grid);
  seen.weight = Field<float>(seen.grid);
  for (size_t b = 0; b < seen.grid.size(); ++b) {
    for (int i = 0; i < brick_volume; ++i) {
      const Vec3i v = seen.grid.first_vertex(b) + vertex_in_brick(i);
      seen.value.brick(b)[i] = value(v);
      seen.weight.brick(b)[i] = weight(v);
    }
  }
  return seen;
}

Mesh extract(const Seen& seen, int threads = 1) {
  return extract_open_isosurface(seen.grid, seen.value, seen.weight, 0.5f, unit_lattice(), Context(threads));
}

/// The corners' coordinates of all triangles, to 1e-9: what two meshes have in common whatever their numbering.
std::multiset<std::array<int64_t, 9>> triangle_soup(const Mesh& mesh) {
  std::multiset<std::array<int64_t, 9>> soup;
  for (const Triangle& t : mesh.triangles) {
    std::array<std::array<int64_t, 3>, 3> corners;
    for (size_t k = 0; k < 3; ++k)
      for (int axis = 0; axis < 3; ++axis)
        corners[k][static_cast<size_t>(axis)] = std::llround(mesh.vertices[t[k]][axis] * 1e9);
    std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
    std::array<int64_t, 9> flat;
    for (size_t i = 0; i < 9; ++i) flat[i] = corners[i / 3][i % 3];
    soup.insert(flat);
  }
  return soup;
}

void expect_manifold_with_boundary(const Mesh& mesh) {
  const TopologyReport report = check_topology(mesh);
  EXPECT_TRUE(report.manifold()) << summary(report);
  EXPECT_EQ(report.unreferenced_vertices, 0u);
  EXPECT_EQ(report.zero_area_triangles, 0u);
}

/// Values and weights are noise on random bricks: every way in which drawn cells can meet around an edge occurs.
class NoiseOnRandomBricks : public testing::TestWithParam<double> {};

TEST_P(NoiseOnRandomBricks, EqualsTheDenseReferenceOfTheKnownCells) {
  for (uint64_t seed = 0; seed < 10; ++seed) {
    Random random(seed);
    BrickMask mask({3, 2, 3});
    for (int b = 0; b < 18; ++b) mask.set({b % 3, b / 3 % 2, b / 6}, random.uniform() < 0.7);
    test::DenseField value({24, 16, 24}, 0), weight({24, 16, 24}, 0);
    value.for_each([&](Vec3i v) {
      const auto drawn = static_cast<float>(random.uniform());
      const auto known = random.uniform() < GetParam() ? 0.25f : 0.f;
      if (!mask.test(brick_of(v))) return;
      value.at(v) = drawn;
      weight.at(v) = known;
    });
    const Mesh mesh = extract(sample(
        mask, [&](Vec3i v) { return value.at(v); }, [&](Vec3i v) { return weight.at(v); }));
    const Mesh expected = test::dense_isosurface(value, 0.5f, [&](Vec3i v) { return std::as_const(weight).at(v) > 0; });
    EXPECT_TRUE(triangle_soup(mesh) == triangle_soup(expected)) << "seed " << seed;
    EXPECT_GT(mesh.triangles.size(), 0u);
    EXPECT_GE(mesh.vertices.size(), expected.vertices.size());  // some are there twice
    expect_manifold_with_boundary(mesh);
  }
}

INSTANTIATE_TEST_SUITE_P(Known, NoiseOnRandomBricks, testing::Values(0.7, 0.9, 0.97),
                         [](const auto& known) { return "Percent" + std::to_string(std::lround(100 * known.param)); });

TEST(OpenIsosurface, WithEverythingKnownItIsTheClosedOne) {
  const BrickMask mask = BrickMask::whole({4, 4, 4});
  const auto ball = [](Vec3i v) { return static_cast<float>(10.5 - norm(Vec3d(v) - Vec3d{15.2, 16.1, 15.7})); };
  const Seen seen = sample(mask, ball, [](Vec3i) { return 1.f; });
  const Mesh open = extract(seen);
  const Mesh closed = extract_isosurface(
      seen.grid, seen.value, [](Vec3i) { return 0.f; }, 0.5f, unit_lattice(), Context(1));
  EXPECT_EQ(open.vertices, closed.vertices);
  EXPECT_EQ(open.triangles, closed.triangles);
  EXPECT_TRUE(check_topology(open).watertight());
}

TEST(OpenIsosurface, EndsWhereNothingIsKnown) {
  const Seen seen = sample(
      BrickMask::whole({3, 3, 1}), [](Vec3i v) { return static_cast<float>(4 - v.z); },
      [](Vec3i v) { return v.x >= 3 && v.y < 20 ? 1.f : 0.f; });
  const Mesh mesh = extract(seen);
  const Box3d box = mesh.box();
  EXPECT_EQ(box.lo, (Vec3d{3, 0, 3.5}));
  EXPECT_EQ(box.hi, (Vec3d{23, 19, 3.5}));  // where the grid ends, and where the known part ends
  EXPECT_DOUBLE_EQ(mesh.area(), 20 * 19);
  for (const Triangle& t : mesh.triangles) {
    const Vec3d a = mesh.vertices[t[0]];
    EXPECT_GT(cross(mesh.vertices[t[1]] - a, mesh.vertices[t[2]] - a).z, 0);  // towards the lower values
  }
  expect_manifold_with_boundary(mesh);
  EXPECT_EQ(check_topology(mesh).boundary_edges, 2u * (20 + 19));
}

TEST(OpenIsosurface, CellsThatMeetInAnEdgeOnlyHaveTheirOwnVertices) {
  // Around each edge along one axis, two drawn cells that share no face, both cut at this edge.
  for (int axis = 0; axis < 3; ++axis) {
    for (const int turned : {1, -1}) {
      const Vec3i middle{8, 8, 8};  // on the border of bricks: four of them own what is drawn
      const Seen seen = sample(
          BrickMask::whole({2, 2, 2}), [&](Vec3i v) { return v[axis] <= middle[axis] ? 1.f : 0.f; },
          [&](Vec3i v) {
            const Vec3i d = v - middle;
            const int b = d[(axis + 1) % 3], c = d[(axis + 2) % 3] * turned;
            const bool slab = d[axis] == 0 || d[axis] == 1;
            return slab && ((b >= 0 && c >= 0 && b <= 1 && c <= 1) || (b <= 0 && c <= 0 && b >= -1 && c >= -1)) ? 1.f
                                                                                                                : 0.f;
          });
      const Mesh mesh = extract(seen);
      EXPECT_EQ(mesh.triangles.size(), 4u);
      EXPECT_EQ(mesh.vertices.size(), 8u);
      EXPECT_EQ(check_topology(mesh).components.size(), 2u);
      expect_manifold_with_boundary(mesh);
    }
  }
}

TEST(OpenIsosurface, TheSameBytesForAnyNumberOfThreads) {
  const BrickMask mask = BrickMask::whole({6, 6, 6});
  Random random(5);
  std::vector<float> noise(48 * 48 * 48);
  for (float& n : noise) n = static_cast<float>(random.uniform());
  const auto at = [&](Vec3i v) { return noise[static_cast<size_t>(v.x + 48 * (v.y + 48 * v.z))]; };
  const Seen seen = sample(mask, at, [&](Vec3i v) { return at({v.y, v.z, v.x}) - 0.1f; });
  const Mesh one = extract(seen, 1);
  for (const int threads : {2, 5}) {
    const Mesh many = extract(seen, threads);
    ASSERT_EQ(many.vertices, one.vertices);
    ASSERT_EQ(many.triangles, one.triangles);
  }
}

TEST(OpenIsosurface, WeightsOfAnotherGridAreRefused) {
  BrickMask mask({2, 1, 1});
  mask.set({0, 0, 0});
  Seen seen = sample(
      mask, [](Vec3i) { return 0.f; }, [](Vec3i) { return 1.f; });
  seen.weight = Field<float>(2);
  EXPECT_THROW(extract(seen), ParameterError);
}

}  // namespace TEST_FILE
}  // namespace soapfilm
