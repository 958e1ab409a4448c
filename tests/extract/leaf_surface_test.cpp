#include "soapfilm/extract/leaf_surface.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <set>
#include <tuple>

#include "soapfilm/error.h"
#include "soapfilm/extract/isosurface.h"
#include "soapfilm/mesh/topology.h"
#include "support/dense.h"
#include "support/sanitized.h"
#include "tools/mesh/self_intersection.h"

namespace soapfilm {
namespace TEST_FILE {

using namespace test;

const Context one_thread(1);

constexpr int coarsest = 3;

/// Bricks of leaves per level in a cube of `roots` bricks of the coarsest level along each axis.
class Hierarchy {
 public:
  using Split = std::function<bool(int level, Vec3i brick)>;

  Hierarchy(int roots, const Split& split) : roots_(roots) {
    BrickRange::whole({roots, roots, roots}).for_each([&](Vec3i b) { divide(coarsest, b, split); });
    balance();
    for (int l = 0; l <= coarsest; ++l) {
      const int side = roots << (coarsest - l);
      BrickMask mask({side, side, side});
      for (const auto& [z, y, x] : bricks_[static_cast<size_t>(l)]) mask.set({x, y, z});
      grids_.emplace_back(mask, one_thread);
    }
    for (const BrickGrid& grid : grids_) levels_.push_back(&grid);
  }
  /// Leaves of random sizes.
  static Hierarchy random(int roots, uint64_t seed) {
    Random dice(seed);
    return {roots, [&](int, Vec3i) { return dice.uniform() < 0.45; }};
  }
  Hierarchy(const Hierarchy&) = delete;

  /// Values of a function of the place, in voxels of the finest level; outside at the cube's border.
  void fill(const std::function<double(Vec3d)>& f) {
    fields_.clear();
    for (int l = 0; l <= coarsest; ++l) {
      const BrickGrid& grid = grids_[static_cast<size_t>(l)];
      Field<float> field(grid);
      const int side = (roots_ * brick_side) << (coarsest - l);
      for (size_t b = 0; b < grid.size(); ++b)
        for_each_vertex(grid.coord(b), [&](Vec3i v, int i) {
          double value = std::ldexp(f(leaf_center(l, v)), -l);
          const auto at_end = [&](int x) { return x == 0 || x + 1 == side; };
          if (at_end(v.x) || at_end(v.y) || at_end(v.z)) value = -std::abs(value) - 0.1;
          field.brick(b)[i] = static_cast<float>(value);
        });
      fields_.push_back(std::move(field));
    }
  }

  Mesh mesh(const Context& context = one_thread) const {
    std::vector<const Field<float>*> values;
    for (const Field<float>& field : fields_) values.push_back(&field);
    return extract_leaf_surface(
        levels_, values, [](int, Vec3i) { return false; }, lattice(), context);
  }
  /// World and lattice coordinates are the same.
  static Lattice lattice() {
    Lattice lattice;
    lattice.voxel = 1;
    lattice.levels = 1;
    lattice.first_vertex = Vec3d(lattice.margin());
    return lattice;
  }

  double side() const { return (roots_ * brick_side) << coarsest; }
  LeafLevels levels() const { return levels_; }

 private:
  using Key = std::tuple<int, int, int>;
  std::set<Key>& at(int level) { return bricks_[static_cast<size_t>(level)]; }
  static Key key(Vec3i b) { return {b.z, b.y, b.x}; }

  void divide(int level, Vec3i brick, const Split& split) {
    if (level == 0 || !split(level, brick)) {
      at(level).insert(key(brick));
      return;
    }
    for (int k = 0; k < 8; ++k) divide(level - 1, child_of(brick, k), split);
  }

  /// Divides bricks that touch some two levels finer.
  void balance() {
    for (bool changed = true; changed;) {
      changed = false;
      for (int l = 0; l + 2 <= coarsest; ++l)
        for (const auto& [z, y, x] : std::set<Key>(at(l)))
          for (int slot = 0; slot < 27; ++slot)
            for (int above = l + 2; above <= coarsest; ++above) {
              const Vec3i n = Vec3i{x, y, z} + slot_offset(slot);
              const Vec3i ancestor{n.x >> (above - l), n.y >> (above - l), n.z >> (above - l)};
              if (at(above).erase(key(ancestor)) == 0) continue;
              for (int k = 0; k < 8; ++k) at(above - 1).insert(key(child_of(ancestor, k)));
              changed = true;
            }
    }
  }

