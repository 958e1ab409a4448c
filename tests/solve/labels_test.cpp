#include "soapfilm/solve/labels.h"

#include <gtest/gtest.h>

#include "soapfilm/solve/closed_border.h"
#include "support/dense.h"
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

TEST(Labels, AreSetWhereUIsAboveTheThreshold) {
  const Filled filled(3);
  const Level& level = filled.level;
  const Labels labels = labels_of(level, 0.3f, one_thread);
  BrickMask::whole(level.box.bricks).for_each([&](Vec3i b) {
    const BrickBits& bits = labels.of(b);
    for_each_vertex(b, [&](Vec3i v, int i) { ASSERT_EQ(bits.test(i & 7, i >> 3 & 7, i >> 6), u_at(level, v) > 0.3f); });
  });
}

TEST(Labels, TheInterfaceHasANeighborOnTheOtherSide) {
  const Filled filled(4);
  const Level& level = filled.level;
  const Labels labels = labels_of(level, 0.5f, one_thread);
  const LabelView view = labels.view();
  for (size_t b = 0; b < level.grid.size(); ++b) {
    const BrickBits interface = view.interface(b);
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
TEST(Labels, GoOnBeyondAnOpenBorderAsInFrontOfIt) {
  for (const bool open : {false, true}) {
    Filled filled(5);
    filled.level.box.open = open;
    const Level& level = filled.level;
    const Labels labels = labels_of(level, 0.5f, one_thread);
    const LabelView view = labels.view();
    const Vec3i n = level.box.bricks;
    size_t beyond = 0;
    BrickMask::whole(n + Vec3i{2, 2, 2}).for_each([&](Vec3i shifted) {
      const Vec3i b = shifted - Vec3i{1, 1, 1};
      const BrickBits bits = view.continued(level.grid.find(b), b);
      for_each_vertex(b, [&](Vec3i v, int i) {
        const Vec3i from = open ? nearest_free(level.box, v) : v;
        beyond += from != v;
        ASSERT_EQ(bits.test(i & 7, i >> 3 & 7, i >> 6), u_at(level, from) > 0.5f);
      });
    });
    EXPECT_EQ(beyond > 0, open);
  }
}

TEST(Labels, TheInterfaceEndsAtAnOpenBorder) {
  Filled filled(6);
  filled.level.box.open = true;
  const Level& level = filled.level;
  const Labels labels = labels_of(level, 0.5f, one_thread);
  const LabelView view = labels.view();
  for (size_t b = 0; b < level.grid.size(); ++b) {
    const BrickBits interface = view.interface(b);
    for_each_vertex(level.grid.coord(b), [&](Vec3i v, int i) {
      if (!level.box.is_free(v)) {
        ASSERT_FALSE(interface.test(i & 7, i >> 3 & 7, i >> 6));
      }
    });
  }
}

/// Plain counts over the whole domain.
TEST(Labels, InsideAndFacesAreThoseOfTheDomain) {
  for (const bool open : {false, true}) {
    Filled filled(7);
    filled.level.box.open = open;
    const Labels labels = labels_of(filled.level, 0.5f, one_thread);
    const LevelBox& box = labels.box;
    size_t inside = 0, faces = 0;
    BrickMask::whole(box.bricks).for_each([&](Vec3i b) {
      for_each_vertex(b, [&](Vec3i v, int) {
        inside += box.is_free(v) && labels.test(v);
        for (int axis = 0; axis < 3; ++axis) {
          const Vec3i next = v + along(axis);
          const bool joined = !open || (box.is_free(v) && box.is_free(next));
          // Between two missing bricks no surface is drawn, nor at the end of the box of bricks.
          const bool drawn = labels.grid.find(brick_of(v)) >= 0 || labels.grid.find(brick_of(next)) >= 0;
          faces += joined && drawn && labels.test(v) != labels.test(next);
        }
      });
    });
    for (size_t b = 0; b < labels.grid.size(); ++b)  // faces below the box's first vertices
      for_each_vertex(labels.grid.coord(b), [&](Vec3i v, int) {
        for (int axis = 0; axis < 3; ++axis)
          faces += v[axis] == 0 && labels.test(v) && (!open || (box.is_free(v) && box.is_free(v - along(axis))));
      });
    EXPECT_EQ(soapfilm::count_inside(labels, labels.bits), inside);
    EXPECT_EQ(count_faces(labels, Context(2)), faces);
  }
}

/// Where an open solution ends its inside ends too, at the border; but nobody draws that end.
TEST(Labels, ClosedAtTheBorderTheFixedVerticesAreOutside) {
  Filled filled(8);
  filled.level.box.open = true;
  const Labels open = labels_of(filled.level, 0.5f, one_thread);
  const Labels closed = closed_at_border(open, Context(2));
  BrickMask::whole(open.box.bricks).for_each([&](Vec3i b) {
    for_each_vertex(b, [&](Vec3i v, int) {
      if (open.box.is_free(v)) {
        ASSERT_EQ(closed.test(v), open.test(v));
      } else if (open.grid.find(b) < 0) {
        ASSERT_FALSE(closed.test(v));
      }
    });
  });
  const LabelView view = closed.view();
  for (size_t b = 0; b < closed.grid.size(); ++b)
    view.interface(b).for_each(
        [&](int i) { ASSERT_TRUE(closed.box.is_free(closed.grid.first_vertex(b) + vertex_in_brick(i))); });
}

}  // namespace TEST_FILE
}  // namespace soapfilm
