// The grid has axes, but the result must almost not depend on them: permutations, flips, translations, units.
#include <gtest/gtest.h>

#include "soapfilm/reconstruct.h"
#include "support/dense.h"
#include "support/problem.h"

namespace soapfilm {
namespace TEST_FILE {

using namespace test;

const Context one_thread(1);
constexpr double lambda = 0.02;
constexpr double tolerance = 1e-5;

struct Solved {
  Lattice lattice;
  Dense<double> u;
  Dense<uint8_t> labels;
  Energies energies;
};

Solved solved(const PointCloud& cloud, const Lattice& lattice) {
  const Problem problem = make_problem(cloud, lattice);
  const PyramidSolution solution = solve(problem, lambda, tolerance);
  return {lattice, dense_u(solution.finest), dense_labels(solution.finest),
          evaluate_energy(solution.finest, {}, one_thread)};
}

PointCloud noisy(const std::string& shape, double noise_vox) {
  constexpr int resolution = 56;
  PointCloud cloud = sampled(shape, resolution, 1);
  add_noise(cloud, noise_vox / (resolution - 12), 5);
  return cloud;
}

struct Case {
  std::string shape;
  double noise_vox;
};
void PrintTo(const Case& c, std::ostream* out) { *out << c.shape << ", noise " << c.noise_vox << " voxels"; }
const Case cases[] = {{"sphere", 0}, {"part", 0}, {"knot", 0}, {"torus", 0.33}, {"part", 0.33}};

class Symmetry : public testing::TestWithParam<Case> {
 protected:
  PointCloud cloud = noisy(GetParam().shape, GetParam().noise_vox);
  Lattice lattice = unturned(lattice_of(cloud, 56));
  Solved original = solved(cloud, lattice);
};

template <class T>
Vec3<T> permuted(Vec3<T> v, const std::array<int, 3>& from) {
  return {v[from[0]], v[from[1]], v[from[2]]};
}

/// The same labels except for ties.
TEST_P(Symmetry, AxisPermutationsPermuteTheLabels) {
  for (const std::array<int, 3> from : {std::array{1, 2, 0}, std::array{1, 0, 2}, std::array{2, 1, 0}}) {
    const PointCloud turned = transformed(
        cloud, [&](Vec3d p) { return permuted(p, from); }, [&](Vec3f n) { return permuted(n, from); });
    const Solved other = solved(turned, unturned(lattice_of(turned, 56)));
    EXPECT_EQ(other.lattice.size, permuted(lattice.size, from));
    size_t different = 0;
    original.labels.for_each([&](Vec3i v) { different += original.labels[v] != other.labels.get(permuted(v, from)); });
    EXPECT_LE(static_cast<double>(different), lattice.vertices() / 20000);
    EXPECT_NEAR(other.energies.primal, original.energies.primal, 2e-5 * std::abs(original.energies.primal));
  }
}

/// Whether every label that differs is within a voxel of both surfaces.
size_t moved_beyond_a_voxel(const Dense<uint8_t>& a, const Dense<uint8_t>& b) {
  const auto near_surface = [](const Dense<uint8_t>& labels, Vec3i v) {
    for (int k = 0; k < 27; ++k)
      if (labels.get(v + slot_offset(k)) != labels[v]) return true;
    return false;
  };
  size_t count = 0;
  a.for_each([&](Vec3i v) {
    if (a[v] != b[v]) count += !near_surface(a, v) || !near_surface(b, v);
  });
  return count;
}

/// Forward differences are not symmetric along an axis: the energy changes a little, the surface almost not.
TEST_P(Symmetry, AxisFlipsMoveTheSurfaceLittle) {
  for (int axis = 0; axis < 3; ++axis) {
    const PointCloud flipped = transformed(
        cloud,
        [&](Vec3d p) {
          p[axis] = -p[axis];
          return p;
        },
        [&](Vec3f n) {
          n[axis] = -n[axis];
          return n;
        });
    Lattice mirror = lattice;
    mirror.first_vertex[axis] = -(lattice.first_vertex[axis] + (lattice.size[axis] - 1) * lattice.voxel);
    const Solved other = solved(flipped, mirror);
    Dense<uint8_t> back(original.labels.size());
    back.for_each([&](Vec3i v) {
      Vec3i m = v;
      m[axis] = 2 * lattice.margin()[axis] + lattice.size[axis] - 1 - v[axis];
      back[v] = other.labels.get(m);
    });
    EXPECT_NEAR(other.energies.primal, original.energies.primal, 2e-3 * std::abs(original.energies.primal));
    EXPECT_EQ(moved_beyond_a_voxel(original.labels, back), 0u) << "axis " << axis;
  }
}

INSTANTIATE_TEST_SUITE_P(Shapes, Symmetry, testing::ValuesIn(cases),
                         [](const auto& c) { return c.param.shape + (c.param.noise_vox > 0 ? "_noisy" : ""); });

class Translation : public testing::TestWithParam<Case> {
 protected:
  static constexpr double voxel = 0x1p-5;

  /// Room to move, and samples on a fine dyadic raster: moving them by voxels is exact.
  Translation() {
    cloud = noisy(GetParam().shape, GetParam().noise_vox);
    for (Vec3d& p : cloud.positions)
      for (int axis = 0; axis < 3; ++axis) p[axis] = std::round(p[axis] * 0x1p20) * 0x1p-20;
    lattice = place_lattice({{-0.75, -0.75, -0.75}, {0.75, 0.75, 0.75}}, voxel, 6);
    original = solved(cloud, lattice);
  }

