#include "tools/measure/columns.h"

#include <gtest/gtest.h>

#include "measure/solids.h"
#include "soapfilm/error.h"
#include "tools/scanner/shape.h"

namespace soapfilm::test {
namespace TEST_FILE {

double heap(double x, double y, double height) {
  return height * std::exp(-((x - 5) * (x - 5) + (y - 5) * (y - 5)) / 4);
}

TEST(Columns, TwoBoxesShareWhatTheyShare) {
  const Mesh now = box_mesh({0, 0, 0}, {4, 4, 4}), before = box_mesh({1, 0, 2}, {5, 4, 8});
  const VolumesBetween v = volumes_between(now, before, {.cell = 0.1}, Context(2));
  const double shared = 3 * 4 * 2;
  EXPECT_NEAR(v.fill.value, 64 - shared, 1e-6);
  EXPECT_NEAR(v.cut->value, 96 - shared, 1e-6);
  EXPECT_NEAR(v.net.value, 64.0 - 96.0, 1e-6);
  EXPECT_NEAR(v.footprint, 20, 1e-6);
  EXPECT_EQ(v.left_out, 0);
}

TEST(Columns, NothingChangedIsNothing) {
  const Mesh part = make_part()->tessellate(1e-3);
  const Mesh ground = relief(40, 10, [](double x, double y) { return heap(x, y, 2) + 0.3 * x; });
  for (const Mesh& mesh : {part, ground}) {
    const VolumesBetween v = volumes_between(mesh, mesh, {.cell = 0.013}, Context(1));
    EXPECT_EQ(v.fill.value, 0);
    EXPECT_EQ(v.cut->value, 0);
    EXPECT_GT(v.footprint, 0);
    EXPECT_EQ(v.left_out, 0);
  }
}

TEST(Columns, FillMinusCutIsTheDifferenceOfTheVolumes) {
  Random random(1);
  for (int i = 0; i < 4; ++i) {
    const Mesh now = moved(make_part()->tessellate(1e-3), random_motion(random, 0.1));
    const Mesh before = moved(make_knot()->tessellate(1e-3), random_motion(random, 0.1));
    const VolumesBetween v = volumes_between(now, before, {.cell = 0.004}, Context(2));
    const double exact = now.volume() - before.volume();
    EXPECT_NEAR(v.net.value, v.fill.value - v.cut->value, 1e-12);
    EXPECT_NEAR(v.net.value, exact, 1e-3 * now.volume());
    EXPECT_LT(std::abs(v.net.value - exact), 20 * v.net.error + 1e-5);
    EXPECT_EQ(v.left_out, 0) << "each column enters as often as it leaves";
    const VolumesBetween back = volumes_between(before, now, {.cell = 0.004}, Context(1));
    EXPECT_EQ(back.fill.value, v.cut->value);
    EXPECT_EQ(back.cut->value, v.fill.value);
  }
}

TEST(Columns, EachColumnEntersAsOftenAsItLeavesEvenThroughVerticesAndEdges) {
  // Cells of 1 / 8: columns at odd sixteenths, on which vertices and edges lie.
  const Mesh sheet_like = box_mesh({0.0625, 0.0625, 0}, {2.0625, 2.0625, 1});
  Mesh steps = relief(32, 2, [](double x, double y) { return std::floor(4 * x) + y; });
  for (Vec3d& v : steps.vertices) v += Vec3d{0.0625, 0.0625, 0};
  const ColumnOptions options{.cell = 0.125, .window = Window{0, 0, 2.5, 2.5}};
  const VolumesBetween v = volumes_between(sheet_like, box_mesh({9, 9, 0}, {10, 10, 1}), options, Context(1));
  EXPECT_EQ(v.left_out, 0);
  EXPECT_EQ(v.footprint, 4);
  EXPECT_NEAR(v.fill.value, 4, 1e-9);
  const VolumesBetween twice = volumes_between(steps, steps, options, Context(1));
  EXPECT_EQ(twice.footprint, 4) << "no column falls between two triangles";
}

TEST(Columns, TheHeapThatWasTakenAwayAndTheOneThatWasAdded) {
  // Two heaps of different places: 4 pi times the height each, cut at the borders of the square.
  const auto ground = [](double x, double y) { return 0.2 * x - 0.1 * y; };
  const Mesh before = relief(200, 10, [&](double x, double y) { return ground(x, y) + heap(x + 2.5, y, 1); });
  const Mesh now = relief(190, 10, [&](double x, double y) { return ground(x, y) + heap(x - 2.5, y, 2); });
  const VolumesBetween v = volumes_between(now, before, {}, Context(2));
  const VolumeAtPlane exact_now = volume_at_plane(now, false, {{0, 0, -50}, {0, 0, 1}});
  const VolumeAtPlane exact_before = volume_at_plane(before, false, {{0, 0, -50}, {0, 0, 1}});
  EXPECT_NEAR(v.net.value, exact_now.above - exact_before.above, 1e-4);
  EXPECT_GT(v.fill.value, 20);
  EXPECT_GT(v.cut->value, 9);
  EXPECT_NEAR(v.footprint, 100, 1e-6);
  EXPECT_LT(v.net.error, 1e-2);
  // Finer columns are nearer, and their halves as well.
  const VolumesBetween coarse = volumes_between(now, before, {.cell = 0.37}, Context(2));
  EXPECT_LT(coarse.fill.error, 1);
  EXPECT_GT(coarse.fill.error, v.fill.error);
  EXPECT_NEAR(coarse.fill.value, v.fill.value, 5 * coarse.fill.error + 0.1);
}

TEST(Columns, ASolidOnASheetHasAVolumeAboveItAndNoCut) {
  const Mesh ground = relief(10, 10, [](double x, double) { return 0.5 * x; });
  const Mesh box = box_mesh({2, 2, 0}, {4, 5, 3});
  const VolumesBetween v = volumes_between(box, ground, {}, Context(1));
  EXPECT_NEAR(v.fill.value, 2 * 3 * (3 - 1.5), 1e-3);
  EXPECT_FALSE(v.cut);
  EXPECT_THROW(volumes_between(ground, box, {}, Context(1)), ParameterError);
}

TEST(Columns, ASheetIsTheSameWhicheverWayItLooks) {
  const Mesh now = relief(20, 10, [](double x, double y) { return heap(x, y, 2); });
  const Mesh before = relief(20, 10, [](double, double) { return 0.1; });
  const VolumesBetween up = volumes_between(now, before, {.cell = 0.1}, Context(1));
  const VolumesBetween down = volumes_between(flipped(now), flipped(before), {.cell = 0.1}, Context(1));
  EXPECT_GT(up.fill.value, 10);
  EXPECT_EQ(down.fill.value, up.fill.value);
  EXPECT_EQ(down.cut->value, up.cut->value);
}

TEST(Columns, WhereOneSheetHasAHoleNothingIsSaid) {
  const Mesh whole = relief(10, 10, [](double, double) { return 1; });
  Mesh holed = relief(10, 10, [](double, double) { return 0; });
  holed.triangles.erase(holed.triangles.begin() + 10, holed.triangles.begin() + 16);  // three of the squares
  const VolumesBetween v = volumes_between(whole, holed, {.cell = 0.125}, Context(1));
  EXPECT_NEAR(v.left_out, 3, 1e-9);
  EXPECT_NEAR(v.footprint, 97, 1e-9);
  EXPECT_NEAR(v.fill.value, 97, 1e-6);
}

TEST(Columns, AWindowCutsThem) {
  const Mesh now = box_mesh({0, 0, 0}, {4, 4, 2}), before = box_mesh({0, 0, 0}, {4, 4, 1});
  const VolumesBetween v = volumes_between(now, before, {.cell = 0.01, .window = Window{1, 2, 9, 3}}, Context(2));
  EXPECT_NEAR(v.fill.value, 3, 1e-6);
}

TEST(Columns, FarAwayAndWithAnyThreadsTheSame) {
  const auto height = [](double x, double y) { return heap(x, y, 2); };
  const Mesh now = relief(60, 10, height), before = relief(50, 10, [](double x, double) { return 0.05 * x; });
  const VolumesBetween one = volumes_between(now, before, {.cell = 0.03}, Context(1));
  const VolumesBetween many = volumes_between(now, before, {.cell = 0.03}, Context(3));
  EXPECT_EQ(one.fill.value, many.fill.value);
  EXPECT_EQ(one.cut->value, many.cut->value);
  Mesh far_now = now, far_before = before;
  for (Mesh* mesh : {&far_now, &far_before})
    for (Vec3d& v : mesh->vertices) v += Vec3d{500000, 4649000, 100};
  const VolumesBetween far = volumes_between(far_now, far_before, {.cell = 0.03}, Context(1));
  EXPECT_NEAR(far.fill.value, one.fill.value, 1e-3);
}

TEST(Columns, ACellThatIsTooSmallIsRefused) {
  const Mesh box = box_mesh({0, 0, 0}, {1, 1, 1});
  EXPECT_THROW(volumes_between(box, box, {.cell = 1e-6}, Context(1)), ParameterError);
  EXPECT_THROW(volumes_between(box, {}, {}, Context(1)), ParameterError);
}

}  // namespace TEST_FILE
}  // namespace soapfilm::test
