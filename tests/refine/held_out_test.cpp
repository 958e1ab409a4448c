#include "soapfilm/refine/choose/held_out.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <set>
#include <tuple>

#include "refine/band_support.h"
#include "soapfilm/core/median.h"

namespace soapfilm {
namespace TEST_FILE {

using namespace test;

const Context one_thread(1);
constexpr size_t all = 1 << 30;

bool is_held_out(const GridSamples& samples, size_t s) { return samples.sample_hash[s] % 4 == 0; }

/// Value and gradient in the cell of a sample, from the definition; nothing where a corner is not in the band.
std::optional<FieldJet<double>> jet_at(const NarrowBand& band, const RowArray& phi, Vec3i brick, Vec3f local) {
  const Vec3i cell{std::min(static_cast<int>(local.x), 7), std::min(static_cast<int>(local.y), 7),
                   std::min(static_cast<int>(local.z), 7)};
  std::array<double, 8> corner;
  for (size_t k = 0; k < 8; ++k) {
    const Vec3i at = brick * brick_side + cell + octant_of(static_cast<int>(k));
    corner[k] = value_at(band, phi, at, std::numeric_limits<float>::quiet_NaN());
    if (std::isnan(corner[k])) return std::nullopt;
  }
  return trilinear(corner, Vec3d(local) - Vec3d(cell));
}

/// visit(sample, its brick) for the samples of some grid.
template <class Visit>
void for_each_sample(const GridSamples& samples, Visit&& visit) {
  for (size_t b = 0; b < samples.bricks.size(); ++b)
    for (uint32_t s = samples.begin[b]; s < samples.begin[b + 1]; ++s) visit(s, samples.bricks.coord(b));
}

/// A noisy sphere whose samples are all in use, unless a test says otherwise.
class NoisySphere : public testing::Test {
 protected:
  Solved solved{"sphere", 36, 1.0, {.noise_vox = 0.3, .viewing = false, .outliers = 0.02}};
  Start start = start_from(labels_of(solved.solution.finest, 0.5f, one_thread), 3, one_thread);
  GridSamples samples = [&] {
    GridSamples found = solved.problem.samples;
    for (size_t s = 0; s < found.size(); s += 10) found.direction[s] = -found.direction[s];  // seen from inside
    return found;
  }();

