#include "soapfilm/grid/layout.h"

#include <gtest/gtest.h>

namespace soapfilm {
namespace TEST_FILE {

TEST(Layout, BrickOfRoundsDown) {
  EXPECT_EQ(brick_of({0, 7, 8}), (Vec3i{0, 0, 1}));
  EXPECT_EQ(brick_of({-1, -8, -9}), (Vec3i{-1, -1, -2}));
}

TEST(Layout, SlotsNameThe27NeighborsOnce) {
  for (int slot = 0; slot < 27; ++slot) {
    const Vec3i d = slot_offset(slot);
    EXPECT_EQ(neighbor_slot(d.x, d.y, d.z), slot);
  }
  EXPECT_EQ(slot_offset(own_slot), (Vec3i{0, 0, 0}));
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_EQ(slot_offset(slot_down[axis])[axis], -1);
    EXPECT_EQ(slot_offset(slot_up[axis])[axis], 1);
  }
}

}  // namespace TEST_FILE
}  // namespace soapfilm
