// Without lambda every built-in shape keeps its components and its genus, for any resolution and sampling. The full
// sweep (64 to 512 vertices, 0.3 to 10 samples per voxel^2; half an hour of one core and 2 GB) runs if the environment
// variable SOAPFILM_FULL_TESTS is set.
#include <fmt/core.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

#include "soapfilm/mesh/topology.h"
#include "soapfilm/reconstruct.h"
#include "soapfilm/run/details.h"
#include "support/problem.h"

namespace soapfilm {
namespace TEST_FILE {

using namespace test;

struct Case {
  std::string shape;
  int resolution;
  double density;
};
void PrintTo(const Case& c, std::ostream* out) {
  *out << c.shape << ", " << c.resolution << " vertices, " << c.density << " samples per voxel^2";
}

std::vector<Case> cases() {
  const bool full = std::getenv("SOAPFILM_FULL_TESTS") != nullptr;
  std::vector<Case> all;
  for (const std::string& shape : shape_names())
    for (const int resolution : full ? std::vector{64, 128, 256, 512} : std::vector{64, 128})
      for (const double density : {0.3, 1.0, 10.0}) all.push_back({shape, resolution, density});
  return all;
}

class BuiltInShape : public testing::TestWithParam<Case> {};

TEST_P(BuiltInShape, KeepsItsComponentsAndGenus) {
  const auto& [name, resolution, density] = GetParam();
  const auto shape = make_shape(name);
  ReconstructParams params;
  params.place.resolution = resolution;
  const Reconstruction result = reconstruct(sampled(*shape, resolution, density), params, Context(1));
  for (const LevelReport& level : result.report.details->solve.levels)
    EXPECT_TRUE(level.converged) << "level " << level.level;
  const TopologyReport topology = check_topology(result.mesh);
  EXPECT_TRUE(topology.watertight());
  EXPECT_EQ(topology.components.size(), static_cast<size_t>(shape->facts().components));
  EXPECT_EQ(topology.genus(), shape->facts().genus);
  EXPECT_LT(result.report.certificate.relative_gap_binary(), 0.05);
}

std::string case_name(const testing::TestParamInfo<Case>& info) {
  const auto& [shape, resolution, density] = info.param;
  return fmt::format("{}_{}_{}per10{}", shape, resolution, std::round(10 * density), resolution > 64 ? "_Slow" : "");
}

INSTANTIATE_TEST_SUITE_P(Sweep, BuiltInShape, testing::ValuesIn(cases()), case_name);

}  // namespace TEST_FILE
}  // namespace soapfilm
