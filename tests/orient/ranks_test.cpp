// Ranks that share the search for the samples' planes give the bits of one process.
#include <gtest/gtest.h>

#include "soapfilm/core/random.h"
#include "soapfilm/orient/local_surface.h"
#include "support/hash.h"
#include "support/thread_ranks.h"
#include "tools/scanner/sample_surface.h"
#include "tools/scanner/shape.h"

namespace soapfilm::test {
namespace TEST_FILE {

template <class T>
uint64_t hash_of(const std::vector<T>& values, uint64_t before) {
  return hash_bytes(std::span<const T>(values), before);
}

uint64_t hash_of(const LocalSurface& surface) {
  const std::vector<double> sums{surface.coverage.area,
                                 surface.coverage.per_area,
                                 surface.coverage.spacing,
                                 surface.sides.contradicting(),
                                 surface.sides.at_seams(),
                                 surface.sides.on_sheets(),
                                 surface.sides.thinner_than(1).share,
                                 static_cast<double>(surface.planes)};
  return hash_of(surface.area,
                 hash_of(surface.spacing, hash_of(surface.normal, hash_of(surface.line, hash_of(sums, 0)))));
}

TEST(SurveyOnRanks, GivesTheBitsOfOneProcess) {
  for (const char* shape : {"knot", "plate"}) {
    PointCloud cloud = sample_surface(*make_shape(shape), 20000, 1);
    Random random(3);
    for (size_t i = 0; i < cloud.size(); i += 7)
      cloud.positions[i] += Vec3d{random.normal(), random.normal(), random.normal()} * 0.05;
    EXPECT_GT(measure_local_surface(cloud.positions, cloud.normals, cloud.box(), Context(1)).planes, 1000u);
    expect_same_on_ranks<uint64_t>([&](const Context& context) {
      return hash_of(measure_local_surface(cloud.positions, cloud.normals, cloud.box(), context));
    });
  }
}

}  // namespace TEST_FILE
}  // namespace soapfilm::test
