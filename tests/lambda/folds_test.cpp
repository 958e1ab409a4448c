// Folds: a partition of the samples that depends on nothing but its arguments, and two sides that do not mix.
#include "soapfilm/lambda/folds.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "soapfilm/error.h"
#include "support/dense.h"
#include "support/problem.h"

namespace soapfilm {
namespace TEST_FILE {

using namespace test;

const Context one_thread(1);

/// The torus cut into `scans` runs of unequal length: run s has s + 1 parts of the samples.
PointCloud in_scans(size_t scans) {
  PointCloud cloud = sampled("torus", 48, 1);
  cloud.scans.clear();
  const size_t parts = scans * (scans + 1) / 2;
  size_t begin = 0;
  for (size_t s = 0; s < scans; ++s) {
    const size_t end = s + 1 == scans ? cloud.size() : begin + cloud.size() * (s + 1) / parts;
    Scan scan;
    scan.begin = begin;
    scan.end = end;
    cloud.scans.push_back(scan);
    begin = end;
  }
  return cloud;
}

Folds folds_of(const PointCloud& cloud, int count, FoldSource source, uint64_t seed = 1) {
  return make_folds(cloud, cloud.normals, count, source, seed);
}

std::string refusal(const std::function<void()>& call) {
  try {
    call();
  } catch (const ParameterError& error) {
    return error.what();
  }
  return "";
}

TEST(Folds, OfSamplesAreEqualButForChance) {
  const PointCloud cloud = sampled("torus", 48, 1);
  const Folds folds = folds_of(cloud, 5, FoldSource::samples);
  const double mean = static_cast<double>(cloud.size()) / 5;
  size_t total = 0;
  for (const size_t size : folds.sizes) {
    EXPECT_NEAR(static_cast<double>(size), mean, 5 * std::sqrt(mean));
    total += size;
  }
  EXPECT_EQ(total, cloud.size());
  EXPECT_FALSE(folds.whole_scans);
}

TEST(Folds, FollowTheSeedAlone) {
  const PointCloud cloud = sampled("torus", 48, 1);
  const Folds folds = folds_of(cloud, 5, FoldSource::samples, 3);
  EXPECT_EQ(folds.of_sample, folds_of(cloud, 5, FoldSource::samples, 3).of_sample);
  EXPECT_NE(folds.of_sample, folds_of(cloud, 5, FoldSource::samples, 4).of_sample);
}

TEST(Folds, OfScansNeverDivideAScan) {
  const PointCloud cloud = in_scans(9);
  const Folds folds = folds_of(cloud, 4, FoldSource::scans);
  EXPECT_TRUE(folds.whole_scans);
  for (const Scan& scan : cloud.scans)
    for (size_t i = scan.begin; i < scan.end; ++i) ASSERT_EQ(folds.of_sample[i], folds.of_sample[scan.begin]);
  // Runs of 9, 8, ... 1 parts: 45 of them fit four folds to within one run of the smaller half.
  const auto [least, most] = std::minmax_element(folds.sizes.begin(), folds.sizes.end());
  EXPECT_LT(static_cast<double>(*most - *least), 4.0 / 45 * static_cast<double>(cloud.size()));
}

TEST(Folds, AutomaticallyAreOfSamples) { EXPECT_FALSE(folds_of(in_scans(9), 4, FoldSource::automatic).whole_scans); }

TEST(Folds, CountOnlySamplesWithDirectionAndWeight) {
  PointCloud cloud = sampled("torus", 48, 1);
  cloud.weights.assign(cloud.size(), 1.0f);
  for (size_t i = 0; i < 100; ++i) cloud.normals[i] = {};
  for (size_t i = 100; i < 150; ++i) cloud.weights[i] = 0;
  size_t total = 0;
  for (const size_t size : folds_of(cloud, 3, FoldSource::samples).sizes) total += size;
  EXPECT_EQ(total, cloud.size() - 150);
}

TEST(Folds, RefuseWhatCannotBeCut) {
  const PointCloud cloud = in_scans(3);
  EXPECT_NE(refusal([&] { folds_of(cloud, 1, FoldSource::samples); }).find("folds = 1, must be between 2 and 100"),
            std::string::npos);
  EXPECT_NE(refusal([&] { folds_of(cloud, 4, FoldSource::scans); }).find("has 3 scans with directions, must be"),
            std::string::npos);
  PointCloud few = sampled("torus", 48, 1);
  std::vector<bool> keep(few.size(), false);
  std::fill(keep.begin(), keep.begin() + 60, true);
  few.filter(keep);
  const std::string message = refusal([&] { folds_of(few, 5, FoldSource::samples); });
  EXPECT_NE(message.find("samples with a direction, must be at least 20"), std::string::npos) << message;
  EXPECT_EQ(message.find('\n'), std::string::npos);
}

TEST(HoldOut, MovingHeldOutSamplesLeavesTheTrainingFieldAsItWas) {
  PointCloud cloud = sampled("torus", 48, 1);
  const Lattice lattice = lattice_of(cloud, 48);
  const Folds folds = folds_of(cloud, 5, FoldSource::samples);
  const FoldFields before = hold_out(cloud, cloud.normals, folds, 2, lattice, one_thread);
  const Vec3d center = cloud.box().center();
  for (size_t i = 0; i < cloud.size(); ++i)
    if (folds.of_sample[i] == 2) cloud.positions[i] = center + (cloud.positions[i] - center) * 0.5;
  const FoldFields after = hold_out(cloud, cloud.normals, folds, 2, lattice, one_thread);

  const LevelBox box = lattice.box(0);
  EXPECT_EQ(dense_field(before.training, box).values(), dense_field(after.training, box).values());
  EXPECT_NE(dense_field(before.held_out, box).values(), dense_field(after.held_out, box).values());
}

TEST(HoldOut, TheTwoSidesAddUpToTheWholeField) {
  const PointCloud cloud = in_scans(9);
  const Problem whole = make_problem(cloud, lattice_of(cloud, 48));
  const Folds folds = folds_of(cloud, 4, FoldSource::scans);
  const LevelBox box = whole.lattice.box(0);
  const Dense<double> f = dense_field(whole.support, box);
  for (int k = 0; k < folds.count; ++k) {
    const FoldFields fold = hold_out(cloud, cloud.normals, folds, k, whole.lattice, one_thread);
    const Dense<double> a = dense_field(fold.training, box), b = dense_field(fold.held_out, box);
    double worst = 0;
    f.for_each([&](Vec3i v) { worst = std::max(worst, std::abs(a[v] + b[v] - f[v])); });
    EXPECT_LT(worst, 1e-6);
    const auto held_out = static_cast<double>(folds.sizes[static_cast<size_t>(k)]);
    EXPECT_NEAR(fold.training_share, 1 - held_out / static_cast<double>(cloud.size()), 1e-12);
  }
  EXPECT_THROW(hold_out(cloud, cloud.normals, folds, 4, whole.lattice, one_thread), ParameterError);
}

}  // namespace TEST_FILE
}  // namespace soapfilm
