#include "soapfilm/device/device.h"

#include <gtest/gtest.h>

#include <vector>

#include "refine/band_support.h"
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

TEST(ReferenceDevice, GivesTheCpusDataTerms) { expect_same_data_terms(std::make_shared<ReferenceDevice>()); }

TEST(ReferenceDevice, GivesTheCpusProlongations) { expect_same_prolongations(std::make_shared<ReferenceDevice>()); }

TEST(ReferenceDevice, GivesTheCpusMesh) {
  expect_same_mesh(std::make_shared<ReferenceDevice>(), "part", sanitized ? 24 : 32);
}

/// The fit alone, in many layers of bricks, with and without directions.
TEST(ReferenceDevice, GivesTheCpusDisplacement) {
  constexpr Vec3i bricks{2, 2, 7};
  const NarrowBand band = random_band(bricks, 0.9, 1);
  const RowArray phi0 = random_array(band, 2);
  const GridSamples samples = random_samples(bricks, 6000, 3);
  const Context cpu(1), other = on_device(cpu, std::make_shared<ReferenceDevice>());
  const std::vector<float> expected = fitted_twice(band, phi0, samples, 3, cpu),
                           found = fitted_twice(band, phi0, samples, 3, other);
  expect_same_floats(expected.data(), found.data(), expected.size());
}

/// Counts the levels that it is given, and leaves the work to the CPU.
class CountingDevice final : public Device {
 public:
  using Device::on;
  std::shared_ptr<LevelSolver> on(Level& level, const Context& context) const override {
    ++levels;
    return std::make_shared<Sweeper>(level, context);
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