  int roots_;
  std::set<Key> bricks_[coarsest + 1];
  std::vector<BrickGrid> grids_;
  std::vector<const BrickGrid*> levels_;
  std::vector<Field<float>> fields_;
};

void expect_closed_manifold(const Mesh& mesh) {
  const TopologyReport report = check_topology(mesh);
  EXPECT_TRUE(report.closed()) << report.boundary_edges << " open edges";
  EXPECT_TRUE(report.manifold()) << report.non_manifold_edges << " edges, " << report.non_manifold_vertices
                                 << " vertices";
  EXPECT_EQ(report.duplicate_triangles, 0u);
}

double ball(Vec3d q, double side) { return 0.37 * side - norm(q - Vec3d{0.503, 0.489, 0.511} * side); }
double torus(Vec3d q, double side) {
  const Vec3d p = q - Vec3d{0.491, 0.507, 0.513} * side;
  return 0.11 * side - std::hypot(std::hypot(p.x, p.y) - 0.28 * side, p.z);
}
/// Thinner than a coarse leaf, tilted.
double plate(Vec3d q, double side) {
  const Vec3d p = q - Vec3d{0.5, 0.5, 0.5} * side, n = normalized(Vec3d{0.3, 0.2, 1});
  const double across = std::abs(dot(p, n)) - 2.7, along = norm(p - n * dot(p, n)) - 0.35 * side;
  return -std::max(across, along);
}

TEST(LeafSurface, OfRandomHierarchiesIsClosedAndManifold) {
  size_t triangles = 0;
  for (uint64_t seed = sanitized ? 5 : 2; seed <= (sanitized ? 5u : 7u); ++seed) {
    Hierarchy hierarchy = Hierarchy::random(1 + static_cast<int>(seed % 2), seed);
    const double side = hierarchy.side();
    Random noise(seed);
    const std::function<double(Vec3d)> fields[] = {
        [&](Vec3d q) { return ball(q, side); }, [&](Vec3d q) { return torus(q, side); },
        [&](Vec3d q) { return plate(q, side); }, [&](Vec3d) { return noise.normal(); },
        [&](Vec3d) { return noise.uniform() < 0.5 ? -1.0 : 1.0; }};
    for (size_t k = 0; k < std::size(fields); ++k) {
      SCOPED_TRACE(testing::Message() << "seed " << seed << ", field " << k);
      hierarchy.fill(fields[k]);
      const Mesh mesh = hierarchy.mesh();
      expect_closed_manifold(mesh);
      if (k < 3) {
        EXPECT_EQ(count_self_intersections(mesh, one_thread), 0u);
      }
      triangles += mesh.triangles.size();
    }
  }
  EXPECT_GT(triangles, sanitized ? 10000u : 1000000u);
}

TEST(LeafSurface, OfOneLevelIsMarchingCubes) {
  for (const int level : {0, 1}) {
    Hierarchy hierarchy(level == 0 ? 1 : 2, [&](int l, Vec3i) { return l > level; });
    const double side = hierarchy.side();
    hierarchy.fill([&](Vec3d q) { return torus(q, side) + 3 * std::sin(0.3 * q.x) * std::cos(0.4 * q.y + 0.2 * q.z); });
    const Mesh mesh = hierarchy.mesh();
    // The same field on a grid of that level.
    const BrickGrid& grid = *hierarchy.levels()[static_cast<size_t>(level)];
    Field<float> values(grid);
    for (size_t b = 0; b < grid.size(); ++b)
      for_each_vertex(grid.coord(b), [&](Vec3i v, int i) {
        const Vec3d q = leaf_center(level, v);
        double value = std::ldexp(torus(q, side) + 3 * std::sin(0.3 * q.x) * std::cos(0.4 * q.y + 0.2 * q.z), -level);
        const auto at_end = [&](int x) { return x == 0 || x + 1 == static_cast<int>(side) >> level; };
        if (at_end(v.x) || at_end(v.y) || at_end(v.z)) value = -std::abs(value) - 0.1;
        values.brick(b)[i] = static_cast<float>(value);
      });
    Lattice lattice = Hierarchy::lattice();
    lattice.voxel = 1 << level;
    lattice.first_vertex = leaf_center(level, {0, 0, 0}) + Vec3d(lattice.margin()) * lattice.voxel;
    const Mesh expected = extract_isosurface(
        grid, values, [](Vec3i) { return -3.0f; }, 0, lattice, one_thread);
    ASSERT_EQ(mesh.vertices.size(), expected.vertices.size());
    ASSERT_EQ(mesh.triangles.size(), expected.triangles.size());
    const auto corners = [](const Mesh& m) {
      std::vector<std::array<double, 9>> all;
      for (const Triangle& t : m.triangles) {
        // From the smallest corner on, so that the order of corners does not matter.
        std::array<std::array<double, 3>, 3> c;
        for (size_t i = 0; i < 3; ++i) {
          const Vec3d p = m.vertices[t[i]];
          c[i] = {std::round(p.x * 1e6), std::round(p.y * 1e6), std::round(p.z * 1e6)};
        }
        std::rotate(c.begin(), std::min_element(c.begin(), c.end()), c.end());
        all.push_back({c[0][0], c[0][1], c[0][2], c[1][0], c[1][1], c[1][2], c[2][0], c[2][1], c[2][2]});
      }
      std::sort(all.begin(), all.end());
      return all;
    };
    const auto found = corners(mesh), wanted = corners(expected);
    for (size_t i = 0; i < found.size(); ++i)
      for (size_t k = 0; k < 9; ++k) ASSERT_NEAR(found[i][k], wanted[i][k], 0) << i;
  }
}

/// The border between levels moves the surface by less than a twentieth of the finer voxel.
TEST(LeafSurface, OfAHalfFineBallIsAsGoodAtTheBorderOfLevels) {
  Hierarchy hierarchy(2, [](int level, Vec3i b) { return level > 1 || b.x < 4; });
  const double side = hierarchy.side();
  hierarchy.fill([&](Vec3d q) { return ball(q, side); });
  const Mesh mesh = hierarchy.mesh();
  expect_closed_manifold(mesh);
  double fine = 0, coarse = 0, border = 0;
  for (const Triangle& t : mesh.triangles) {
    const Vec3d middle = (mesh.vertices[t[0]] + mesh.vertices[t[1]] + mesh.vertices[t[2]]) / 3.0;
    const double from_border = middle.x - 0.5 * side;
    double& worst = std::abs(from_border) < 3 ? border : from_border < 0 ? fine : coarse;
    worst = std::max(worst, std::abs(ball(middle, side)));
  }
  EXPECT_GT(fine, 0);
  EXPECT_GT(coarse, 1.5 * fine);
  EXPECT_LT(border, 0.05);
}

TEST(LeafSurface, ThreadsDoNotMatter) {
  Hierarchy hierarchy = Hierarchy::random(1, 11);
  const double side = hierarchy.side();
  hierarchy.fill([&](Vec3d q) { return torus(q, side); });
  const Mesh one = hierarchy.mesh(), many = hierarchy.mesh(Context(3));
  EXPECT_GT(one.triangles.size(), 1000u);
  EXPECT_EQ(one.vertices, many.vertices);
  EXPECT_EQ(one.triangles, many.triangles);
}

TEST(LeafSurface, RefusesLevelsThatAreNotBalanced) {
  const auto grid_of = [](int side, std::initializer_list<Vec3i> bricks) {
    BrickMask mask({side, side, side});
    for (const Vec3i b : bricks) mask.set(b);
    return BrickGrid(mask, one_thread);
  };
  const auto refused = [&](const BrickGrid& fine, const BrickGrid& coarse, const std::string& part) {
    const BrickGrid none(BrickMask({4, 4, 4}), one_thread);
    const BrickGrid* levels[] = {&fine, &none, &coarse};
    const Field<float> a(fine), b(none), c(coarse);
    const Field<float>* values[] = {&a, &b, &c};
    try {
      extract_leaf_surface(
          levels, values, [](int, Vec3i) { return false; }, Hierarchy::lattice(), one_thread);
      FAIL() << part;
    } catch (const ParameterError& error) {
      EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
    }
  };
  refused(grid_of(8, {{3, 3, 3}}), grid_of(2, {{1, 1, 1}}), "touches one of level 2");
  refused(grid_of(8, {{5, 5, 6}}), grid_of(2, {{1, 1, 1}}), "lies in one of level 2");
}

}  // namespace TEST_FILE
}  // namespace soapfilm
