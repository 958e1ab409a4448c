#include <gtest/gtest.h>

#include "soapfilm/reconstruct.h"
#include "support/back_ends.h"
#include "support/hash.h"
#include "support/problem.h"
#include "support/sanitized.h"

namespace soapfilm {
namespace TEST_FILE {

using namespace test;

/// Enough bricks that several threads have tiles to sweep at once.
constexpr int resolution = sanitized ? 36 : 80;

const PointCloud& cloud() {
  static const PointCloud made = [] {
    PointCloud c = sampled("knot", resolution, 1);
    add_noise(c, 0.2 / (resolution - 12), 1);
    return c;
  }();
  return made;
}

Reconstruction reconstructed(int threads) {
  ReconstructParams params;
  params.place.resolution = resolution;
  Progress progress;
  return reconstruct(cloud(), params, Parallel(threads), progress);
}

class Determinism : public testing::TestWithParam<BackEnd> {};

TEST_P(Determinism, SameMeshBytesOnEveryBackEnd) {
  static const Reconstruction oracle = [] {
    const ForcedTarget scalar("scalar");
    return reconstructed(1);
  }();
  const ForcedTarget target(GetParam().target);
  const Reconstruction result = reconstructed(GetParam().threads);
  EXPECT_GT(result.mesh.triangles.size(), size_t{resolution * resolution / 3});
  EXPECT_EQ(hash_mesh(result.mesh), hash_mesh(oracle.mesh));
  EXPECT_EQ(result.report.isovalue, oracle.report.isovalue);
  EXPECT_EQ(result.report.certificate.binary.primal, oracle.report.certificate.binary.primal);
  EXPECT_EQ(result.report.certificate.binary.dual, oracle.report.certificate.binary.dual);
}

INSTANTIATE_TEST_SUITE_P(AllBackEnds, Determinism, testing::ValuesIn(back_ends()), back_end_name);

}  // namespace TEST_FILE
}  // namespace soapfilm
