// Ranks that each sweep a slab of a level give the bits of one process.
#include "soapfilm/grid/slabs.h"

#include <gtest/gtest.h>

#include <array>

#include "soapfilm/solve/energy.h"
#include "soapfilm/solve/level_slabs.h"
#include "soapfilm/solve/sweep.h"
#include "support/hash.h"
#include "support/random_level.h"
#include "support/thread_ranks.h"

namespace soapfilm {
namespace TEST_FILE {

using namespace test;

constexpr StepSizes steps{.sigma = 0.14f, .tau = static_cast<float>(1 / (12 * 0.14))};

/// What a run of sweeps leaves.
struct Outcome {
  uint64_t state = 0;
  std::array<double, 5> energies{};
  bool operator==(const Outcome&) const = default;
};

/// Makes what a rank does not have useless.
void spoil_others(Level& level) {
  if (!level.slabs) return;
  const ItemRange kept = bricks_at_hand(level);
  for (size_t b = 0; b < level.grid.size(); ++b)
    if (b < kept.begin || b >= kept.end) {
      std::fill_n(level.u.brick(b), brick_volume, 0.5f);
      std::fill_n(level.p.brick(b), 3 * brick_volume, 0.7f);
    }
}

Outcome swept(uint64_t seed, const RandomLevelParams& params, int sweeps_per_exchange, const Context& context) {
  RandomLevel random(seed, params);
  Level& level = random.level;
  level.slabs = Slabs::of(level.grid, context);
  spoil_others(level);
  Outcome outcome;
  Sweeper sweeper(level, context);
  sweeper.sweeps_per_exchange = sweeps_per_exchange;
  for (const int times : {8, 3, 16, 8, 1, 5}) {
    for (int k = 0; k < times && sweeps_per_exchange != brick_side; ++k) sweeper.sweep(steps, 1);
    if (sweeps_per_exchange == brick_side) sweeper.sweep(steps, times);
    if (times == 3) outcome.energies[0] = sweeper.estimated_gap();
  }
  const Energies relaxed = sweeper.energies();
  outcome.energies[1] = relaxed.gap;
  outcome.energies[2] = relaxed.primal;
  const Energies binary = evaluate_energy(level, {.threshold = 0.5f, .certify = true}, context);
  outcome.energies[3] = binary.dual;
  const Field<float> gap = local_gap(level, {}, 1, context);
  outcome.energies[4] = static_cast<double>(hash_bytes(std::span<const float>(gap.brick(0), brick_volume), 0));
  complete(level);
  outcome.state = hash_state(level);
  return outcome;
}

std::vector<RandomLevelParams> problems() {
  return {{.norm = Norm::isotropic, .held = 0.1},
          {.norm = Norm::anisotropic},
          {.rim = RimFlux::zero, .open = true},
          {.band = 0.9, .more_layers = 10}};
}

TEST(Slabs, RanksGiveTheBitsOfOneProcess) {
  uint64_t seed = 40;
  for (const RandomLevelParams& params : problems()) {
    ++seed;
    const Outcome alone = swept(seed, params, brick_side, Context(1));
    for (const int count : {1, 2, 3, 4, 7})
      for (const int threads : {1, 2})
        for (const Outcome& of_rank : on_ranks<Outcome>(
                 count, threads, {}, [&](const Context& c) { return swept(seed, params, brick_side, c); }))
          EXPECT_EQ(of_rank, alone) << count << " ranks, " << threads << " threads, seed " << seed;
  }
}

TEST(Slabs, AnyCutGivesTheSameBits) {
  const RandomLevelParams params{.held = 0.1};
  const Outcome alone = swept(50, params, brick_side, Context(1));
  for (uint64_t cut = 1; cut <= 12; ++cut)
    for (const Outcome& of_rank : on_ranks<Outcome>(2 + static_cast<int>(cut % 6), 1, {cut},
                                                    [&](const Context& c) { return swept(50, params, brick_side, c); }))
      EXPECT_EQ(of_rank, alone) << "cut " << cut;
}

/// Nothing is to spare: with one sweep more between exchanges values are wrong.
TEST(Slabs, NineSweepsPerExchangeAreTooMany) {
  const RandomLevelParams params;
  const Outcome alone = swept(60, params, brick_side, Context(1));
  const auto with = [&](int sweeps) {
    return on_ranks<Outcome>(2, 1, {}, [&](const Context& c) { return swept(60, params, sweeps, c); })[0].state;
  };
  EXPECT_EQ(with(brick_side - 1), alone.state);
  EXPECT_NE(with(brick_side + 1), alone.state);
}

}  // namespace TEST_FILE
}  // namespace soapfilm
