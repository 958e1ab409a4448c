#include "soapfilm/components/parts.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <optional>
#include <queue>
#include <set>

#include "components/drawn_level.h"
#include "support/random_level.h"
#include "support/sanitized.h"

namespace soapfilm {
namespace TEST_FILE {

using namespace test;

/// The same parts by flooding every vertex of the box; numbered as they are met, x fastest.
Dense<int> flooded(const Dense<uint8_t>& labels) {
  Dense<int> part(labels.size(), -1);
  int parts = 0;
  labels.for_each([&](Vec3i seed) {
    if (part[seed] >= 0) return;
    const int number = parts++;
    std::queue<Vec3i> front;
    const auto reach = [&](Vec3i v) {
      part[v] = number;
      front.push(v);
    };
    for (reach(seed); !front.empty(); front.pop())
      for (int k = 0; k < 27; ++k) {
        const Vec3i d = slot_offset(k), next = front.front() + d;
        if (labels[seed] && dot(d, d) != 1) continue;
        if (labels.contains(next) && part[next] < 0 && labels[next] == labels[seed]) reach(next);
      }
  });
  return part;
}

/// Any u that is constant on the parts outside the band: noise of the given share, cut off near the box's end.
void make_noise(RandomLevel& random, double share, uint64_t seed) {
  Random dice(seed);
  Level& level = random.level;
  for (size_t b = 0; b < level.grid.size(); ++b)
    for_each_vertex(level.grid.coord(b), [&](Vec3i v, int i) {
      level.u.brick(b)[i] = dice.uniform() < share && level.box.is_free(v) ? 1.0f : 0.0f;
    });
}

uint32_t part_at(const Parts& parts, Vec3i vertex) {
  const Vec3i brick = brick_of(vertex);
  return PartsAround(parts, brick).at(vertex - brick * brick_side);
}

class Labeling : public testing::TestWithParam<double> {};

/// Parts, their sizes and their surfaces are those of a plain flood, in noise that has thousands of them.
TEST_P(Labeling, IsThatOfAFlood) {
  for (const double band : {1.0, 0.5}) {
    RandomLevel random(3, {.band = band, .more_layers = sanitized ? 0 : 170});
    make_noise(random, GetParam(), 5);
    const Labels found = labels_of(random.level, 0.5f, Context(2));
    const Parts parts(found, Context(2));
    const Dense<uint8_t> labels = dense_labels(found);
    const Dense<int> expected = flooded(labels);

    std::map<int, uint32_t> part_of;
    std::set<uint32_t> met;
    std::vector<size_t> vertices(parts.size()), faces(parts.size());
    std::optional<PartsAround> around;
    labels.for_each([&](Vec3i v) {
      const Vec3i own{v.x & 7, v.y & 7, v.z & 7};
      if (own.x == 0 || !around) around.emplace(parts, brick_of(v));
      const uint32_t part = around->at(own);
      ASSERT_LT(part, parts.size());
      ASSERT_EQ(part_of.emplace(expected[v], part).first->second, part);
      ASSERT_EQ(parts[part].inside, labels[v] != 0);
      met.insert(part);
      ++vertices[part];
      for (int axis = 0; axis < 3; ++axis)
        for (const int step : {-1, 1}) {
          const Vec3i next = v + along(axis) * step;
          const uint32_t other = around->at(next - v + own);
          if (parts[other].inside == parts[part].inside) continue;
          // Of two parts that share a surface one lies in the other.
          ASSERT_TRUE(parts[part].around == other || parts[other].around == part);
          if (parts[part].around == other) ++faces[part];
        }
      // A brick away, in any direction.
      const Vec3i step = slot_offset((own.x + 3 * own.y + 9 * own.z) % 27) * brick_side;
      const uint32_t far = around->at(own + step);
      if (!labels.contains(v + step))
        ASSERT_EQ(far, 0u);
      else
        ASSERT_EQ(part_of.emplace(expected[v + step], far).first->second, far);
    });
    EXPECT_EQ(part_of.size(), met.size()) << "parts that the flood keeps apart";
    EXPECT_EQ(met.size(), parts.size());
    EXPECT_EQ(part_at(parts, {0, 0, 0}), 0u);
    EXPECT_GT(parts.size(), 50u);
    for (uint32_t p = 0; p < parts.size(); ++p) {
      EXPECT_EQ(parts[p].vertices, vertices[p]);
      EXPECT_EQ(parts[p].faces, faces[p]);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Shares, Labeling, testing::Values(0.1, 0.5, 0.97),
                         [](const auto& share) { return std::to_string(static_cast<int>(100 * share.param)); });

/// Where the band leaves room inside an object, and bricks outside it are inside.
TEST(Labeling, GoesThroughMissingBricks) {
  Lattice lattice;
  lattice.size = {70, 70, 70};
  const LevelBox box = lattice.box(0);
  // A hollow ball: radius 30, with a void of radius 18 and in it a ball of radius 5.
  const Vec3i center{36, 36, 36};
  const auto radius2 = [&](Vec3i v) { return dot(v - center, v - center); };
  const auto inside = [&](int r2) { return (r2 < 900 && r2 >= 324) || r2 < 25; };
  Labels labels = labels_of(drawn_level(box, true, [&](Vec3i v) { return inside(radius2(v)); }), 0.5f, Context(1));
  ASSERT_TRUE(labels.inside.test(labels.grid, brick_of(center + Vec3i{24, 0, 0})));

  const Parts parts(labels, Context(3));
  ASSERT_EQ(parts.size(), 4u);
  const uint32_t shell = part_at(parts, center + Vec3i{24, 0, 0}), hollow = part_at(parts, center + Vec3i{0, 12, 0}),
                 core = part_at(parts, center);
  EXPECT_EQ(parts[core].around, hollow);
  EXPECT_EQ(parts[hollow].around, shell);
  EXPECT_EQ(parts[shell].around, 0u);

  // All of the inside filled, then nothing left.
  std::vector<uint8_t> sides(4, 1);
  sides[0] = 0;
  parts.write(sides, labels, Context(2));
  const Dense<uint8_t> filled = dense_labels(labels);
  filled.for_each([&](Vec3i v) { ASSERT_EQ(filled[v], radius2(v) < 900); });
  const Parts solid(labels, Context(1));
  ASSERT_EQ(solid.size(), 2u);
  solid.write({0, 0}, labels, Context(1));
  EXPECT_EQ(count_inside(dense_labels(labels)), 0u);
}

}  // namespace TEST_FILE
}  // namespace soapfilm
