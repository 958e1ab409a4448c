#include "soapfilm/adapt/agreement.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "adapt/ball_levels.h"

namespace soapfilm {
namespace TEST_FILE {

using namespace test;

const Context one_thread(1);

double ball(Vec3d q) { return 45 - norm(q - Vec3d{63, 64, 65}); }

Labels labels_of_field(const Lattice& lattice, int level, const std::function<double(Vec3d)>& distance) {
  Labels labels;
  labels.box = lattice.box(level);
  labels.grid = BrickGrid(BrickMask::whole(labels.box.bricks), one_thread);
  labels.inside = GapSides(labels.grid);
  labels.bits.resize(labels.grid.size());
  for (size_t b = 0; b < labels.grid.size(); ++b)
    for_each_vertex(labels.grid.coord(b), [&](Vec3i v, int i) {
      if (distance(leaf_center(level, v)) > 0) labels.bits[b].set(i);
    });
  return labels;
}

TEST(Agreement, NothingIsGivenBackWhereLevelsAgree) {
  const Lattice lattice = small_lattice();
  const Labels fine = labels_of_field(lattice, 0, ball), coarse = labels_of_field(lattice, 1, ball);
  Regions regions = halves(lattice, 5, 2);
  give_back_disagreement(regions, 1, coarse, fine, one_thread);
  EXPECT_TRUE(regions.finer(1) == halves(lattice, 5, 2).finer(1));
}

/// The finer level cuts the ball off from x = 40 on. What it has from the border on is given back as far as it is not
/// asked for; a dent away from the border, in front of which both agree, stays.
TEST(Agreement, FilmsAreGivenBackFromTheBorderOn) {
  const Lattice lattice = small_lattice();
  const auto dent = [](Vec3d q) { return norm(q - Vec3d{24, 64, 65}) - 12; };
  const auto cut = [&](Vec3d q) { return std::min({ball(q), 40 - q.x, dent(q)}); };
  const Labels fine = labels_of_field(lattice, 0, cut), coarse = labels_of_field(lattice, 1, ball);
  Regions regions = halves(lattice, 5, 1);
  give_back_disagreement(regions, 1, coarse, fine, one_thread);
  const Vec3i through{4, 4, 4}, at_film{2, 4, 4};
  EXPECT_FALSE(regions.is_finer(1, through));
  EXPECT_FALSE(regions.is_finer(1, at_film));
  EXPECT_TRUE(regions.is_finer(1, {0, 4, 4}));
  EXPECT_TRUE(regions.is_finer(1, {4, 0, 0}));  // outside on both

  Regions asked = halves(lattice, 5, 5);
  give_back_disagreement(asked, 1, coarse, fine, one_thread);
  EXPECT_TRUE(asked.finer(1) == halves(lattice, 5, 5).finer(1));
}

}  // namespace TEST_FILE
}  // namespace soapfilm
