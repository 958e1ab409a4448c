// What a run on disk is expected to read and write.
#include "soapfilm/run/scratch_plan.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <string>

#include "soapfilm/context.h"
#include "soapfilm/core/context_state.h"
#include "soapfilm/error.h"
#include "soapfilm/run/memory_plan.h"

namespace soapfilm {
namespace TEST_FILE {

constexpr uint64_t mib = uint64_t{1} << 20;

MemoryPlan large_plan() {
  MemoryPlan plan;
  plan.placing_bytes = 300 * mib;
  plan.fixed_bytes = 100 * mib;
  plan.solve = {600 * mib, 1};
  plan.refine = {900 * mib, 1};
  return plan;
}

class ScratchTrafficOf : public testing::Test {
 protected:
  ScratchTrafficOf() { context.set_scratch_folder("/tmp"); }
  ScratchTraffic traffic(uint64_t room) const {
    return ScratchBudget(params, context).traffic(large_plan(), Room(room, 0));
  }
  Context context{1};
  ReconstructParams params;
};

TEST_F(ScratchTrafficOf, IsNoneWhereAllStaysInMemory) {
  const ScratchTraffic all = traffic(1000 * mib);
  EXPECT_EQ(all.read, 0u);
  EXPECT_EQ(all.written, 0u);
}

TEST_F(ScratchTrafficOf, GrowsWithWhatMemoryHasNoRoomFor) {
  uint64_t before = 0;
  for (const uint64_t room : {900, 700, 500, 300}) {
    const ScratchTraffic now = traffic(room * mib);
    EXPECT_GT(now.read, before);
    EXPECT_LT(now.written, now.read);
    before = now.read;
  }
  // The refinement reads all of its arrays in each of some dozens of passes, the solve in a few.
  EXPECT_GT(before, 10 * 900 * mib);
  EXPECT_LT(before, 100 * 900 * mib);
}

TEST_F(ScratchTrafficOf, ACheckedMeshStaysInSmallParts) {
  context.state().move_vectors = [](const std::string&) {};
  params.checked = true;
  MemoryPlan plan = large_plan();
  plan.mesh = {4000 * mib, 1};
  EXPECT_LT(ScratchBudget(params, context).resident_part(plan).mesh.bytes, 400 * mib);
  plan.mesh = {10 * mib, 1};
  EXPECT_EQ(ScratchBudget(params, context).resident_part(plan).mesh.bytes, 10 * mib);
}

/// Whether a run that is on disk goes on, whose mesh needs a certain part of what it has.
bool goes_on(double part) {
  constexpr uint64_t sample = 45, room = 100 * mib;
  Context context(1);
  context.set_scratch_folder("/tmp");
  context.state().move_vectors = [](const std::string&) {};
  context.limit_memory(room);
  const ReconstructParams params;
  MemoryBudget budget(params, PointCloud{}, AfterPlacing::freed, context);
  constexpr double share = 0.05;  // of what stays in memory
  try {
    budget.plan_mesh({}, static_cast<uint64_t>(part / share * static_cast<double>(room) / sample), context);
  } catch (const MemoryError&) {
    return false;
  }
  EXPECT_GT(budget.planned_disk_bytes(), 5 * room);
  return true;
}

TEST(LateInARunOnDisk, AGuessALittleAboveTheMemoryDoesNotEndIt) {
  EXPECT_TRUE(goes_on(0.7));
  EXPECT_TRUE(goes_on(1.05));
  EXPECT_FALSE(goes_on(1.5));
}

}  // namespace TEST_FILE
}  // namespace soapfilm
