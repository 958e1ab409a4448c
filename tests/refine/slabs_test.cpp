// Ranks that each refine a slab of the surface give the bits of one process.
#include <gtest/gtest.h>

#include "refine/band_support.h"
#include "support/hash.h"
#include "support/sanitized.h"
#include "support/thread_ranks.h"

namespace soapfilm {
namespace TEST_FILE {

using namespace test;

struct Outcome {
  uint64_t distance = 0;
  size_t down_weighted = 0, flips = 0;
  int iterations = 0;
  bool edge_preserving = false;
  bool operator==(const Outcome&) const = default;
};

Outcome refined_on(const Solved& solved, const Context& context) {
  FitReport report;
  const RefineSetup setup;
  const DistanceField field = refine(labels_of(solved.solution.finest, 0.5f, context), solved.problem.samples,
                                     solved.density, setup, context, report);
  Outcome outcome{0, report.down_weighted, report.flips, report.iterations, report.fit_weights.edge_preserving};
  for (size_t b = 0; b < field.grid.size(); ++b)
    outcome.distance = hash_bytes(std::span<const float>(field.value.brick(b), brick_volume), outcome.distance);
  return outcome;
}

void expect_same_bits(const Solved& solved, bool edge_preserving) {
  const auto run = [&](const Context& context) { return refined_on(solved, context); };
  EXPECT_EQ(run(Context(1)).edge_preserving, edge_preserving);
  expect_same_on_ranks<Outcome>(run);
}

TEST(RefineSlabs, RanksGiveTheBitsOfOneProcess) { expect_same_bits(Solved("torus", sanitized ? 40 : 100), false); }

TEST(RefineSlabs, AlsoWhereEdgesArePreserved) {
  expect_same_bits(Solved("part", sanitized ? 40 : 80, 2, {.noise_vox = 1.0 / 3}), true);
}

}  // namespace TEST_FILE
}  // namespace soapfilm
