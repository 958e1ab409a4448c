// Scans that overlap: in one frame, or each in its own.
#include "soapfilm/orient/scan_fit.h"

#include <gtest/gtest.h>

#include <cmath>

#include "soapfilm/core/random.h"
#include "soapfilm/core/vec.h"

namespace soapfilm {
namespace TEST_FILE {

struct Set {
  PointCloud cloud;
  std::vector<Vec3f> directions;
};

/// Scans of an ellipsoid from different sides; each moved by `away` times its own shift.
Set scans_of(int count, double away, size_t samples = 4000) {
  Random random(11);
  Set set;
  for (int s = 0; s < count; ++s) {
    const Vec3d to_scanner{std::cos(0.7 * s), std::sin(0.7 * s), 0.3};
    const Vec3d shift = away * Vec3d{std::cos(2.1 * s), std::sin(1.3 * s), std::cos(3.3 * s)};
    Scan scan;
    scan.begin = set.cloud.size();
    while (set.cloud.size() < scan.begin + samples) {
      const Vec3d u = normalized(Vec3d{random.normal(), random.normal(), random.normal()});
      const Vec3d normal = normalized(Vec3d{u.x / 5, u.y / 4, u.z / 3});
      if (dot(normal, to_scanner) < 0.2) continue;
      set.cloud.positions.push_back(Vec3d{5 * u.x, 4 * u.y, 3 * u.z} + 0.005 * random.normal() * normal + shift);
      set.directions.push_back(static_cast<Vec3f>(normal));
    }
    scan.end = set.cloud.size();
    set.cloud.scans.push_back(scan);
  }
  return set;
}

TEST(ScanFit, ScansOfOneFrameAgree) {
  for (const int count : {2, 5, 20}) {
    const Set set = scans_of(count, 0);
    const ScanFit fit = compare_scans(set.cloud, set.directions, Context(2));
    EXPECT_GT(fit.overlap, 300u);
    EXPECT_LT(fit.share(), 0.02);
    EXPECT_FALSE(misfit_of_scans(set.cloud, set.directions, Context(2)));
  }
}

TEST(ScanFit, ScansOfDifferentFramesContradict) {
  for (const int count : {2, 5}) {
    const Set set = scans_of(count, 0.5);
    const auto warning = misfit_of_scans(set.cloud, set.directions, Context(2));
    ASSERT_TRUE(warning) << compare_scans(set.cloud, set.directions, Context(2)).share();
    EXPECT_NE(warning->find("one frame"), std::string::npos);
    EXPECT_EQ(misfit_of_scans(set.cloud, set.directions, Context(1)), warning);
  }
  EXPECT_FALSE(misfit_of_scans(scans_of(1, 1).cloud, scans_of(1, 1).directions, Context(1)));
  const Set few = scans_of(3, 0.5, 20);
  EXPECT_FALSE(misfit_of_scans(few.cloud, few.directions, Context(1)));
}

TEST(ScanFit, TheTwoSidesOfASheetAreNoOverlap) {
  Random random(3);
  Set set;
  for (const double side : {1.0, -1.0}) {
    Scan scan;
    scan.begin = set.cloud.size();
    for (int i = 0; i < 3000; ++i) {
      set.cloud.positions.push_back({random.uniform(), random.uniform(), 0.02 * side});
      set.directions.push_back({0, 0, static_cast<float>(side)});
    }
    scan.end = set.cloud.size();
    set.cloud.scans.push_back(scan);
  }
  EXPECT_EQ(compare_scans(set.cloud, set.directions, Context(1)).overlap, 0u);
}

}  // namespace TEST_FILE
}  // namespace soapfilm
