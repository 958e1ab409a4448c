#include "soapfilm/core/border_edges.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "soapfilm/mesh.h"

namespace soapfilm {
namespace TEST_FILE {

using Edges = std::vector<std::pair<uint32_t, uint32_t>>;

Edges of(const std::vector<Triangle>& triangles) {
  Edges edges;
  for (const Triangle& t : triangles)
    for (size_t k = 0; k < 3; ++k) edges.push_back(std::minmax(t[k], t[(k + 1) % 3]));
  return edges;
}

TEST(BorderEdges, ATriangleEndsAtItsEdgesAndATetrahedronNowhere) {
  EXPECT_EQ(edges_of_one_triangle(of({{2, 0, 1}})), (Edges{{0, 1}, {0, 2}, {1, 2}}));
  EXPECT_TRUE(edges_of_one_triangle(of({{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}})).empty());
  EXPECT_TRUE(edges_of_one_triangle({}).empty());
}

TEST(BorderEdges, AnEdgeOfThreeTrianglesIsNoBorder) {
  const Edges border = edges_of_one_triangle(of({{0, 1, 2}, {1, 0, 3}, {0, 1, 4}}));
  EXPECT_EQ(border, (Edges{{0, 2}, {0, 3}, {0, 4}, {1, 2}, {1, 3}, {1, 4}}));
}

}  // namespace TEST_FILE
}  // namespace soapfilm
