#include "soapfilm/refine/refine.h"

#include <gtest/gtest.h>

#include "refine/band_support.h"
#include "soapfilm/error.h"
#include "soapfilm/mesh/topology.h"
#include "soapfilm/refine/topology/topology.h"
#include "support/hash.h"
#include "support/sanitized.h"

namespace soapfilm {
namespace TEST_FILE {

using namespace test;

std::string name_of(const testing::TestParamInfo<std::string>& info) { return info.param; }

class SmoothShape : public testing::TestWithParam<std::string> {};

TEST_P(SmoothShape, ViewingDirectionsGiveAHundredthOfAVoxelSlow) {
  const Solved solved(GetParam(), 110);
  const Refined result = refined(solved);
  EXPECT_LT(mean_error_vox(solved, result.mesh), 0.012);
  EXPECT_EQ(result.report.fit_weights.normals, 0) << "viewing directions are no normals";
  EXPECT_LT(result.report.fit_weights.noise, 0.03);
}

TEST_P(SmoothShape, StrengthFollowsTheNoiseSlow) {
  const Solved clean(GetParam(), 70), noisy(GetParam(), 70, 1, {.noise_vox = 1.0 / 3});
  const Refined of_clean = refined(clean), of_noisy = refined(noisy);
  EXPECT_GT(of_noisy.report.fit_weights.smoothing, 5 * of_clean.report.fit_weights.smoothing);
  EXPECT_LT(mean_error_vox(noisy, of_noisy.mesh), 0.08);
  // The noise along the normal is that along the ray times its cosine.
  EXPECT_NEAR(of_noisy.report.fit_weights.noise, 0.2, 0.05);
}

INSTANTIATE_TEST_SUITE_P(Shapes, SmoothShape, testing::Values("sphere", "torus", "knot"), name_of);

TEST(Refine, CreasesKeepTheirBendUnderNoiseSlow) {
  // If each vertex were reweighted by its own noisy curvature, without its neighbors: 0.10.
  const Solved solved("part", 80, 1, {.noise_vox = 1.0 / 3});
  const Refined result = refined(solved);
  EXPECT_TRUE(result.report.fit_weights.edge_preserving);
  EXPECT_LT(mean_error_vox(solved, result.mesh), 0.085);
}

TEST(Refine, StrongNoiseIsNotFollowedSlow) {
  // A surface that follows noise of a voxel has an error of 0.28 voxel; with the best smoothing for a sphere 0.1.
  const Solved solved("sphere", 70, 1, {.noise_vox = 1});
  const Refined result = refined(solved);
  EXPECT_LT(mean_error_vox(solved, result.mesh), 0.22);
  const double bend = std::pow(result.report.fit_weights.smoothing, 0.25);
  EXPECT_GT(bend, 1.5 * result.report.fit_weights.noise);
}

/// Patches that choose the fit weights, and rows that give the median of the curvatures, are the same or as good.
TEST(Refine, DependsLittleOnTheOrderOfTheAxesSlow) {
  constexpr int resolution = 140;  // more samples than are used
  const Disturbance noise{.noise_vox = 0.5};
  const Solved turned("plate", resolution, 1, noise);
  Solved along_world("plate", resolution, 1, noise);
  along_world.problem = make_problem(disturbed(*turned.truth, resolution, 1, noise), unturned(turned.problem.lattice));
  along_world.solution = solve(along_world.problem, 0.02, 1e-3);
  ASSERT_NE(turned.problem.lattice.axis_shift, 0);
  const Refined a = refined(turned), b = refined(along_world);
  EXPECT_NEAR(a.report.fit_weights.smoothing, b.report.fit_weights.smoothing, 0.01 * b.report.fit_weights.smoothing);
  const auto flips = static_cast<double>(b.report.flips);
  EXPECT_NEAR(static_cast<double>(a.report.flips), flips, 0.02 * flips);
  const double error = mean_error_vox(along_world, b.mesh);
  EXPECT_NEAR(mean_error_vox(turned, a.mesh), error, 0.02 * error);
}

TEST(Refine, IsModestWhereNoSampleDecidesTheSmoothing) {
  Solved solved("sphere", 40, 1, {.viewing = false});
  for (Vec3f& direction : solved.problem.samples.direction) direction = -direction;  // all seen from inside
  const Refined result = refined(solved);
  EXPECT_EQ(result.report.search.held_out_error, 0) << "no sample counts";
  EXPECT_LT(result.report.fit_weights.smoothing, 1);
}

TEST(Refine, TrueNormalsAreRecognisedAndHelpSlow) {
  const Disturbance normals{.noise_vox = 1.0 / 3, .viewing = false};
  const Solved solved("torus", 70, 1, normals);
  const Refined with = refined(solved), without = refined(solved, {{.normals = 0.0}});
  EXPECT_GT(with.report.fit_weights.normals, 0);
  EXPECT_LT(with.report.search.agreement_deg, 20);
  EXPECT_LT(mean_error_vox(solved, with.mesh), 0.85 * mean_error_vox(solved, without.mesh));
}

TEST(Refine, ErrorFallsAtSecondOrderSlow) {
  const Solved coarse("torus", 52, 4), fine("torus", 92, 4);  // voxels 2 : 1
  const double ratio = mean_error_vox(coarse, refined(coarse).mesh) * coarse.problem.lattice.voxel /
                       (mean_error_vox(fine, refined(fine).mesh) * fine.problem.lattice.voxel);
  EXPECT_GT(ratio, 3);
}

TEST(Refine, OutliersAtMostDoubleTheErrorSlow) {
  const Solved clean("torus", 80), dirty("torus", 80, 1, {.outliers = 0.1});
  const Refined result = refined(dirty);
  EXPECT_LT(mean_error_vox(dirty, result.mesh), 2 * mean_error_vox(clean, refined(clean).mesh));
  EXPECT_GT(result.report.down_weighted, dirty.problem.samples.size() / 12);
}

TEST(Refine, MisalignedScansStayWellUnderTheirMisalignmentSlow) {
  const Solved solved("sphere", 70, 2, {.misaligned_vox = 0.5});
  EXPECT_LT(mean_error_vox(solved, refined(solved).mesh), 0.1);
}

TEST(Refine, FlatFacesHaveNoGroovesSlow) {
  const Solved solved("plate", 80);
  const Refined result = refined(solved);
  const double half = 0.5 * solved.truth->box().size().z;
  double sum = 0, worst = 0;
  size_t count = 0;
  for (const Vec3d& v : result.mesh.vertices) {
    if (std::abs(v.x) > 0.4 || std::abs(v.y) > 0.25) continue;  // away from the rounded edges
    const double off = std::abs(std::abs(v.z) - half) / solved.problem.lattice.voxel;
    sum += off;
    worst = std::max(worst, off);
    ++count;
  }
  EXPECT_LT(sum / static_cast<double>(count), 0.003);
  EXPECT_LT(worst, 0.03);
}

class Topology : public testing::TestWithParam<std::string> {};

/// Of the binary field itself.
TopologyReport topology_of_solve(const Solved& solved) {
  IndicatorField binary = smoothed_indicator(labels_of(solved.solution.finest, 0.5f, Context(1)), Context(1));
  const Dense<double> u = dense_u(solved.solution.finest, 0.5f);
  for (size_t b = 0; b < binary.grid.size(); ++b)
    for_each_vertex(binary.grid.coord(b), [&](Vec3i v, int i) { binary.value.brick(b)[i] = static_cast<float>(u[v]); });
  return check_topology(mesh_of(binary, 0.5f, solved.problem.lattice));
}

TEST_P(Topology, IsThatOfTheThresholdedSolve) {
  for (const double noise : {0.0, 1.0})
    for (const bool vanish : {false, true}) {
      const Solved solved(GetParam(), 60, 1, {.noise_vox = noise});
      const Refined result =
          refined(solved, {{.smoothing = noise > 0 ? std::optional(1e-4) : std::nullopt}, {}, vanish});
      const TopologyReport expected = topology_of_solve(solved);
      const TopologyReport found = check_topology(result.mesh);
      EXPECT_TRUE(found.watertight());
      EXPECT_EQ(found.components.size() + result.report.vanished, expected.components.size()) << "noise " << noise;
      EXPECT_EQ(found.genus(), expected.genus()) << "noise " << noise;
      EXPECT_GT(result.report.flips, 100u);
      if (!vanish) {
        EXPECT_EQ(result.report.vanished, 0u);
      }
      if (noise > 0) {
        EXPECT_GT(result.report.refused, 0u) << "the noise should have wanted another topology";
      }
    }
}

TEST_P(Topology, SurvivesSmoothingThatWouldFlattenIt) {
  const Solved solved(GetParam(), 60);
  const Refined result = refined(solved, {{.smoothing = 1e6}});
  const TopologyReport expected = topology_of_solve(solved), found = check_topology(result.mesh);
  EXPECT_EQ(found.components.size(), expected.components.size());
  EXPECT_EQ(found.genus(), expected.genus());
}

INSTANTIATE_TEST_SUITE_P(Shapes, Topology, testing::Values("plate", "sheets", "knot"), name_of);

TEST(Topology, IsKeptForAnyRequest) {
  // Half of the vertices near a solid ball's surface should change their label.
  const NarrowBand band = random_band(3, 1, 1);
  const GapSides none(band.grid());
  SignBits signs(band.grid(), none);
  Field<float> value(band.grid());
  RowArray phi = band.make_array();
  Random random(4);
  for (size_t b = 0; b < band.grid().size(); ++b)
    for_each_vertex(band.grid().coord(b), [&](Vec3i v, int i) {
      const double distance = 8 - norm(Vec3d(v) - Vec3d{11.5, 11.5, 11.5});
      if (distance > 0) signs.flip(b, i & 7, i >> 3 & 7, i >> 6);
      const uint32_t row = band.row(static_cast<int32_t>(b), i >> 3 & 7, i >> 6);
      phi.data()[row * brick_side + static_cast<size_t>(i & 7)] =
          static_cast<float>(std::abs(distance) < 3 ? random.normal() : distance);
    });
  const FlipCount count = follow(phi, band, signs, 0.05f, 0);
  EXPECT_GT(count.wanted - count.refused, 500u);
  EXPECT_GT(count.refused, 500u);
  for (size_t b = 0; b < band.grid().size(); ++b)
    for_each_vertex(band.grid().coord(b), [&](Vec3i, int i) {
      const uint32_t row = band.row(static_cast<int32_t>(b), i >> 3 & 7, i >> 6);
      value.brick(b)[i] = phi.data()[row * brick_side + static_cast<size_t>(i & 7)];
    });
  const Lattice lattice = place_lattice({{0, 0, 0}, {1, 1, 1}}, 0.1, 6);
  const TopologyReport found = check_topology(extract_isosurface(
      band.grid(), value, [](Vec3i) { return -1.0f; }, 0, lattice, Context(1)));
  EXPECT_EQ(found.components.size(), 1u);
  EXPECT_EQ(found.genus(), 0);
}

/// A ball with a cavity of one vertex, and near it components of two, one and one vertices.
struct Specks {
  static constexpr Vec3i ball_center{8, 8, 8}, hollow{8, 8, 8}, pair{18, 18, 18}, kept{20, 4, 4}, lost{4, 20, 4};

