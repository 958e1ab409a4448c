// Ranks that share the data term give the bits of one process.
#include <gtest/gtest.h>

#include <span>

#include "soapfilm/field/divergence.h"
#include "support/hash.h"
#include "support/problem.h"
#include "support/thread_ranks.h"

namespace soapfilm::test {
namespace TEST_FILE {

TEST(DataTermOnRanks, HasTheBitsOfOneProcess) {
  for (const char* shape : {"knot", "plate"}) {
    const PointCloud cloud = sampled(shape, 64, 1);
    const Lattice lattice = lattice_of(cloud, 64);
    const GridSamples samples = sort_samples(cloud, cloud.normals, lattice, Context(1));
    expect_same_on_ranks<uint64_t>([&](const Context& context) {
      const SupportField field = divergence_field(samples, lattice.box(0), context);
      return hash_bytes(std::span<const float>(field.f.brick(0), field.grid.vertices()));
    });
  }
}

/// Fewer bricks than ranks.
TEST(DataTermOnRanks, OfOneSample) {
  PointCloud cloud;
  cloud.positions = {{0.5, 0.5, 0.5}};
  cloud.normals = {{0, 0, 1}};
  Lattice lattice;
  lattice.size = {24, 24, 24};
  lattice.voxel = 1.0 / 24;
  const GridSamples samples = sort_samples(cloud, cloud.normals, lattice, Context(1));
  const auto run = [&](const Context& context) {
    const SupportField field = divergence_field(samples, lattice.box(0), context);
    return hash_bytes(std::span<const float>(field.f.brick(0), field.grid.vertices()));
  };
  const uint64_t alone = run(Context(1));
  for (uint64_t cut = 1; cut <= 8; ++cut)
    for (const uint64_t found : on_ranks<uint64_t>(12, 1, {cut}, run)) EXPECT_EQ(found, alone) << "cut " << cut;
}

}  // namespace TEST_FILE
}  // namespace soapfilm::test
