#include "soapfilm/finish/trim.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>
#include <vector>

#include "soapfilm/core/random.h"
#include "soapfilm/error.h"
#include "soapfilm/finish/nearest_sample.h"
#include "soapfilm/mesh/topology.h"

namespace soapfilm {
namespace TEST_FILE {

constexpr int side = 60;

Lattice lattice_of(bool open) {
  Lattice lattice;
  lattice.size = {side + 20, side + 20, side + 20};
  lattice.voxel = 0.5;
  lattice.first_vertex = {-2, 7, 100};
  lattice.open = open;
  return lattice;
}

/// Lattice coordinates of a place on the sheet, in voxels from its corner.
Vec3d on_sheet(double x, double y) { return {10 + x, 10 + y, 30 + std::sin(0.1 * x)}; }

/// A sheet of side x side squares.
Mesh sheet(const Lattice& lattice) {
  Mesh mesh;
  for (int y = 0; y <= side; ++y)
    for (int x = 0; x <= side; ++x) mesh.vertices.push_back(lattice.to_world(on_sheet(x, y)));
  const auto at = [](int x, int y) { return static_cast<uint32_t>(y * (side + 1) + x); };
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) {
      mesh.triangles.push_back({at(x, y), at(x + 1, y), at(x + 1, y + 1)});
      mesh.triangles.push_back({at(x, y), at(x + 1, y + 1), at(x, y + 1)});
    }
  return mesh;
}

GridSamples samples_where(const Lattice& lattice, const std::function<bool(double, double)>& seen) {
  PointCloud cloud;
  Random random(3);
  for (int i = 0; i < 4 * side * side; ++i) {
    const double x = random.uniform(0, side), y = random.uniform(0, side);
    if (seen(x, y)) cloud.positions.push_back(lattice.to_world(on_sheet(x, y) + Vec3d{0, 0, 0.1 * random.normal()}));
  }
  cloud.normals.assign(cloud.size(), {0, 0, 1});
  return sort_samples(cloud, cloud.normals, lattice, Context(1));
}

/// The nearest of all samples, voxels.
double brute_force(const GridSamples& samples, Vec3d place) {
  double best = std::numeric_limits<double>::infinity();
  for (size_t b = 0; b < samples.bricks.size(); ++b)
    for (uint32_t s = samples.begin[b]; s < samples.begin[b + 1]; ++s)
      best = std::min(best, norm(Vec3d(samples.bricks.first_vertex(b)) + Vec3d(samples.local[s]) - place));
  return best;
}

bool middle(double x, double y) { return x > 15 && x < 45 && y > 15 && y < 45; }
bool but_a_hole(double x, double y) { return std::hypot(x - 30, y - 30) > 9; }

struct Trimmed {
  Lattice lattice;
  Mesh before, after;
  GridSamples samples;
  TrimReport report;

