// What holds of every device of the solve: the CPU's bits.
#pragma once

#include <gtest/gtest.h>

#include <bit>
#include <cstdint>
#include <memory>

#include "soapfilm/core/context_state.h"
#include "soapfilm/solve/device.h"
#include "support/problem.h"
#include "support/random_level.h"

namespace soapfilm::test {

struct Comparison {
  size_t words = 0;
  size_t different = 0;
};

/// u and p of two levels on the same bricks, as bits.
inline Comparison compare_state(const Level& a, const Level& b) {
  Comparison comparison;
  const auto add = [&](const float* of_a, const float* of_b, int count) {
    for (int i = 0; i < count; ++i) {
      ++comparison.words;
      comparison.different += std::bit_cast<uint32_t>(of_a[i]) != std::bit_cast<uint32_t>(of_b[i]);
    }
  };
  for (size_t brick = 0; brick < a.grid.size(); ++brick) {
    add(a.u.brick(brick), b.u.brick(brick), brick_volume);
    add(a.p.brick(brick), b.p.brick(brick), 3 * brick_volume);
  }
  return comparison;
}

/// `sweeps` iterations of a random level with given steps, then as many with others.
inline void expect_same_sweeps(const std::shared_ptr<const Device>& device, uint64_t seed,
                               const RandomLevelParams& params, int sweeps) {
  const Context cpu(1), other = on_device(cpu, device);
  RandomLevel expected(seed, params), found(seed, params);
  const RandomLevel before(seed, params);
  const auto run = [&](Level& level, const Context& context) {
    const std::unique_ptr<LevelSolver> solver = level_solver(level, context);
    for (const float sigma : {0.14f, 0.07f}) solver->sweep({.sigma = sigma, .tau = 1 / (12 * sigma)}, sweeps);
    solver->download();
  };
  run(expected.level, cpu);
  run(found.level, other);
  EXPECT_GT(compare_state(before.level, expected.level).different, 0u);
  const Comparison comparison = compare_state(expected.level, found.level);
  EXPECT_EQ(comparison.different, 0u) << "of " << comparison.words;
}

inline void expect_same_sweeps_on_random_levels(const std::shared_ptr<const Device>& device, int sweeps,
                                                int more_layers) {
  uint64_t seed = 70;
  for (const Norm norm : {Norm::isotropic, Norm::anisotropic})
    for (const bool open : {false, true})
      for (const RimFlux rim : {RimFlux::zero, RimFlux::random}) {
        SCOPED_TRACE(testing::Message() << "norm " << static_cast<int>(norm) << ", open " << open << ", rim "
                                        << static_cast<int>(rim));
        const double held = rim == RimFlux::zero ? 0 : 0.2;
        expect_same_sweeps(device, ++seed,
                           {.rim = rim, .norm = norm, .held = held, .open = open, .more_layers = more_layers}, sweeps);
      }
}

/// All levels of a small shape: the same levels, iterations, energies and bits.
inline void expect_same_solution(const std::shared_ptr<const Device>& device, const std::string& shape,
                                 int resolution) {
  const Problem problem = make_problem(sampled(shape, resolution, 2), resolution);
  const Context cpu(1), other = on_device(cpu, device);
  PrimalDualParams params;
  params.tolerance = 1e-3;
  const auto solve_on = [&](const Context& context) {
    return solve_coarse_to_fine(problem.lattice, problem.support, 0.02, params, context);
  };
  const PyramidSolution expected = solve_on(cpu), found = solve_on(other);
  ASSERT_EQ(expected.reports.size(), found.reports.size());
  for (size_t i = 0; i < expected.reports.size(); ++i) {
    EXPECT_EQ(expected.reports[i].iterations, found.reports[i].iterations) << i;
    EXPECT_EQ(expected.reports[i].energies.dual, found.reports[i].energies.dual) << i;
  }
  EXPECT_GT(expected.reports.back().iterations, 0);
  ASSERT_EQ(expected.finest.grid.size(), found.finest.grid.size());
  const Comparison comparison = compare_state(expected.finest, found.finest);
  EXPECT_EQ(comparison.different, 0u) << "of " << comparison.words;
}

}  // namespace soapfilm::test