  Solved moved_by(Vec3i voxels) const {
    return solved(transformed(
                      cloud, [&](Vec3d p) { return p + Vec3d(voxels) * voxel; }, [](Vec3f n) { return n; }),
                  lattice);
  }
  /// Labels that differ although the relaxed u differs from the threshold by more than `tie`.
  size_t differences(const Solved& other, Vec3i voxels, double tie = 0) const {
    size_t count = 0;
    original.labels.for_each([&](Vec3i v) {
      if (original.labels[v] != other.labels.get(v + voxels)) count += std::abs(original.u[v] - 0.5) >= tie;
    });
    return count;
  }

  PointCloud cloud;
  Lattice lattice;
  Solved original;
};

/// The same except for the last bits of f (its sums are by bricks) and the distance to the border, which has an effect
/// on the dual: the same labels except for ties.
TEST_P(Translation, ByTheCoarsestCellMovesTheLabelsAlong) {
  const int cell = lattice.margin().x;
  ASSERT_GE(cell, 4);
  for (const Vec3i shift : {Vec3i{cell, 0, 0}, {0, -cell, cell}, {cell, cell, -cell}}) {
    const Solved other = moved_by(shift);
    EXPECT_EQ(differences(other, shift, 0.05), 0u);
    EXPECT_LE(differences(other, shift), 10u);
    EXPECT_NEAR(other.energies.primal, original.energies.primal, 1e-5 * std::abs(original.energies.primal));
  }
}

/// The two optima are the same; each solution is within its gap of it.
TEST_P(Translation, ByOneVoxelStaysWithinTheGap) {
  for (const Vec3i shift : {Vec3i{1, 0, 0}, {0, 1, 1}, {-1, -1, -1}}) {
    const Solved other = moved_by(shift);
    EXPECT_LE(std::abs(other.energies.primal - original.energies.primal),
              std::max(other.energies.gap, original.energies.gap));
    EXPECT_LE(static_cast<double>(differences(other, shift)), lattice.vertices() / 20000);
  }
}

INSTANTIATE_TEST_SUITE_P(Shapes, Translation, testing::ValuesIn(cases),
                         [](const auto& c) { return c.param.shape + (c.param.noise_vox > 0 ? "_noisy" : ""); });

PointCloud scaled(const PointCloud& cloud, double factor) {
  return transformed(
      cloud, [&](Vec3d p) { return p * factor; }, [](Vec3f n) { return n; });
}

Reconstruction reconstructed(const PointCloud& cloud) {
  ReconstructParams params;
  params.place.resolution = 56;
  return reconstruct(cloud, params, one_thread);
}

TEST(Units, PowersOfTwoScaleTheMeshExactly) {
  const PointCloud cloud = noisy("part", 0.2);
  const Reconstruction original = reconstructed(cloud);
  for (const double factor : {0x1p-10, 0x1p10, 0x1p30}) {
    const Reconstruction other = reconstructed(scaled(cloud, factor));
    EXPECT_EQ(other.report.certificate.inside, original.report.certificate.inside);
    EXPECT_EQ(other.report.certificate.lambda, original.report.certificate.lambda);
    ASSERT_EQ(other.mesh.vertices.size(), original.mesh.vertices.size());
    EXPECT_EQ(other.mesh.triangles, original.mesh.triangles);
    for (size_t i = 0; i < original.mesh.vertices.size(); ++i)
      ASSERT_EQ(other.mesh.vertices[i], original.mesh.vertices[i] * factor);
  }
}

/// If the lattice's axes are permuted too, x, y and z in turn change nothing.
TEST(Axes, TurningThemTurnsTheMeshExactly) {
  for (const double noise : {0.0, 0.3}) {
    const PointCloud cloud = noisy("part", noise);
    const Reconstruction original = reconstructed(cloud);
    for (const int turn : {1, 2}) {
      const Reconstruction other = reconstructed(transformed(
          cloud, [&](Vec3d p) { return permuted(p, turn); }, [&](Vec3f n) { return permuted(n, turn); }));
      EXPECT_NE(other.report.grid.axis_shift, original.report.grid.axis_shift);
      EXPECT_EQ(other.report.certificate.binary.primal, original.report.certificate.binary.primal);
      EXPECT_EQ(other.mesh.triangles, original.mesh.triangles);
      ASSERT_EQ(other.mesh.vertices.size(), original.mesh.vertices.size());
      for (size_t i = 0; i < original.mesh.vertices.size(); ++i)
        ASSERT_EQ(other.mesh.vertices[i], permuted(original.mesh.vertices[i], turn));
    }
  }
}

TEST(Units, MillimetersOrMetersGiveTheSameSurfaceButForTies) {
  const PointCloud cloud = noisy("part", 0.2);
  const Reconstruction original = reconstructed(cloud);
  for (const double factor : {1000.0, 1e-3, 25.4}) {
    const Reconstruction other = reconstructed(scaled(cloud, factor));
    const double inside = static_cast<double>(original.report.certificate.inside);
    EXPECT_NEAR(static_cast<double>(other.report.certificate.inside), inside, 1e-4 * inside);
    EXPECT_NEAR(other.mesh.volume(), original.mesh.volume() * factor * factor * factor, 1e-4 * other.mesh.volume());
    EXPECT_NEAR(other.report.certificate.lambda, original.report.certificate.lambda, 1e-3 * lambda);
  }
}

}  // namespace TEST_FILE
}  // namespace soapfilm
