// What a run on disk is expected to read and write.
#include "soapfilm/run/scratch_plan.h"

#include <gtest/gtest.h>

#include <cstdint>

#include "soapfilm/context.h"
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

}  // namespace TEST_FILE
}  // namespace soapfilm
