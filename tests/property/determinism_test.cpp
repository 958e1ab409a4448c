#include <gtest/gtest.h>

#include "soapfilm/reconstruct.h"
#include "support/back_ends.h"
#include "support/hash.h"
#include "support/problem.h"
#include "support/sanitized.h"

namespace soapfilm {
namespace TEST_FILE {

using namespace test;

/// Enough bricks for several threads to sweep tiles at once.
constexpr int resolution = sanitized ? 36 : 72;

const PointCloud& cloud() {
  static const PointCloud made = [] {
    PointCloud c = sampled("knot", resolution, 1);
    add_noise(c, 0.2 / (resolution - 12), 1);
    return c;
  }();
  return made;
}

Reconstruction reconstructed(const BackEnd& back_end) {
  ReconstructParams params;
  params.place.resolution = resolution;
  params.surface.gap = true;
  return reconstruct(cloud(), params, context_on(back_end));
}

class Determinism : public testing::TestWithParam<std::string> {};

/// Sanitized runs skip names that end in Slow: the best target and scalar code are enough.
std::string target_name(const testing::TestParamInfo<std::string>& info) {
  const std::vector<std::string> targets = simd_targets();
  return info.param + (info.param == targets.front() || info.param == targets.back() ? "" : "_Slow");
}

TEST_P(Determinism, SameMeshBytesOnAnyNumberOfThreads) {
  // Each target equals the best one with one thread, and so do the best one and plain code with more.
  const std::string best = simd_targets().front(), plain = simd_targets().back();
  const std::vector<int> counts = sanitized             ? std::vector{4}
                                  : GetParam() == best  ? std::vector{2, 3, 8}
                                  : GetParam() == plain ? std::vector{1, 3}
                                                        : std::vector{1};
  const Reconstruction oracle = reconstructed({sanitized ? GetParam() : best, 1});
  EXPECT_GT(oracle.mesh.triangles.size(), size_t{resolution * resolution / 3});
  for (const int threads : counts) {
    const Reconstruction result = reconstructed({GetParam(), threads});
    EXPECT_EQ(hash_mesh(result.mesh), hash_mesh(oracle.mesh)) << threads << " threads";
    EXPECT_EQ(hash_bytes<float>(result.mesh.attributes.at(0).values),
              hash_bytes<float>(oracle.mesh.attributes.at(0).values));
    EXPECT_EQ(result.report.isovalue, oracle.report.isovalue);
    EXPECT_EQ(result.report.certificate.binary.primal, oracle.report.certificate.binary.primal);
    EXPECT_EQ(result.report.certificate.binary.dual, oracle.report.certificate.binary.dual);
  }
}

INSTANTIATE_TEST_SUITE_P(Targets, Determinism, testing::ValuesIn(simd_targets()), target_name);

}  // namespace TEST_FILE
}  // namespace soapfilm
