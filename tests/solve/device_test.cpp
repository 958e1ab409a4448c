#include "soapfilm/solve/device.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "soapfilm/solve/energy.h"
#include "soapfilm/solve/primal_dual.h"
#include "soapfilm/solve/sweep.h"
#include "support/device_laws.h"
#include "support/reference_device.h"
#include "support/sanitized.h"

namespace soapfilm {
namespace TEST_FILE {

using namespace test;

TEST(ReferenceDevice, GivesTheCpusBitsOnRandomLevels) {
  expect_same_sweeps_on_random_levels(std::make_shared<ReferenceDevice>(), 5, 4);
}

TEST(ReferenceDevice, GivesTheCpusBitsInAWholeSolve) {
  expect_same_solution(std::make_shared<ReferenceDevice>(), "knot", sanitized ? 24 : 32);
}

/// What a brick that is held has it keeps, and what the others reach is proved with it.
TEST(HeldBricks, KeepTheirValuesInsideTheCertificate) {
  for (const bool open : {false, true}) {
    const RandomLevelParams params{.held = 0.3, .open = open, .more_layers = 0};
    const RandomLevel before(9, params);
    RandomLevel after(9, params);
    const Context context(2);
    PrimalDualParams solver;
    solver.max_iterations = 200;
    const PrimalDualReport report = solve_primal_dual(after.level, solver, context);
    size_t held = 0, moved = 0;
    for (size_t b = 0; b < after.level.grid.size(); ++b) {
      const bool same =
          std::equal(after.level.u.brick(b), after.level.u.brick(b) + brick_volume, before.level.u.brick(b)) &&
          std::equal(after.level.p.brick(b), after.level.p.brick(b) + 3 * brick_volume, before.level.p.brick(b));
      held += after.level.held[b];
      moved += !same;
      EXPECT_TRUE(same || !after.level.held[b]);
    }
    EXPECT_GT(held, 20u);
    EXPECT_EQ(moved + held, after.level.grid.size());
    // The rest is at its optimum under what is held: no more iterations gain anything.
    const Energies start = evaluate_energy(before.level, {}, context);
    EXPECT_LT(report.energies.primal, start.primal);
    EXPECT_GT(report.energies.dual, start.dual);
    EXPECT_GE(report.energies.gap, 0);
    const Energies end = evaluate_energy(after.level, {}, context);
    solver.max_iterations = 400;
    const Energies later = solve_primal_dual(after.level, solver, context).energies;
    EXPECT_LT(std::abs(later.primal - end.primal), 0.05 * (start.primal - end.primal));
  }
}

/// Counts the levels that it is given, and leaves the work to the CPU.
class CountingDevice final : public Device {
 public:
  std::unique_ptr<LevelSolver> on(Level& level, const Context& context) const override {
    ++levels;
    return std::make_unique<Sweeper>(level, context);
  }
  mutable int levels = 0;
};

TEST(Device, IsThatOfTheContextInItsPartsToo) {
  RandomLevel random(5, {.more_layers = 0});
  const auto device = std::make_shared<CountingDevice>();
  const Context cpu(1), context = on_device(cpu, device);
  PrimalDualParams params;
  params.max_iterations = 1;
  const auto solve_on = [&](const Context& c) { solve_primal_dual(random.level, params, c); };
  solve_on(cpu);
  EXPECT_EQ(device->levels, 0);
  solve_on(context);
  EXPECT_EQ(device->levels, 1);
  solve_on(silenced(context));
  EXPECT_EQ(device->levels, 2);
  solve_on(part_of(context, 0, 0.5));
  EXPECT_EQ(device->levels, 3);
  solve_on(on_device(context, nullptr));
  EXPECT_EQ(device->levels, 3);
}

}  // namespace TEST_FILE
}  // namespace soapfilm
