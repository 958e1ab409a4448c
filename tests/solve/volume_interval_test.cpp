// The interval of volumes holds every segmentation that it speaks of, and is not much wider.
#include "soapfilm/solve/volume_interval.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "soapfilm/solve/energy.h"
#include "solve/cut_problems.h"
#include "support/problem.h"

namespace soapfilm {
namespace TEST_FILE {

using namespace test;

const Context one_thread(1);

PrimalDualParams default_params() { return {}; }

double relaxed_energy(const Level& level) { return evaluate_energy(level, {}, one_thread).primal; }

VolumeInterval interval_of(Level level, double epsilon, int threads = 1) {
  const double energy = relaxed_energy(level);
  return find_volume_interval(level, {0.5f, energy, epsilon}, default_params(), Context(threads));
}

Level solved(const Problem& problem, double lambda, Norm norm = Norm::isotropic) {
  return solve(problem, lambda, 1e-6, 1, norm).finest;
}

struct Labeling {
  double energy;
  size_t inside;
};

/// The energy of every labeling of the free vertices.
std::vector<Labeling> all_labelings(Level& level) {
  struct Place {
    size_t brick;
    int offset;
  };
  std::vector<Place> free;
  for (size_t b = 0; b < level.grid.size(); ++b)
    for_each_vertex(level.grid.coord(b), [&](Vec3i v, int i) {
      if (level.box.is_free(v)) free.push_back({b, i});
    });
  std::vector<Labeling> all;
  for (uint32_t bits = 0; bits < 1u << free.size(); ++bits) {
    for (size_t k = 0; k < free.size(); ++k) level.u.brick(free[k].brick)[free[k].offset] = bits >> k & 1 ? 1.0f : 0.0f;
    all.push_back({evaluate_energy(level, {}, one_thread).primal, static_cast<size_t>(std::popcount(bits))});
  }
  return all;
}

/// No segmentation lies outside. (Few vertices cannot say how tight the bounds are: labels are far from the relaxed u.)
TEST(VolumeInterval, HoldsEverySegmentationOfTinyProblems) {
  size_t inside_some = 0;
  for (const uint64_t seed : {1, 3, 4})
    for (const Norm norm : {Norm::isotropic, Norm::anisotropic}) {
      const Problem problem = tiny_problem({3, 2, 2}, seed);
      Level level = solved(problem, 0.2, norm);
      const double optimum = relaxed_energy(level);
      // (An empty solution has no interface, so nothing is near it.)
      ASSERT_GT(count_inside(dense_labels(level)), 0u);
      const double scale = std::max(std::abs(optimum), 1000 * 0.2);
      std::vector<VolumeInterval> found;
      const std::vector<double> epsilons{1e-4, 1e-3, 4e-3};
      for (const double epsilon : epsilons) found.push_back(interval_of(solved(problem, 0.2, norm), epsilon));
      const std::vector<Labeling> all = all_labelings(level);
      for (size_t k = 0; k < epsilons.size(); ++k) {
        double least = 1e9, most = -1;
        for (const Labeling& l : all)
          if (l.energy <= optimum + epsilons[k] * scale) {
            least = std::min(least, static_cast<double>(l.inside));
            most = std::max(most, static_cast<double>(l.inside));
          }
        ASSERT_LE(found[k].least, least + 1e-9) << "seed " << seed << ", eps " << epsilons[k];
        ASSERT_GE(found[k].most, most - 1e-9) << "seed " << seed << ", eps " << epsilons[k];
        inside_some += least <= most;
      }
    }
  EXPECT_GT(inside_some, 12u) << "too few cases have any such segmentation";
}

Problem noisy_sphere() {
  PointCloud cloud = sampled("sphere", 40, 2);
  add_noise(cloud, 0.3 / 40, 3);
  return make_problem(cloud, 40);
}

/// Whatever another price of volume favors is a segmentation, too: it lies in the interval of its own energy.
TEST(VolumeInterval, HoldsGrownAndShrunkSpheres) {
  const Problem problem = noisy_sphere();
  Level level = solved(problem, 0.02);
  const double optimum = relaxed_energy(level);
  for (const double price : {0.004, -0.004}) {
    Problem other = noisy_sphere();
    for (size_t b = 0; b < other.support.grid.size(); ++b)
      for (int i = 0; i < brick_volume; ++i) other.support.f.brick(b)[i] += static_cast<float>(price);
    const Dense<uint8_t> labels = dense_labels(solved(other, 0.02));
    Level tried = solved(problem, 0.02);
    size_t inside = 0;
    for (size_t b = 0; b < tried.grid.size(); ++b)
      for_each_vertex(tried.grid.coord(b), [&](Vec3i v, int i) { tried.u.brick(b)[i] = labels[v]; });
    labels.for_each([&](Vec3i v) { inside += labels[v]; });
    const double above = relaxed_energy(tried) - optimum, epsilon = above / std::abs(optimum);
    ASSERT_GT(epsilon, 1e-5);
    const VolumeInterval found = interval_of(solved(problem, 0.02), epsilon);
    EXPECT_LE(found.least, static_cast<double>(inside));
    EXPECT_GE(found.most, static_cast<double>(inside));
    // It is not much wider than it must be.
    const double beyond =
        price > 0 ? found.most - static_cast<double>(inside) : static_cast<double>(inside) - found.least;
    EXPECT_LT(beyond, 0.03 * found.segmented) << price;
  }
}

TEST(VolumeInterval, GrowsWithEpsilonAndLeavesTheLabels) {
  const Problem problem = noisy_sphere();
  Level level = solved(problem, 0.02);
  const Dense<uint8_t> before = dense_labels(level);
  const double energy = relaxed_energy(level);
  const VolumeInterval found = find_volume_interval(level, {0.5f, energy, 1e-3}, default_params(), one_thread);
  EXPECT_EQ(dense_labels(level).values(), before.values());
  EXPECT_EQ(found.segmented, static_cast<double>(count_inside(before)));
  EXPECT_LT(found.least, found.segmented);
  EXPECT_GT(found.most, found.segmented);
  EXPECT_LT(found.most - found.least, 0.1 * found.segmented);
  const VolumeInterval wider = interval_of(solved(problem, 0.02), 1e-2);
  EXPECT_LT(wider.least, found.least);
  EXPECT_GT(wider.most, found.most);
}

TEST(VolumeInterval, TheSameForAnyNumberOfThreads) {
  const Problem problem = noisy_sphere();
  const VolumeInterval one = interval_of(solved(problem, 0.02), 1e-3),
                       many = interval_of(solved(problem, 0.02), 1e-3, 4);
  EXPECT_EQ(one.least, many.least);
  EXPECT_EQ(one.most, many.most);
}

}  // namespace TEST_FILE
}  // namespace soapfilm
