// Ranks that share the loops of relaxing give the bits of one process.
#include <gtest/gtest.h>

#include "refine/band_support.h"
#include "soapfilm/relax/relax.h"
#include "support/hash.h"
#include "support/sanitized.h"
#include "support/thread_ranks.h"

namespace soapfilm {
namespace TEST_FILE {

using namespace test;

struct Outcome {
  uint64_t mesh = 0;
  size_t split_edges = 0;
  bool operator==(const Outcome&) const = default;
};

/// The distance, and normal deviates of so many voxels: with large ones triangles would meet, and have to be kept
/// apart.
Field<float> uneven(const DistanceField& field, double roughness) {
  Field<float> value(field.grid);
  Random random(7);
  for (size_t b = 0; b < field.grid.size(); ++b)
    for (int i = 0; i < brick_volume; ++i)
      value.brick(b)[i] = field.value.brick(b)[i] + static_cast<float>(roughness * random.normal());
  return value;
}

class RelaxOnRanks : public testing::TestWithParam<double> {};

TEST_P(RelaxOnRanks, GivesTheBitsOfOneProcess) {
  const Solved solved("knot", sanitized ? 40 : 80, 2, {.noise_vox = 0.05});
  const Refined flat = refined(solved);
  const Field<float> value = uneven(flat.field, GetParam());
  const auto run = [&](const Context& context) {
    Mesh mesh = flat.mesh;
    const RelaxReport report = relax_mesh(mesh, SmoothField(flat.field.grid, value, context), solved.problem.samples,
                                          0.2, solved.problem.lattice, {}, context);
    return Outcome{hash_mesh(mesh), report.split_edges};
  };
  EXPECT_GT(run(Context(1)).split_edges, 100u);
  expect_same_on_ranks<Outcome>(run);
}

INSTANTIATE_TEST_SUITE_P(Roughness, RelaxOnRanks, testing::Values(0.0, 0.3));

}  // namespace TEST_FILE
}  // namespace soapfilm
