#include "soapfilm/solve/inside_bits.h"

#include <gtest/gtest.h>

#include "support/random_level.h"

namespace soapfilm {
namespace TEST_FILE {

using namespace test;

const Context one_thread(1);

/// u at any vertex of the domain, 0 beyond it.
float u_at(const Level& level, Vec3i v) {
  const Vec3i brick = brick_of(v);
  const int32_t n = level.grid.find(brick);
  return n >= 0 ? level.u.brick(static_cast<size_t>(n))[brick_offset(v.x & 7, v.y & 7, v.z & 7)]
                : level.missing_u(n, brick);
}

/// A level with bricks outside the band that are inside the surface, and others.
struct Filled : RandomLevel {
  explicit Filled(uint64_t seed) : RandomLevel(seed) {
    Random random(seed);
    for (size_t gap = 0; gap < level.grid.gaps(); ++gap) level.inside.set(gap, random.uniform() < 0.5);
  }
};

TEST(InsideBits, AreSetWhereUIsAboveTheThreshold) {
  const Filled filled(3);
  const Level& level = filled.level;
  const InsideBits inside(level, 0.3f, one_thread);
  BrickMask::whole(level.box.bricks).for_each([&](Vec3i b) {
    const BrickBits& bits = inside.of(level.grid.find(b), b);
    for_each_vertex(b, [&](Vec3i v, int i) { ASSERT_EQ(bits.test(i & 7, i >> 3 & 7, i >> 6), u_at(level, v) > 0.3f); });
  });
}

TEST(InsideBits, TheInterfaceHasANeighborOnTheOtherSide) {
  const Filled filled(4);
  const Level& level = filled.level;
  const InsideBits inside(level, 0.5f, one_thread);
  for (size_t b = 0; b < level.grid.size(); ++b) {
    const BrickBits interface = inside.interface(b);
    for_each_vertex(level.grid.coord(b), [&](Vec3i v, int i) {
      bool expected = false;
      for (int axis = 0; axis < 3; ++axis)
        for (const int step : {-1, 1}) {
          Vec3i next = v;
          next[axis] += step;
          expected |= (u_at(level, next) > 0.5f) != (u_at(level, v) > 0.5f);
        }
      ASSERT_EQ(interface.test(i & 7, i >> 3 & 7, i >> 6), expected);
    });
  }
}

/// Of a box and an open one whose border divides bricks.
TEST(InsideBits, GoOnBeyondAnOpenBorderAsInFrontOfIt) {
  for (const bool open : {false, true}) {
    Filled filled(5);
    filled.level.box.open = open;
    const Level& level = filled.level;
    const InsideBits inside(level, 0.5f, one_thread);
    const Vec3i n = level.box.bricks;
    size_t beyond = 0;
    BrickMask::whole(n + Vec3i{2, 2, 2}).for_each([&](Vec3i shifted) {
      const Vec3i b = shifted - Vec3i{1, 1, 1};
      const BrickBits bits = inside.continued(level.grid.find(b), b);
      for_each_vertex(b, [&](Vec3i v, int i) {
        const Vec3i from = open ? nearest_free(level.box, v) : v;
        beyond += from != v;
        ASSERT_EQ(bits.test(i & 7, i >> 3 & 7, i >> 6), u_at(level, from) > 0.5f);
      });
    });
    EXPECT_EQ(beyond > 0, open);
  }
}

TEST(InsideBits, TheInterfaceEndsAtAnOpenBorder) {
  Filled filled(6);
  filled.level.box.open = true;
  const Level& level = filled.level;
  const InsideBits inside(level, 0.5f, one_thread);
  for (size_t b = 0; b < level.grid.size(); ++b) {
    const BrickBits interface = inside.interface(b);
    for_each_vertex(level.grid.coord(b), [&](Vec3i v, int i) {
      if (!level.box.is_free(v)) {
        ASSERT_FALSE(interface.test(i & 7, i >> 3 & 7, i >> 6));
      }
    });
  }
}

}  // namespace TEST_FILE
}  // namespace soapfilm
