#include "soapfilm/remesh/landmarks.h"

#include <gtest/gtest.h>

namespace soapfilm {
namespace TEST_FILE {

using Corners = Landmarks::Corners;

/// A triangle at that height, over the origin and the points near it.
std::vector<Corners> sheet(double height) {
  return {{Vec3d{-4, -4, height}, Vec3d{8, -4, height}, Vec3d{-4, 8, height}}};
}

TEST(Landmarks, TheSurfaceStaysNearThem) {
  const Landmarks marks({{0, 0, 0}, {1, 0, 0}}, 0.1, 0.5);
  EXPECT_TRUE(marks.stay_near(0, sheet(0), sheet(0.5)));
  EXPECT_FALSE(marks.stay_near(0, sheet(0), sheet(0.51)));
}

TEST(Landmarks, WhatIsFarMayComeNearer) {
  const Landmarks marks({{0, 0, 0}}, 0.1, 0.5);
  EXPECT_TRUE(marks.stay_near(0, sheet(3), sheet(2)));
  EXPECT_FALSE(marks.stay_near(0, sheet(2), sheet(3)));
}

TEST(Landmarks, AVertexLooksAfterWhatItWasHanded) {
  Landmarks marks({{0, 0, 0}, {0, 0, 1}, {0, 0, 2}}, 0.1, 0.5);
  marks.hand_over(2, 1);
  EXPECT_TRUE(marks.stay_near(2, sheet(2), sheet(9)));
  EXPECT_FALSE(marks.stay_near(1, sheet(1.5), sheet(1.2)));
  marks.hand_over(1, 7);  // a vertex that a split made
  EXPECT_TRUE(marks.stay_near(1, sheet(1), sheet(9)));
  EXPECT_FALSE(marks.stay_near(7, sheet(1.5), sheet(1.2)));
  EXPECT_FALSE(marks.stay_near(7, sheet(1.5), sheet(1.8)));
  marks.hand_over(0, 7);
  EXPECT_FALSE(marks.stay_near(7, sheet(0), sheet(0.6)));
}

TEST(Landmarks, OneInEachCell) {
  const Landmarks marks({{0.1, 0.1, 0.1}, {0.2, 0.1, 0.1}}, 1, 0.5);
  EXPECT_FALSE(marks.stay_near(0, sheet(0), sheet(9)));
  EXPECT_TRUE(marks.stay_near(1, sheet(0), sheet(9)));
}

}  // namespace TEST_FILE
}  // namespace soapfilm
