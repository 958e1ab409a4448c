#include "soapfilm/components/scanners.h"

#include <gtest/gtest.h>

#include <cmath>

#include "components/drawn_level.h"

namespace soapfilm {
namespace TEST_FILE {

using namespace test;

/// A shell of radius 12 to 18 about the middle of a box of 60; all bricks are in the band, or those at the shell alone.
Labels shell(bool sparse) {
  Lattice lattice;
  lattice.size = {60, 60, 60};
  const auto inside = [](Vec3i v) {
    const double r = norm(Vec3d(v) - Vec3d{30, 30, 30});
    return r > 12 && r < 18;
  };
  return labels_of(drawn_level(lattice.box(0), sparse, inside), 0.5f, Context(1));
}

TEST(Scanners, StandInTheAirInSolidMatterOrEnclosed) {
  const std::vector<Vec3d> positions{{30, 30, 30}, {33, 28.4, 31}, {30, 45, 30}, {5, 5, 5}, {500, -3, 1e300}};
  for (const bool sparse : {false, true}) {
    const Labels labels = shell(sparse);
    const ScannerReport found = place_scanners(labels, false, positions);
    EXPECT_EQ(found.scanners, 5u);
    EXPECT_EQ(found.in_solid, 1u);
    EXPECT_EQ(found.enclosed, 2u);
    // The same labels as a complement: the shell is all the air there is.
    const ScannerReport other = place_scanners(labels, true, positions);
    EXPECT_EQ(other.in_solid, 4u);
    EXPECT_EQ(other.enclosed, 1u);
  }
}

TEST(Scanners, ArePositionsOfSamplesOrScansOrTheOneGiven) {
  PointCloud cloud;
  cloud.positions.assign(100, {});
  EXPECT_TRUE(scanner_positions(cloud, {}).empty());
  EXPECT_EQ(scanner_positions(cloud, Vec3d{1, 2, 3}).size(), 1u);
  cloud.scans = {{"a", 0, 50, {}, {}, {}}, {"b", 50, 100, {}, {}, {}}};
  cloud.scans[1].sensor = Vec3d{4, 5, 6};
  EXPECT_EQ(scanner_positions(cloud, {}), (std::vector<Vec3d>{{4, 5, 6}}));
  EXPECT_EQ(scanner_positions(cloud, Vec3d{1, 2, 3}), (std::vector<Vec3d>{{1, 2, 3}, {4, 5, 6}}));
  for (int i = 0; i < 100; ++i) cloud.sensors.push_back({i / 60 * 1.0, 0, i == 0 ? NAN : 0.0});
  EXPECT_EQ(scanner_positions(cloud, {}), (std::vector<Vec3d>{{0, 0, 0}, {1, 0, 0}}));
}

}  // namespace TEST_FILE
}  // namespace soapfilm
