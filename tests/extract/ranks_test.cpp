// Ranks that each draw some blocks of a surface give the mesh of one process.
#include <gtest/gtest.h>

#include <cmath>

#include "soapfilm/core/random.h"
#include "soapfilm/extract/isosurface.h"
#include "support/hash.h"
#include "support/thread_ranks.h"

namespace soapfilm {
namespace TEST_FILE {

using namespace test;

/// Bricks chosen at random, with random values.
struct Noise {
  BrickGrid grid;
  Field<float> value;

  explicit Noise(double share) {
    Random random(5);
    BrickMask mask({4, 5, 9});
    for (int z = 0; z < 9; ++z)
      for (int y = 0; y < 5; ++y)
        for (int x = 0; x < 4; ++x)
          if (random.uniform() < share) mask.set({x, y, z});
    grid = BrickGrid(mask, Context(1));
    value = values(random);
  }
  /// In [0, 1), most of them low.
  Field<float> values(Random& random) const {
    Field<float> found(grid);
    for (size_t b = 0; b < grid.size(); ++b)
      for (int i = 0; i < brick_volume; ++i) found.brick(b)[i] = static_cast<float>(std::pow(random.uniform(), 3));
    return found;
  }
};

TEST(ExtractOnRanks, GivesTheMeshOfOneProcess) {
  for (const double share : {0.6, 1.0}) {
    const Noise noise(share);
    const auto run = [&](const Context& context) {
      return hash_mesh(extract_isosurface(
          noise.grid, noise.value, [](Vec3i) { return 0.0f; }, 0.5f, Lattice{}, context));
    };
    expect_same_on_ranks<uint64_t>(run);
    EXPECT_NE(run(Context(1)), hash_mesh({}));
  }
}

TEST(ExtractOnRanks, AlsoOfWhatIsPartlyKnown) {
  const Noise noise(0.8);
  Random random(6);
  Field<float> weight = noise.values(random);
  for (size_t b = 0; b < noise.grid.size(); ++b)
    for (int i = 0; i < brick_volume; ++i) weight.brick(b)[i] = weight.brick(b)[i] > 1e-4f ? 1.0f : 0.0f;
  expect_same_on_ranks<uint64_t>([&](const Context& context) {
    return hash_mesh(extract_open_isosurface(noise.grid, noise.value, weight, 0.5f, Lattice{}, context));
  });
}

}  // namespace TEST_FILE
}  // namespace soapfilm