  explicit Specks(bool ball) {
    for (size_t b = 0; b < band.grid().size(); ++b)
      for_each_vertex(band.grid().coord(b), [&](Vec3i v, int i) {
        const bool in_ball = ball && v != hollow && norm(Vec3d(v - ball_center)) < 5;
        const bool inside = in_ball || v == pair || v == pair + Vec3i{1, 0, 0} || v == kept || v == lost;
        if (inside) signs.flip(b, i & 7, i >> 3 & 7, i >> 6);
        at(v) = inside ? 1.0f : -1.0f;
      });
  }
  float& at(Vec3i v) {
    const int32_t brick = band.grid().find({v.x >> 3, v.y >> 3, v.z >> 3});
    return phi.data()[band.row(brick, v.y & 7, v.z & 7) * brick_side + static_cast<size_t>(v.x & 7)];
  }

  NarrowBand band = random_band(3, 1, 1);
  GapSides none{band.grid()};
  SignBits signs{band.grid(), none};
  RowArray phi = band.make_array();
};

constexpr float held = 0.05f;

TEST(Topology, WhatTheFitShrinksToAVertexVanishes) {
  for (const bool vanish : {false, true}) {
    Specks specks(true);
    specks.at(Specks::hollow) = 0.2f;  // the fit puts these on the other side
    specks.at(Specks::lost) = -0.3f;
    for (const int x : {0, 1}) specks.at(Specks::pair + Vec3i{x, 0, 0}) = -0.1f;
    const FlipCount count = follow(specks.phi, specks.band, specks.signs, held, vanish ? 2 : 0);
    EXPECT_EQ(count.wanted, 4u);
    EXPECT_EQ(count.vanished, vanish ? 3u : 0u);
    EXPECT_EQ(count.refused, vanish ? 0u : 3u);
    EXPECT_EQ(specks.at(Specks::hollow), vanish ? 0.2f : -held);
    EXPECT_EQ(specks.at(Specks::lost), vanish ? -0.3f : held);
    EXPECT_EQ(specks.at(Specks::kept), 1);
    for (size_t b = 0; b < specks.band.grid().size(); ++b)
      for_each_vertex(specks.band.grid().coord(b), [&](Vec3i v, int i) {
        EXPECT_EQ(specks.signs.test(b, i & 7, i >> 3 & 7, i >> 6), specks.at(v) > 0);
      });
  }
}

TEST(Topology, OnlySpecksVanish) {
  // The fit leaves nothing of a ball of about 500 vertices, a pair and single ones.
  for (const size_t most : {1, 2, 600}) {
    Specks specks(true);
    for (size_t i = 0; i < specks.phi.size(); ++i) specks.phi.data()[i] = -std::abs(specks.phi.data()[i]);
    specks.at(Specks::kept) = 1;
    specks.signs.flip(static_cast<size_t>(specks.band.grid().find({1, 1, 1})), 0, 0, 0);  // the hollow, filled
    const FlipCount count = follow(specks.phi, specks.band, specks.signs, held, most);
    // With the pair and the ball too large, both are kept by one vertex.
    EXPECT_EQ(count.vanished, most == 1 ? 1u : most == 2 ? 2u : 3u);
    EXPECT_EQ(specks.at(Specks::lost), -1);
    EXPECT_EQ(specks.at(Specks::kept), 1);
  }
}

TEST(Topology, WhatASpeckKeptApartMovesOnceItIsGone) {
  Specks specks(true);
  const Vec3i between{14, 8, 8}, speck{15, 8, 8};  // between the ball and a small component that the fit removes
  specks.signs.flip(static_cast<size_t>(specks.band.grid().find({1, 1, 1})), speck.x & 7, speck.y & 7, speck.z & 7);
  specks.at(speck) = -0.2f;
  for (const Vec3i v : {Vec3i{13, 8, 8}, between}) specks.at(v) = 0.2f;
  const FlipCount count = follow(specks.phi, specks.band, specks.signs, held, 2);
  EXPECT_EQ(count.wanted, 3u);
  EXPECT_EQ(count.vanished, 1u);
  EXPECT_EQ(count.refused, 0u);
}

TEST(Topology, TheLastObjectDoesNotVanish) {
  // Two of these are one vertex each, and so is the rest of the pair.
  Specks specks(false);
  for (const Vec3i v : {Specks::kept, Specks::lost, Specks::pair, Specks::pair + Vec3i{1, 0, 0}}) specks.at(v) = -0.3f;
  const FlipCount count = follow(specks.phi, specks.band, specks.signs, held, 2);
  EXPECT_EQ(count.vanished, 2u);
  EXPECT_EQ(count.refused, 1u);
  EXPECT_EQ(specks.signs.count(), 1u);
}

TEST(Refine, GivesTheSameBytesForAnyNumberOfThreads) {
  const Solved solved("knot", sanitized ? 40 : 60, 1, {.noise_vox = 0.25, .outliers = 0.05});
  const uint64_t expected = hash_mesh(refined(solved).mesh);
  for (const int threads : sanitized ? std::vector{3} : std::vector{2, 3, 8})
    EXPECT_EQ(hash_mesh(refined(solved, {}, threads).mesh), expected);
}

class SparseSamples : public testing::TestWithParam<std::string> {};

TEST_P(SparseSamples, OfNoiseAreFittedOnCoarserVerticesSlow) {
  // A grid 2.5 times as fine as the samples: on the grid itself the sphere's error is 1.4 times as large.
  constexpr double finer = 2.5;
  const Solved solved(GetParam(), 12 + static_cast<int>(76 * finer), 1 / (finer * finer), {.noise_vox = finer / 3});
  const Refined coarse = refined(solved), fine = refined(solved, {{.sparse = 0}});
  EXPECT_EQ(coarse.report.spacing, 2);
  EXPECT_EQ(fine.report.spacing, 1);
  EXPECT_LT(mean_error_vox(solved, coarse.mesh), 0.95 * mean_error_vox(solved, fine.mesh));
  const TopologyReport of_coarse = check_topology(coarse.mesh), of_fine = check_topology(fine.mesh);
  EXPECT_TRUE(of_coarse.watertight());
  EXPECT_EQ(of_coarse.components.size(), of_fine.components.size());
  EXPECT_EQ(of_coarse.genus(), of_fine.genus());
  // Reported in voxels of the grid.
  EXPECT_NEAR(coarse.report.fit_weights.noise, fine.report.fit_weights.noise, 0.1);
  EXPECT_NEAR(coarse.report.search.held_out_error, fine.report.search.held_out_error, 0.1);
}

INSTANTIATE_TEST_SUITE_P(Shapes, SparseSamples, testing::Values("sphere", "torus", "knot"), name_of);

TEST(Refine, SparseSamplesTakeTheStrengthThatIsAskedFor) {
  const Solved solved("sphere", 72, 0.06, {.noise_vox = 0.9});
  const Refined result = refined(solved, {{.smoothing = 8.0, .normals = 0.25}});
  EXPECT_GT(result.report.spacing, 1);
  EXPECT_EQ(result.report.fit_weights.smoothing, 8);
  EXPECT_EQ(result.report.fit_weights.normals, 0.25);
  EXPECT_EQ(check_topology(result.mesh).components.size(), 1u);
}

TEST(Refine, SparseSamplesGiveTheSameBytesForAnyNumberOfThreads) {
  const Solved solved("sphere", 72, 0.06, {.noise_vox = 0.9});
  const Refined expected = refined(solved);
  EXPECT_GT(expected.report.spacing, 1);
  for (const int threads : sanitized ? std::vector{3} : std::vector{2, 3, 8})
    EXPECT_EQ(hash_mesh(refined(solved, {}, threads).mesh), hash_mesh(expected.mesh));
}

TEST(Refine, AnUnknownDensityIsNotASparseOne) {
  Solved solved("sphere", 72, 0.06, {.noise_vox = 0.9});
  EXPECT_GT(refined(solved).report.spacing, 1);
  solved.density = 0;
  EXPECT_EQ(refined(solved).report.spacing, 1);
}

TEST(Refine, SparseSamplesWithoutNoiseAreFittedOnTheGridItself) {
  const Solved solved("torus", 60, 0.2);
  const Refined result = refined(solved);
  EXPECT_EQ(result.report.spacing, 1);
  EXPECT_EQ(hash_mesh(result.mesh), hash_mesh(refined(solved, {{.sparse = 0}}).mesh));
}

TEST(Refine, RefusesParametersOutOfRange) {
  const auto message = [](const RefineSetup& params) -> std::string {
    try {
      validate(params);
    } catch (const ParameterError& error) {
      return error.what();
    }
    return "accepted";
  };
  EXPECT_EQ(message({}), "accepted");
  EXPECT_EQ(message({{.smoothing = -1.0}}), "smoothing = -1, must be in [1e-06, 1e+06]");
  EXPECT_NE(message({{.reach = 9}}).find("refine reach = 9"), std::string::npos);
  EXPECT_NE(message({{.sparse = -1}}).find("refine sparse = -1"), std::string::npos);
  RefineSetup hasty;
  hasty.robust.reweighting_steps = {2, 0};
  EXPECT_EQ(message(hasty), "refine reweighting_steps = 0, must be in [1, 10000]");
  hasty.robust.reweighting_steps = {};
  EXPECT_EQ(message(hasty), "rounds of refine reweighting_steps = 0, must be in [1, 20]");
}

}  // namespace TEST_FILE
}  // namespace soapfilm