  /// Of the held-out samples, each at most 3, along the normals of phi0.
  std::vector<float> distances(const HeldOut& held_out, const RowArray& phi) const {
    std::vector<float> found;
    for_each_sample(samples, [&](size_t s, Vec3i brick) {
      const auto first = jet_at(held_out.band(), held_out.phi0(), brick, samples.local[s]);
      const auto now = jet_at(held_out.band(), phi, brick, samples.local[s]);
      if (!first || !is_held_out(samples, s)) return;
      const Vec3d direction(samples.direction[s]), normal = normalized(first->gradient);
      if (dot(direction, normal) > 0.3 * norm(direction)) return;
      const double slope = std::clamp(dot(now->gradient, normal), 0.02, 1.0);
      found.push_back(static_cast<float>(std::min(std::abs(now->value) / slope, 3.0)));
    });
    return found;
  }
  static double mean(const std::vector<float>& values) {
    return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
  }
  double median_angle(const HeldOut& held_out, const RowArray& phi) const {
    std::vector<double> angles;
    for_each_sample(samples, [&](size_t s, Vec3i brick) {
      if (const auto jet = jet_at(held_out.band(), phi, brick, samples.local[s]))
        angles.push_back(
            std::acos(std::clamp(-dot(normalized(Vec3d(samples.direction[s])), normalized(jet->gradient)), -1.0, 1.0)));
    });
    return median(angles) * 180 / std::numbers::pi;
  }
};

TEST_F(NoisySphere, MeanDistanceIsThatOfTheHeldOutSamplesAlongTheFirstNormals) {
  HeldOut held_out(start, samples, {}, {.samples = all}, one_thread);
  ASSERT_EQ(held_out.samples(), samples.size());
  for (const float noise : {0.0f, 0.5f, 4.0f}) {
    RowArray phi = random_array(held_out.band(), 2);
    for (size_t i = 0; i < phi.size(); ++i) phi.data()[i] = held_out.phi0().data()[i] + noise * phi.data()[i];
    const double expected = mean(distances(held_out, phi));
    EXPECT_NEAR(held_out.mean_distance(phi).value(), expected, 1e-4 * expected);
  }
  std::fill(samples.sample_hash.begin(), samples.sample_hash.end(), uint8_t{1});
  HeldOut nothing(start, samples, {}, {.samples = all}, one_thread);
  EXPECT_FALSE(nothing.mean_distance(nothing.phi0()));
  EXPECT_EQ(nothing.score(0.2, 0), 0);
}

TEST_F(NoisySphere, TheOutcomeIsThatOfTheFit) {
  for (const bool edges : {false, true}) {
    HeldOut held_out(start, samples, {}, {.samples = all}, one_thread);
    HeldOut again(start, samples, {}, {.samples = all}, one_thread);
    if (!edges) held_out.reset_curvature_weights();
    const auto outcome = held_out.outcome(0.5, 0.05);
    const RowArray& phi = again.fit({0.5, 0.05, 0.3, edges});
    const std::vector<float> found = distances(again, phi);
    EXPECT_NEAR(outcome.score, mean(found), 1e-4);
    EXPECT_NEAR(outcome.noise, 1.4826 * median(found), 1e-4);
    // The mean of the absolute values of as many normal deviates.
    const double variance = (1 - 2 / std::numbers::pi) * outcome.noise * outcome.noise;
    EXPECT_NEAR(outcome.standard_error, std::sqrt(variance / static_cast<double>(found.size())), 1e-4 * outcome.score);
    EXPECT_NEAR(outcome.agreement_deg, median_angle(again, phi), 0.01);
    EXPECT_NEAR(outcome.noise, 0.3, 0.1) << "that of the samples, outliers or not";
  }
}

TEST_F(NoisySphere, TheHeldOutSamplesPullNothing) {
  const FitWeights weights{0.3, 0.2, 0.3, false};
  HeldOut plain(start, samples, {}, {.samples = all}, one_thread);
  GridSamples turned = samples, moved = samples;
  for (size_t s = 0; s < samples.size(); ++s)
    if (is_held_out(samples, s))
      turned.direction[s] = -samples.direction[s];
    else
      moved.direction[s] = -samples.direction[s];
  HeldOut other(start, turned, {}, {.samples = all}, one_thread);
  HeldOut without(start, moved, {}, {.samples = all}, one_thread);
  const RowArray &phi = plain.fit(weights), &same = other.fit(weights), &unlike = without.fit(weights);
  double change = 0;
  for (size_t i = 0; i < phi.size(); ++i) {
    ASSERT_EQ(phi.data()[i], same.data()[i]);
    change = std::max(change, std::abs(static_cast<double>(phi.data()[i]) - unlike.data()[i]));
  }
  EXPECT_GT(change, 0.1);
}

TEST_F(NoisySphere, RemembersWhatItTried) {
  HeldOut held_out(start, samples, {}, {.samples = all}, one_thread);
  const double first = held_out.score(0.5, 0);
  held_out.score(2, 0);
  held_out.score(0.5, 0.1);
  EXPECT_EQ(held_out.score(0.5, 0), first);
  EXPECT_EQ(held_out.candidates(), 3);
  held_out.reset_curvature_weights();
  EXPECT_EQ(held_out.candidates(), 0) << "they were those of other fits";
  EXPECT_NE(held_out.score(0.5, 0), first);
}

TEST_F(NoisySphere, UsesWholePatchesUntilThereAreEnoughSamples) {
  using Patch = std::tuple<int, int, int>;
  const auto patch_of = [](Vec3i brick) { return Patch{brick.z / 2, brick.y / 2, brick.x / 2}; };
  std::map<Patch, size_t> samples_of;
  for_each_sample(samples, [&](size_t, Vec3i brick) { ++samples_of[patch_of(brick)]; });
  size_t largest = 0;
  for (const auto& [patch, count] : samples_of) largest = std::max(largest, count);
  std::set<std::set<Patch>> choices;
  for (uint64_t seed = 1; seed <= 5; ++seed) {
    const HeldOut held_out(start, samples, {}, {.samples = 700, .patch_bricks = 2, .seed = seed}, one_thread);
    EXPECT_GE(held_out.samples(), 700u);
    EXPECT_LT(held_out.samples(), 700 + largest);
    const BrickGrid& grid = held_out.band().grid();
    std::set<Patch> chosen;
    for (size_t b = 0; b < grid.size(); ++b) chosen.insert(patch_of(grid.coord(b)));
    size_t expected = 0;
    for (const Patch& patch : chosen) expected += samples_of[patch];
    EXPECT_EQ(held_out.samples(), expected) << "all samples of the patches";
    size_t vertices = 0;
    for_each_vertex(start.band, [&](Vec3i v, size_t i) {
      const Vec3i brick = brick_of(v);
      const int32_t with_samples = samples.bricks.find(brick);
      if (with_samples < 0 || chosen.count(patch_of(brick)) == 0) return;
      ++vertices;
      ASSERT_EQ(value_at(held_out.band(), held_out.phi0(), v, 99), start.phi0.data()[i]);
    });
    EXPECT_EQ(held_out.band().count(), vertices);
    choices.insert(chosen);
  }
  EXPECT_GT(choices.size(), 1u) << "the seed matters";
}

/// Samples in random bricks along the world's axes, one in each; the lattice has its axes shifted, and `finer` times
/// as many bricks along each axis. The band holds all vertices of those bricks.
std::set<std::tuple<int, int, int>> chosen_bricks(int shift, int finer) {
  constexpr int side = 12;
  Random random(4);
  std::vector<Vec3i> world;
  for (int k = 0; k < 200; ++k) {
    const auto any = [&] { return static_cast<int>(random.next() % side); };
    world.push_back(Vec3i{any(), any(), any()});
  }
  const Vec3i box{side * finer, side * finer, side * finer};
  BrickMask mask(box);
  for (const Vec3i w : world) mask.set(permuted(w, shift) * finer);
  GridSamples samples;
  samples.axis_shift = shift;
  samples.bricks = BrickGrid(mask, one_thread);
  for (size_t b = 0; b <= samples.bricks.size(); ++b) samples.begin.push_back(static_cast<uint32_t>(b));
  samples.local.assign(samples.bricks.size(), {4, 4, 4});
  samples.direction.assign(samples.bricks.size(), {0, 0, 1});
  samples.sample_hash.assign(samples.bricks.size(), 1);
  Start start;
  start.band = NarrowBand(BrickGrid(mask, one_thread), std::vector<uint8_t>(samples.bricks.size() * brick_area, 255),
                          one_thread);
  start.phi0 = start.band.make_array();
  const HeldOut held_out(start, samples, {}, {.samples = 60, .patch_bricks = 3 * finer}, one_thread);
  std::set<std::tuple<int, int, int>> found;
  for (size_t b = 0; b < held_out.band().grid().size(); ++b) {
    const Vec3i at = permuted(held_out.band().grid().coord(b), 3 - shift);
    found.insert({at.x / finer, at.y / finer, at.z / finer});
  }
  return found;
}

TEST(HeldOut, UsesTheSamePatchesWhateverTheOrderOfTheAxesAndTheSizeOfTheVoxels) {
  const auto expected = chosen_bricks(0, 1);
  EXPECT_GE(expected.size(), 60u);
  EXPECT_LT(expected.size(), 150u);
  EXPECT_EQ(chosen_bricks(1, 1), expected);
  EXPECT_EQ(chosen_bricks(2, 1), expected);
  EXPECT_EQ(chosen_bricks(0, 2), expected);
  EXPECT_EQ(chosen_bricks(1, 2), expected);
}

}  // namespace TEST_FILE
}  // namespace soapfilm
