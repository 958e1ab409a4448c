// Numbers from the paper on real data; the folder is given by the environment variable SOAPFILM_DATA.
#include <gtest/gtest.h>

#include <map>

#include "soapfilm/io.h"
#include "soapfilm/reconstruct.h"
#include "support/real_data.h"

namespace soapfilm {
namespace TEST_FILE {

/// Table 1: vertices inside for five thresholds.
TEST(Paper, BunnyHasTheCountsOfTable1) {
  const auto scans = real_data("bunny/bun.conf");
  if (!scans) GTEST_SKIP() << "no bunny in SOAPFILM_DATA";
  const PointCloud cloud = read_points(*scans);
  const std::map<double, double> table = {
      {0.1, 1126101}, {0.25, 1124452}, {0.5, 1121936}, {0.75, 1119334}, {0.9, 1117737}};
  for (const auto& [mu, inside] : table) {
    ReconstructParams params;
    params.orient.source = DirectionSource::scan;  // as rough as the paper's; by default they come from planes
    params.place.resolution = 212;
    params.energy.lambda = 0.01;
    params.surface.threshold = mu;
    const Reconstruction result = reconstruct(cloud, params, Context());
    EXPECT_EQ((Lattice{result.report.grid, {}}.to_world_axes(result.report.grid.size)), (Vec3i{212, 200, 159}));
    EXPECT_NEAR(static_cast<double>(result.report.certificate.inside), inside, 0.002 * inside) << "mu = " << mu;
  }
}

}  // namespace TEST_FILE
}  // namespace soapfilm