  Trimmed(bool open, const std::function<bool(double, double)>& seen, const TrimParams& params = {}, int threads = 2)
      : lattice(lattice_of(open)), before(sheet(lattice)), after(before), samples(samples_where(lattice, seen)) {
    trim(after, samples, lattice, {params, 4, open}, Context(threads), report);
  }
  double voxels(Vec3d vertex) const { return distance_to_samples(samples, lattice.to_lattice(vertex), 0, 20); }
};

TEST(Trim, DistancesAreThoseOfAllSamplesWithinTheirLimits) {
  const Lattice lattice = lattice_of(true);
  const GridSamples samples = samples_where(lattice, middle);
  Random random(9);
  for (int i = 0; i < 300; ++i) {
    const Vec3d place{random.uniform(-5, 85), random.uniform(-5, 85), random.uniform(0, 70)};
    for (const auto& [enough, limit] : {std::pair{0.0, 3.0}, {1.5, 4.5}, {5.0, 26.0}})
      EXPECT_NEAR(distance_to_samples(samples, place, enough, limit),
                  std::clamp(brute_force(samples, place), enough, limit), 1e-9);
  }
}

TEST(Trim, TakesWhatIsFarAndNothingThatIsNear) {
  const Trimmed t(true, middle);
  const double limit = t.report.distance / t.lattice.voxel;
  EXPECT_DOUBLE_EQ(limit, 3);
  EXPECT_EQ(t.report.removed, 1u);
  size_t near = 0, found = 0;
  for (const Vec3d& v : t.before.vertices) {
    if (t.voxels(v) > limit) continue;
    ++near;
    found += static_cast<size_t>(std::count(t.after.vertices.begin(), t.after.vertices.end(), v));
  }
  EXPECT_EQ(found, near);
  for (const Vec3d& v : t.after.vertices) EXPECT_LT(t.voxels(v), limit + 1);
  // 30 voxels and 3 on each side, round corners.
  const double expected = (36.0 * 36 - (4 - 3.1416) * 9) * 0.25;
  EXPECT_NEAR(t.after.area(), expected, 0.06 * expected);
  EXPECT_NEAR(t.report.removed_area, 1 - t.after.area() / t.before.area(), 1e-12);
}

TEST(Trim, LeavesAManifoldOfOnePieceWithoutSlivers) {
  const Trimmed t(true, middle);
  const TopologyReport topology = check_topology(t.after);
  EXPECT_TRUE(topology.manifold());
  EXPECT_FALSE(topology.closed());
  EXPECT_EQ(topology.components.size(), 1u);
  for (const Triangle& f : t.after.triangles) {
    double longest = 0;
    const Vec3d a = t.after.vertices[f[0]], b = t.after.vertices[f[1]], c = t.after.vertices[f[2]];
    for (const Vec3d& e : {b - a, c - b, a - c}) longest = std::max(longest, norm(e));
    const Vec3d twice = cross(b - a, c - a);
    EXPECT_GT(twice.z, 0) << "faces up";
    EXPECT_GT(norm(twice) / longest, 0.1 * longest) << "height over longest edge";
  }
}

TEST(Trim, HolesInsideStayFilledUnlessAskedFor) {
  const Trimmed filled(true, but_a_hole), open(true, but_a_hole, {.holes = true});
  EXPECT_EQ(filled.report.filled, 1u);
  EXPECT_EQ(filled.report.removed, 0u);
  EXPECT_EQ(filled.after.vertices, filled.before.vertices);
  EXPECT_EQ(filled.after.triangles, filled.before.triangles);
  EXPECT_EQ(open.report.removed, 1u);
  const double hole = 3.1416 * 36 * 0.25;  // radius 9 - 3
  EXPECT_NEAR(open.before.area() - open.after.area(), hole, 0.25 * hole);
}

TEST(Trim, OfAClosedLatticeLargeMembranesAreCutAndSmallOnesKept) {
  // The skirt is no border there, but most of the area; the hole is 3 % of it.
  EXPECT_EQ(Trimmed(false, middle).report.removed, 1u);
  EXPECT_EQ(Trimmed(false, but_a_hole).report.removed, 0u);
  const Trimmed both(false, [](double x, double y) { return middle(x, y) && but_a_hole(x, y); });
  EXPECT_EQ(both.report.removed, 1u);
  EXPECT_EQ(both.report.filled, 1u);
}

/// Two round gaps in the samples, 10 and 18 voxels wide; a voxel is half a unit of the input.
TEST(Trim, GapsAreFilledUpToTheWidthAskedFor) {
  const auto two_gaps = [](double x, double y) {
    return std::hypot(x - 18, y - 30) > 5 && std::hypot(x - 42, y - 30) > 9;
  };
  for (const bool open : {false, true}) {
    for (const auto& [widest, filled] : {std::pair{4.0, 0u}, {7.0, 1u}, {11.0, 2u}}) {
      const Trimmed t(open, two_gaps, {.fill_holes = widest});
      EXPECT_EQ(t.report.filled, filled) << widest;
      EXPECT_EQ(t.report.removed, 2 - filled) << widest;
      EXPECT_EQ(t.after.triangles == t.before.triangles, filled == 2);
    }
  }
}

TEST(Trim, PiecesAroundSingleOutliersGo) {
  const auto and_one = [first = true](double x, double y) mutable {
    if (middle(x, y)) return true;
    return std::hypot(x - 7, y - 7) < 2 && std::exchange(first, false);
  };
  const Trimmed t(true, and_one);
  EXPECT_EQ(t.report.leftovers, 1u);
  EXPECT_EQ(check_topology(t.after).components.size(), 1u);
  const auto and_more = [](double x, double y) { return middle(x, y) || (x < 10 && y < 10); };
  EXPECT_EQ(Trimmed(true, and_more).report.leftovers, 0u);
}

TEST(Trim, WhereNothingIsNearTheMeshStays) {
  Trimmed t(true, middle);
  for (Vec3d& v : t.before.vertices) v.z += 10;
  Mesh mesh = t.before;
  TrimReport report;
  trim(mesh, t.samples, t.lattice, {{}, 4, t.lattice.open}, Context(1), report);
  EXPECT_TRUE(report.nothing_near);
  EXPECT_EQ(mesh.vertices, t.before.vertices);
}

TEST(Trim, SparseSamplesReachFarther) {
  Trimmed t(true, middle);
  TrimReport report;
  trim(t.before, t.samples, t.lattice, {{}, 0.25, t.lattice.open}, Context(1), report);
  EXPECT_DOUBLE_EQ(report.distance, 3 * 2 * t.lattice.voxel);
  EXPECT_GT(t.before.area(), t.after.area());
}

TEST(Trim, ThreadsDoNotMatter) {
  const Trimmed one(true, middle, {}, 1);
  for (const int threads : {2, 5}) {
    const Trimmed more(true, middle, {}, threads);
    EXPECT_EQ(more.after.vertices, one.after.vertices);
    EXPECT_EQ(more.after.triangles, one.after.triangles);
  }
}

TEST(Trim, ParametersOutOfRangeAreRefused) {
  EXPECT_THROW(validate(TrimParams{.distance = 0}), ParameterError);
  EXPECT_THROW(validate(TrimParams{.distance = std::nan("")}), ParameterError);
  EXPECT_THROW(validate(TrimParams{.on = false, .distance = 1}), ParameterError);
  EXPECT_THROW(validate(TrimParams{.on = false, .holes = true}), ParameterError);
  EXPECT_NO_THROW(validate(TrimParams{.on = true, .distance = 1, .holes = true}));
  EXPECT_THROW(validate(TrimParams{.fill_holes = 0}), ParameterError);
  EXPECT_THROW(validate(TrimParams{.fill_holes = std::nan("")}), ParameterError);
  EXPECT_THROW(validate(TrimParams{.on = false, .fill_holes = 1}), ParameterError);
  EXPECT_THROW(validate(TrimParams{.holes = true, .fill_holes = 1}), ParameterError);
  EXPECT_NO_THROW(validate(TrimParams{.on = true, .distance = 1, .fill_holes = 1}));
}

}  // namespace TEST_FILE
}  // namespace soapfilm
