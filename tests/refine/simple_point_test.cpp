#include "soapfilm/refine/topology/simple_point.h"

#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <functional>

#include "soapfilm/core/random.h"

namespace soapfilm {
namespace TEST_FILE {

constexpr int middle = 13;

/// Components of some vertices of a 3 x 3 x 3 block under a neighborhood of 1 (faces) to 3 (corners too) steps.
int components(uint32_t vertices, int steps) {
  int count = 0;
  while (vertices != 0) {
    ++count;
    uint32_t stack = vertices & (~vertices + 1);
    vertices &= ~stack;
    while (stack != 0) {
      const int a = std::countr_zero(stack);
      stack &= stack - 1;
      for (int b = 0; b < 27; ++b) {
        const int dx = std::abs(a % 3 - b % 3), dy = std::abs(a / 3 % 3 - b / 3 % 3), dz = std::abs(a / 9 - b / 9);
        if (dx > 1 || dy > 1 || dz > 1 || dx + dy + dz > steps || !(vertices >> b & 1)) continue;
        stack |= 1u << b;
        vertices &= ~(1u << b);
      }
    }
  }
  return count;
}

/// Euler number of the union of closed unit cubes centered at the outside vertices: 26-connected, so its complement,
/// the inside, is 6-connected.
int euler_of_outside(uint32_t inside) {
  int euler = 0;
  // Cells of the cubical complex have doubled coordinates 0..6; cube v has its center at 2 v + 1 along each axis.
  for (int z = 0; z <= 6; ++z)
    for (int y = 0; y <= 6; ++y)
      for (int x = 0; x <= 6; ++x) {
        const std::array<int, 3> cell{x, y, z};
        bool covered = false;
        for (int v = 0; v < 27 && !covered; ++v) {
          const std::array<int, 3> center{2 * (v % 3) + 1, 2 * (v / 3 % 3) + 1, 2 * (v / 9) + 1};
          bool touches = !(inside >> v & 1);
          for (size_t k = 0; k < 3; ++k) touches = touches && std::abs(cell[k] - center[k]) <= 1;
          covered = touches;
        }
        const int dimension = (x & 1) + (y & 1) + (z & 1);
        if (covered) euler += dimension % 2 == 0 ? 1 : -1;
      }
  return euler;
}

TEST(SimplePoint, AloneIsWhatIsAComponentByItself) {
  Random random(3);
  const auto random_bits = [&](double share) {
    uint32_t bits = 0;
    for (int k = 0; k < 27; ++k) bits |= static_cast<uint32_t>(random.uniform() < share) << k;
    return bits;
  };
  constexpr uint32_t all = (1u << 27) - 1, own = 1u << middle;
  int alone = 0;
  for (int k = 0; k < 20000; ++k) {
    const uint32_t others = random_bits(k % 2 ? 0.1 : 0.97) & ~own;
    // It is an additional component if nothing touches it.
    const bool as_object = components(others | own, 1) == components(others, 1) + 1;
    const uint32_t outside = ~others & all & ~own;
    const bool as_void = components(outside | own, 3) == components(outside, 3) + 1;
    EXPECT_EQ(is_alone(others | own), as_object);
    EXPECT_EQ(is_alone(others), as_void);
    alone += as_object + as_void;
  }
  EXPECT_GT(alone, 2000);
}

TEST(SimplePoint, KnowsTheTextbookCases) {
  const auto bit = [](int dx, int dy, int dz) { return 1u << (dx + 1 + 3 * (dy + 1) + 9 * (dz + 1)); };
  EXPECT_FALSE(is_simple(0)) << "an isolated vertex is a component";
  EXPECT_FALSE(is_simple((1u << 27) - 1)) << "an interior vertex would become a cavity";
  EXPECT_TRUE(is_simple(bit(1, 0, 0))) << "the end of a line";
  EXPECT_FALSE(is_simple(bit(1, 0, 0) | bit(-1, 0, 0))) << "the middle of a line";
  EXPECT_FALSE(is_simple(bit(1, 1, 0))) << "the inside does not touch by edges";
  uint32_t below = 0, slab = 0;
  for (int k = 0; k < 9; ++k) below |= 1u << k, slab |= 1u << (9 + k);
  EXPECT_TRUE(is_simple(below)) << "a vertex on a flat surface";
  EXPECT_FALSE(is_simple(slab)) << "a sheet one vertex thick: the hole would join both sides";
  EXPECT_FALSE(is_simple(below | below << 18)) << "between two sheets";
}

TEST(SimplePoint, DoesNotDependOnTheVertexItself) {
  Random random(1);
  for (int i = 0; i < 2000; ++i) {
    const auto inside = static_cast<uint32_t>(random.next() >> 37);
    EXPECT_EQ(is_simple(inside | 1u << middle), is_simple(inside & ~(1u << middle)));
  }
}

TEST(SimplePoint, TurningOneKeepsComponentsAndEulerNumber) {
  Random random(2);
  int simple = 0;
  for (int i = 0; i < 3000; ++i) {
    // Sparse, even and full neighborhoods.
    uint32_t inside = static_cast<uint32_t>(random.next() >> 37);
    if (i % 3 == 1) inside &= static_cast<uint32_t>(random.next() >> 37);
    if (i % 3 == 2) inside |= static_cast<uint32_t>(random.next() >> 37);
    const uint32_t with = inside | 1u << middle, without = inside & ~(1u << middle);
    const uint32_t all = (1u << 27) - 1;
    const bool kept = components(with, 1) == components(without, 1) &&
                      components(all & ~with, 3) == components(all & ~without, 3) &&
                      euler_of_outside(with) == euler_of_outside(without);
    if (is_simple(inside)) {
      ++simple;
      EXPECT_TRUE(kept) << "neighborhood " << inside;
    }
  }
  EXPECT_GT(simple, 100);
}

}  // namespace TEST_FILE
}  // namespace soapfilm
