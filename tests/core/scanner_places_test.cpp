#include "soapfilm/core/scanner_places.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/shuffled.h"

namespace soapfilm {
namespace TEST_FILE {

using namespace test;

TEST(ScannerPlaces, OfASampleComeFromItselfItsScanOrTheCaller) {
  PointCloud cloud;
  cloud.positions.assign(7, {});
  const Vec3d given{9, 9, 9};
  EXPECT_FALSE(scanner_of(cloud, 3, {}));
  EXPECT_EQ(scanner_of(cloud, 3, given), given);
  cloud.scans = {{"a", 0, 3, {}, {}, {}}, {"b", 3, 6, {}, {}, {}}};  // the last sample is of no scan
  cloud.scans[1].sensor = Vec3d{4, 5, 6};
  for (size_t i = 0; i < 7; ++i)
    EXPECT_EQ(scanner_of(cloud, i, given), i >= 3 && i < 6 ? (Vec3d{4, 5, 6}) : given) << i;
  cloud.sensors.assign(7, {1, 2, 3});
  cloud.sensors[1] = cloud.sensors[5] = {NAN, 0, 0};
  EXPECT_EQ(scanner_of(cloud, 0, given), (Vec3d{1, 2, 3}));
  EXPECT_EQ(scanner_of(cloud, 1, given), given);
  EXPECT_EQ(scanner_of(cloud, 5, given), (Vec3d{4, 5, 6}));
  EXPECT_EQ(some_scanners(cloud, given, 10).size(), 3u);
  EXPECT_EQ(some_scanners(cloud, {}, 10).size(), 2u);
}

TEST(ScannerPlaces, AreTheSameHoweverSamplesAreNumbered) {
  PointCloud cloud;
  Random random(1);
  for (int i = 0; i < 5000; ++i) {
    cloud.positions.push_back({random.uniform(), 0, 0});
    cloud.sensors.push_back({std::floor(100 * random.uniform()), i % 3 * 1.0, 7});
  }
  for (const size_t most : {16u, 1000u}) {
    const std::vector<Vec3d> places = some_scanners(cloud, {}, most);
    EXPECT_EQ(places.size(), most == 16 ? 16u : 300u);
    for (uint64_t seed = 1; seed < 4; ++seed) EXPECT_EQ(some_scanners(shuffled(cloud, seed), {}, most), places);
  }
}

}  // namespace TEST_FILE
}  // namespace soapfilm
