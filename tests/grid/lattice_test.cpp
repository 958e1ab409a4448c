#include "soapfilm/grid/lattice.h"

#include <gtest/gtest.h>

#include "soapfilm/error.h"

namespace soapfilm {
namespace TEST_FILE {

Box3d box(Vec3d lo, Vec3d size) { return {lo, lo + size}; }

/// The bunny's range scans span 1 : 0.941 : 0.738; the paper's table 1 gives these sizes for them.
TEST(Lattice, CountsVerticesAsThePaperDoes) {
  const Box3d samples = box({0, 0, 0}, {500, 469.2, 365.5});
  const Lattice lattice = place_lattice(samples, voxel_of_resolution(samples, 512, 6), 6);
  EXPECT_EQ(lattice.to_world_axes(lattice.size), (Vec3i{512, 482, 378}));
  EXPECT_DOUBLE_EQ(lattice.voxel, 1.0);
}

TEST(Lattice, FirstVertexIsHalfAVoxelShortOfThePaddingBelowTheSamples) {
  const Lattice lattice = place_lattice(box({10, 20, 30}, {5, 4, 3}), 0.5, 6);
  EXPECT_EQ(lattice.first_vertex, (Vec3d{10 - 2.75, 20 - 2.75, 30 - 2.75}));
  EXPECT_EQ(lattice.to_world_axes(lattice.size), (Vec3i{10 + 12, 8 + 12, 6 + 12}));
}

TEST(Lattice, TurnsItsAxesUntilLayersAlongZAreSmall) {
  const auto axis_shift = [](Vec3d length) { return place_lattice(box({1, 2, 3}, length), 0.5, 6).axis_shift; };
  EXPECT_EQ(axis_shift({50, 50, 50}), 0);
  EXPECT_EQ(axis_shift({5, 6, 90}), 0);
  EXPECT_EQ(axis_shift({90, 5, 6}), 1);
  EXPECT_EQ(axis_shift({6, 90, 5}), 2);
  // Layers hardly differ: long rows.
  EXPECT_EQ(axis_shift({90, 90, 5}), 1);
  EXPECT_EQ(axis_shift({5, 90, 90}), 2);
  EXPECT_EQ(axis_shift({90, 5, 90}), 0);
  for (const Vec3d length : {Vec3d{50, 40, 30}, {30, 50, 40}, {40, 30, 50}, {90, 5, 6}, {6, 90, 5}}) {
    const Lattice lattice = place_lattice(box({1, 2, 3}, length), 0.5, 6);
    const Vec3d p{4, 4.5, 4.75};
    const Vec3d q = lattice.to_lattice(p) - lattice.to_lattice({1, 2, 3});
    EXPECT_EQ(lattice.to_world_axes(q), (Vec3d{6, 5, 3.5}));
    EXPECT_EQ(lattice.to_world(lattice.to_lattice(p)), p);
    for (int axis = 0; axis < 3; ++axis)
      EXPECT_EQ(lattice.size[axis], 2 * length[(axis + lattice.axis_shift) % 3] + 12);
  }
}

TEST(Lattice, AWholeNumberOfVoxelsGainsNoCellByRounding) {
  for (const double offset : {0.0, 0.1, 1e3, 5e6}) {
    const Lattice lattice = place_lattice(box({offset, offset, offset}, {0.3, 0.3, 0.3}), 0.1, 6);
    EXPECT_EQ(lattice.size, (Vec3i{15, 15, 15})) << offset;
  }
}

TEST(Lattice, WorldAndLatticeCoordinatesAreInverse) {
  const Lattice lattice = place_lattice(box({5e6, -5e6, 100}, {1, 2, 3}), 1e-3, 6);
  const Vec3d p{5e6 + 0.123456, -5e6 + 1.654321, 101.5};
  const Vec3d back = lattice.to_world(lattice.to_lattice(p));
  for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(back[axis], p[axis], 2e-9);
}

TEST(Lattice, UsesAtLeastThePapersThreeLevelsAndStopsAtSmallGrids) {
  const auto levels = [](int resolution) {
    const Box3d samples = box({0, 0, 0}, {1, 1, 1});
    return place_lattice(samples, voxel_of_resolution(samples, resolution, 6), 6).levels;
  };
  EXPECT_EQ(levels(32), 3);
  EXPECT_EQ(levels(64), 3);
  EXPECT_EQ(levels(128), 4);
  EXPECT_EQ(levels(512), 6);
  EXPECT_EQ(levels(2048), 8);
}

/// A corridor's box must not be rounded up to cells as long as a few of which hold its length.
TEST(Lattice, BoxesOfALongThinGridAreThin) {
  const Lattice lattice = place_lattice(box({0, 0, 0}, {100'000, 38, 45}), 1, 6);
  EXPECT_EQ(lattice.to_world_axes(lattice.size), (Vec3i{100'012, 50, 57}));
  EXPECT_GE(lattice.levels, 3);
  const LevelBox finest = lattice.box(0);
  const double held = static_cast<double>(finest.bricks.x) * finest.bricks.y * finest.bricks.z * brick_volume;
  EXPECT_LT(held, 200 * lattice.vertices());  // of bits
}

/// On every level: vertex 0 is fixed, the fixed layers stay outside, and boxes nest.
TEST(Lattice, BoxesOfThePyramidNest) {
  for (const int levels : {1, 2, 3, 5})
    for (const Vec3i size : {Vec3i{60, 61, 62}, {63, 64, 65}, {128, 77, 99}}) {
      Lattice lattice;
      lattice.size = size;
      lattice.levels = levels;
      for (int l = 0; l < levels; ++l) {
        const LevelBox level = lattice.box(l);
        for (int axis = 0; axis < 3; ++axis) {
          EXPECT_GE(level.free_lo[axis], 1);
          EXPECT_LT(level.free_hi[axis], brick_side * level.bricks[axis]);
          if (l == 0) {
            EXPECT_EQ(level.free_lo[axis], lattice.margin()[axis] + 1);
            EXPECT_EQ(level.free_hi[axis], lattice.margin()[axis] + size[axis] - 2);
            continue;
          }
          const LevelBox finer = lattice.box(l - 1);
          EXPECT_EQ(finer.bricks[axis], 2 * level.bricks[axis]);
          EXPECT_EQ(finer.free_lo[axis] >> 1, level.free_lo[axis]);
          EXPECT_EQ(finer.free_hi[axis] >> 1, level.free_hi[axis]);
        }
      }
    }
}

/// Tiles of lattices with the same anchor lie at the same places, whatever the samples; nothing else changes.
TEST(Lattice, AnAnchorFixesItsTiles) {
  const double voxel = 0.25, tile = 256 * voxel;
  const Vec3d anchor{100.125, -7, 3.5};
  for (const Vec3d lo : {Vec3d{0, 0, 0}, {1e5, -3, 40}, {-33.3, 1e-3, -1e6}})
    for (const Vec3d size : {Vec3d{30, 40, 10}, {3, 90, 500}})
      for (const bool open : {false, true}) {
        const Box3d samples = box(lo, size);
        const Vec3d below = samples.lo - Vec3d{6, 6, 6} * voxel, above = samples.hi + Vec3d{5, 5, 5} * voxel;
        Lattice lattice = place_lattice(samples, voxel, 6, 0, anchor);
        lattice.open = open;
        EXPECT_EQ(lattice.axis_shift, 0);
        for (int axis = 0; axis < 3; ++axis) {
          const double tiles = (lattice.to_world({0, 0, 0})[axis] - anchor[axis]) / tile;
          EXPECT_NEAR(tiles, std::round(tiles), 1e-9);
          EXPECT_LE(lattice.first_vertex[axis], below[axis] + voxel);
          EXPECT_GE(lattice.first_vertex[axis], below[axis] - voxel);
          EXPECT_GE(lattice.first_vertex[axis] + (lattice.size[axis] - 1) * voxel, above[axis]);
        }
        for (int l = 0; l < lattice.levels; ++l) {
          const LevelBox level = lattice.box(l);
          for (int axis = 0; axis < 3; ++axis) {
            EXPECT_GE(level.free_lo[axis], 1);
            EXPECT_LT(level.free_hi[axis], brick_side * level.bricks[axis]);
            if (open && l < 3) {
              EXPECT_EQ(level.free_lo[axis] << l, lattice.box(0).free_lo[axis]) << "the same border";
            }
          }
        }
      }
  EXPECT_THROW(place_lattice(box({0, 0, 0}, {1, 1, 1}), 0.1, 6, 0, Vec3d{1e30, 0, 0}), ParameterError);
}

/// Drawn by itself, a level's vertices keep their lattice coordinates and lie amid their children.
TEST(Lattice, ALevelOfItsOwnLiesWhereItsChildrenAre) {
  const Lattice lattice = place_lattice(box({5e6, -2, 0.5}, {1, 1.37, 0.61}), 0.0137, 6, 4);
  for (int l = 0; l < lattice.levels; ++l) {
    const Lattice level = lattice.of_level(l);
    const int cell = 1 << l;
    EXPECT_EQ(level.levels, lattice.levels - l);
    EXPECT_EQ(cell * level.margin(), lattice.margin());
    EXPECT_DOUBLE_EQ(level.voxel, cell * lattice.voxel);
    for (const Vec3i v : {Vec3i{0, 0, 0}, {3, 1, 4}, {9, 6, 2}}) {
      const Vec3d first = lattice.to_world(Vec3d(v * cell));
      Vec3d children;  // from the first: sums of far ones round
      for (int k = 0; k < cell * cell * cell; ++k)
        children += lattice.to_world(Vec3d(v * cell + Vec3i{k % cell, k / cell % cell, k / (cell * cell)})) - first;
      const Vec3d middle = first + children / static_cast<double>(cell * cell * cell);
      for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(level.to_world(Vec3d(v))[axis], middle[axis], 2e-8);
    }
    // Together they cover the grid, and hardly more.
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_GE(level.size[axis] * cell, lattice.size[axis]);
      EXPECT_LT((level.size[axis] - 1) * cell, lattice.size[axis]);
    }
  }
  EXPECT_EQ(lattice.of_level(0).first_vertex, lattice.first_vertex);
  EXPECT_EQ(lattice.of_level(0).size, lattice.size);
}

/// Levels added below: the same places, the same boxes from the placed level on, and below it their children.
TEST(Lattice, LevelsCanBeAddedBelow) {
  for (const bool open : {false, true}) {
    Lattice placed = place_lattice({{1, 2, 3}, {2.3, 2.9, 4}}, 0.013, 6);
    placed.open = open;
    const Lattice refined = placed.refined(2);
    EXPECT_EQ(refined.added, 2);
    EXPECT_DOUBLE_EQ(refined.voxel, placed.voxel / 4);
    EXPECT_EQ(refined.levels, placed.levels + 2);
    for (int l = 0; l < placed.levels; ++l) {
      const LevelBox box = placed.box(l), same = refined.box(l + 2);
      EXPECT_EQ(box.free_lo, same.free_lo);
      EXPECT_EQ(box.free_hi, same.free_hi);
      EXPECT_EQ(box.bricks, same.bricks);
      EXPECT_EQ(same.level, l + 2);
    }
    for (int l = 0; l < 2; ++l) {
      const LevelBox fine = refined.box(l), coarse = refined.box(l + 1);
      EXPECT_EQ(fine.bricks, coarse.bricks * 2);
      EXPECT_EQ(fine.free_lo, coarse.free_lo * 2);
      EXPECT_EQ(fine.free_hi, coarse.free_hi * 2 + (Vec3i{1, 1, 1}));
    }
    // Vertex I of the placed level is the center of the vertices 4I to 4I + 3.
    const Vec3d vertex{41, 30, 52};
    EXPECT_LT(norm(placed.to_world(vertex) - refined.to_world(vertex * 4.0 + Vec3d{1.5, 1.5, 1.5})), 1e-12);
    EXPECT_LT(norm(placed.to_world(vertex) - refined.of_level(2).to_world(vertex)), 1e-12);
  }
}

TEST(Lattice, RefusesWhatCannotBeAGrid) {
  const Box3d samples = box({0, 0, 0}, {1, 1, 1});
  EXPECT_THROW(place_lattice(samples, 0, 6), ParameterError);
  EXPECT_THROW(place_lattice(samples, -1, 6), ParameterError);
  EXPECT_THROW(place_lattice(samples, std::numeric_limits<double>::quiet_NaN(), 6), ParameterError);
  EXPECT_THROW(place_lattice(samples, 0.1, 1), ParameterError);
  EXPECT_THROW(place_lattice(samples, 1e-9, 6), ParameterError);
  EXPECT_THROW(voxel_of_resolution(samples, 12, 6), ParameterError);
  EXPECT_THROW(voxel_of_resolution(samples, 1 << 29, 6), ParameterError);
  EXPECT_NO_THROW(voxel_of_resolution(samples, 13, 6));
}

}  // namespace TEST_FILE
}  // namespace soapfilm
