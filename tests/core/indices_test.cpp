#include "soapfilm/core/indices.h"

#include <gtest/gtest.h>

#include <string>

#include "soapfilm/error.h"

namespace soapfilm {
namespace TEST_FILE {

TEST(Indices, ARefusalSaysHowManyTheLimitAndWhatToDo) {
  for (const uint64_t most : {most_indices, most_triangles, most_bricks}) {
    EXPECT_NO_THROW(require_indices(most, most, "things"));
    try {
      require_indices(most + 1, most, "things");
      FAIL() << most;
    } catch (const ParameterError& error) {
      const std::string line = error.what();
      EXPECT_EQ(line.find(std::to_string(most + 1) + " things, must be at most " + std::to_string(most)), 0u) << line;
      EXPECT_NE(line.find("larger voxel"), std::string::npos) << line;
    }
  }
}

/// Corners, and half edges, of that many triangles have indices; "none" is not one of them.
TEST(Indices, OfAllHalfEdgesFit) { EXPECT_LE(3 * most_triangles, uint64_t{UINT32_MAX}); }

}  // namespace TEST_FILE
}  // namespace soapfilm
