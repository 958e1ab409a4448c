// What holds of every device: the CPU's bits.
#pragma once

#include <gtest/gtest.h>

#include <bit>
#include <cstdint>
#include <memory>
#include <utility>

#include "soapfilm/core/context_state.h"
#include "soapfilm/device/device.h"
#include "soapfilm/pyramid/prolong.h"
#include "soapfilm/pyramid/restrict.h"
#include "soapfilm/reconstruct.h"
#include "soapfilm/solve/level_solver.h"
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
    const std::shared_ptr<LevelSolver> solver = level_solver(level, context);
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

inline void expect_same_floats(const float* expected, const float* found, size_t count) {
  ASSERT_GT(count, 0u);
  size_t different = 0;
  for (size_t i = 0; i < count; ++i)
    different += std::bit_cast<uint32_t>(expected[i]) != std::bit_cast<uint32_t>(found[i]);
  EXPECT_EQ(different, 0u) << "of " << count;
}

inline void expect_same_field(const SupportField& expected, const SupportField& found) {
  ASSERT_EQ(expected.grid.size(), found.grid.size());
  expect_same_floats(expected.f.brick(0), found.f.brick(0), expected.grid.vertices());
}

/// The data term of random samples, some of which share their places, and its restrictions.
inline void expect_same_data_terms(const std::shared_ptr<const Device>& device) {
  const Context cpu(1), other = on_device(cpu, device);
  PointCloud cloud = sampled("knot", 40, 1.5);
  for (size_t i = 0; i < 100; ++i) cloud.positions[i + 100] = cloud.positions[i];
  const Problem problem = make_problem(cloud, 40);
  const SupportField found = divergence_field(problem.samples, problem.lattice.box(0), other);
  expect_same_field(problem.support, found);
  const auto expected = coarser_fields(problem.support, problem.lattice, 3, cpu);
  const auto coarser = coarser_fields(problem.support, problem.lattice, 3, other);
  for (size_t l = 0; l < expected.size(); ++l) expect_same_field(expected[l], coarser[l]);
}

/// Random levels prolonged onto some of the children of their bricks, then onto more, where those keep their state.
inline void expect_same_prolongations(const std::shared_ptr<const Device>& device) {
  const Context cpu(1), other = on_device(cpu, device);
  for (const bool open : {false, true}) {
    const RandomLevel random(17, {.open = open, .more_layers = 0});
    const Level& coarse = random.level;
    LevelBox box = coarse.box;
    box.bricks = coarse.box.bricks * 2;
    box.free_lo = coarse.box.free_lo * 2;
    box.free_hi = coarse.box.free_hi * 2;
    SupportField none;
    none.grid = BrickGrid(BrickMask(box.bricks), cpu);
    BrickMask some(box.bricks), more(box.bricks);
    Random dice(3);
    for (size_t b = 0; b < coarse.grid.size(); ++b)
      for (int k = 0; k < 8; ++k) {
        const Vec3i child = child_of(coarse.grid.coord(b), k);
        more.set(child);
        if (dice.uniform() < 0.5) some.set(child);
      }
    const auto on = [&](const Context& context) {
      Level level = prolong_level(coarse, box, some, none, context);
      for (size_t b = 0; b < level.grid.size(); b += 3) level.u.brick(b)[5] = 0.25f;
      return prolong_level(coarse, box, more, none, context, std::move(level));
    };
    const Level expected = on(cpu), found = on(other);
    const Comparison comparison = compare_state(expected, found);
    EXPECT_GT(comparison.words, 100000u);
    EXPECT_EQ(comparison.different, 0u) << "open " << open << ", of " << comparison.words;
    const Level rims = prolong_level(coarse, box, some, none, cpu);
    Level others = prolong_level(coarse, box, some, none, other);
    size_t planes = 0;
    for (size_t b = 0; b < rims.grid.size(); ++b)
      for (int axis = 0; axis < 3; ++axis)
        if (const float* plane = rims.rim.plane(b, axis); plane && ++planes > 0)
          expect_same_floats(plane, others.rim.plane(b, axis), brick_area);
    EXPECT_GT(planes, 100u);
  }
}

/// A whole run: the mesh's bytes. (Refining takes place on it, too.)
inline void expect_same_mesh(const std::shared_ptr<const Device>& device, const std::string& shape, int resolution) {
  PointCloud cloud = sampled(shape, resolution, 2);
  add_noise(cloud, 0.3 * voxel_of_resolution(cloud.box(), resolution, 6), 9);
  ReconstructParams params;
  params.place.resolution = resolution;
  const Context cpu(1), other = on_device(cpu, device);
  const Mesh expected = reconstruct(cloud, params, cpu).mesh, found = reconstruct(cloud, params, other).mesh;
  EXPECT_GT(expected.triangles.size(), 500u);
  EXPECT_EQ(expected.triangles, found.triangles);
  EXPECT_EQ(expected.vertices, found.vertices);
}

}  // namespace soapfilm::test
