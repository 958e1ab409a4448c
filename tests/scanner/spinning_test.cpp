// What the scanner does inside a scene: rings, ranges, ghosts, mixed pixels.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "soapfilm/error.h"
#include "tools/scanner/mesh_surface.h"
#include "tools/scanner/scene.h"
#include "tools/scanner/virtual_scan.h"

namespace soapfilm {
namespace TEST_FILE {

using std::numbers::pi;

MeshSurface surface_of(const Scene& scene) { return {scene.mesh, Context(1), Faces::as_given}; }

ScannerParams small(const Scene& scene) {
  ScannerParams params = scene.scanner;
  params.columns = 180;
  params.rows = 24;
  return params;
}

TEST(SpinningScanner, EachRowIsARingAndColumnsGoRoundToTheRight) {
  const Scene room = make_room();
  const MeshSurface surface = surface_of(room);
  ScannerParams params = small(room);
  params.rings_deg = {40, 10, -5, -30};
  const ScanSet set = virtual_scan(surface, params, Context(2));
  ASSERT_EQ(set.cloud.scans.size(), 2u);
  for (size_t k = 0; k < 2; ++k) {
    const Scan& scan = set.cloud.scans[k];
    ASSERT_EQ(scan.sensor, room.scanner.positions[k]);
    ASSERT_EQ(scan.range_grid->columns, 180);
    ASSERT_EQ(scan.range_grid->rows, 4);
    for (int row = 0; row < 4; ++row) {
      double first = 0;
      for (int column = 0; column < 180; ++column) {
        const int32_t s = scan.range_grid->sample[static_cast<size_t>(row) * 180 + column];
        if (s < 0) continue;  // door and window
        const Vec3d way = normalized(set.cloud.positions[scan.begin + s] - *scan.sensor);
        ASSERT_NEAR(std::asin(way.z) * 180 / pi, params.rings_deg[row], 1e-6);
        const double right = std::atan2(way.x, way.y) - 2 * pi * column / 180;  // all columns share one offset
        if (first == 0) first = right;
        ASSERT_NEAR(std::remainder(right - first, 2 * pi), 0, 1e-9);
      }
    }
  }
}

TEST(SpinningScanner, SweepsOfOnePlaceBeginTheirTurnsAnywhere) {
  const Scene room = make_room();
  ScannerParams params = small(room);
  params.positions = {{1.2, 1.0, 1.4}, {1.2, 1.0, 1.4}};
  const ScanSet set = virtual_scan(surface_of(room), params, Context(1));
  EXPECT_NE(set.cloud.positions[0], set.cloud.positions[set.cloud.scans[1].begin]);
}

TEST(SpinningScanner, TheSameForAnyNumberOfThreads) {
  const Scene street = make_street();
  ScannerParams params = small(street);
  params.ghosts = 0.1;
  params.mixed_pixels = 0.5;
  params.noise = 0.02;
  const MeshSurface surface = surface_of(street);
  const ScanSet one = virtual_scan(surface, params, Context(1)), three = virtual_scan(surface, params, Context(3));
  EXPECT_EQ(one.cloud.positions, three.cloud.positions);
}

TEST(SpinningScanner, RefusesRingsAndSpansThatAreNone) {
  const Scene room = make_room();
  const MeshSurface surface = surface_of(room);
  ScannerParams params = small(room);
  params.rings_deg = {91};
  EXPECT_THROW(virtual_scan(surface, params, Context(1)), ParameterError);
  params = small(room);
  params.lowest_deg = 10, params.highest_deg = -10;
  EXPECT_THROW(virtual_scan(surface, params, Context(1)), ParameterError);
  params = small(room);
  params.target = room.scanner.positions[0] + Vec3d{0, 0, -1};
  EXPECT_THROW(virtual_scan(surface, params, Context(1)), ParameterError);
}

TEST(MaxRange, HitsBeyondItAreLostAndOthersStay) {
  const Scene street = make_street();
  const MeshSurface surface = surface_of(street);
  ScannerParams params = small(street);
  const ScanSet all = virtual_scan(surface, params, Context(1));
  params.max_range = 20;
  const ScanSet near = virtual_scan(surface, params, Context(1));
  const auto within = [&](Vec3d p) { return norm(p - street.scanner.positions[0]) <= 20; };
  EXPECT_LT(near.cloud.size(), all.cloud.size());
  EXPECT_EQ(static_cast<ptrdiff_t>(near.cloud.size()),
            std::count_if(all.cloud.positions.begin(), all.cloud.positions.end(), within));
}

TEST(Ghosts, LieBehindTheSurfaceOnTheirRayAndLeaveTheOthersAsTheyWere) {
  const Scene yard = make_yard();
  const MeshSurface surface = surface_of(yard);
  ScannerParams params = small(yard);
  const ScanSet clean = virtual_scan(surface, params, Context(1));
  params.ghosts = 0.2;
  params.ghost_lo = 0.5, params.ghost_hi = 1.5;
  params.normals = true;
  const ScanSet set = virtual_scan(surface, params, Context(1));
  ASSERT_EQ(set.cloud.size(), clean.cloud.size());
  size_t ghosts = 0;
  for (size_t i = 0; i < set.cloud.size(); ++i) {
    const Vec3d p = set.cloud.positions[i], true_p = clean.cloud.positions[i];
    if (p == true_p) continue;
    ++ghosts;
    EXPECT_EQ(set.cloud.normals[i], Vec3f{});
    const Vec3d ray = normalized(true_p - yard.scanner.positions[0]);
    ASSERT_LT(norm(cross(p - true_p, ray)), 1e-9 * norm(p));
    const double behind = true_p.y > 12 - 1e-9 ? p.y - 12 : -p.z;
    ASSERT_GE(behind, 0.5 - 1e-9);
    ASSERT_LE(behind, 1.5 + 1e-9);
  }
  EXPECT_NEAR(static_cast<double>(ghosts), 0.2 * static_cast<double>(set.cloud.size()),
              4 * std::sqrt(0.16 * static_cast<double>(set.cloud.size())));
}

TEST(MixedPixels, LieOnTheirRayWithinTheRoomAtStepsInDepthOnly) {
  const Scene room = make_room();
  const MeshSurface surface = surface_of(room);
  ScannerParams params = small(room);
  params.columns = 360, params.rows = 120;
  params.positions.resize(1);
  const ScanSet clean = virtual_scan(surface, params, Context(1));
  params.mixed_pixels = 1;
  const ScanSet set = virtual_scan(surface, params, Context(1));
  ASSERT_EQ(set.cloud.size(), clean.cloud.size());
  size_t mixed = 0;
  for (size_t i = 0; i < set.cloud.size(); ++i) {
    const Vec3d p = set.cloud.positions[i], true_p = clean.cloud.positions[i];
    if (p == true_p) continue;
    ++mixed;
    ASSERT_LT(norm(cross(p - true_p, normalized(true_p - params.positions[0]))), 1e-9);
    for (int axis = 0; axis < 3; ++axis) {
      ASSERT_GT(p[axis], -1e-9);
      ASSERT_LT(p[axis], surface.box().hi[axis] + 1e-9);
    }
  }
  EXPECT_GT(mixed, 40u);
  EXPECT_LT(mixed, set.cloud.size() / 10);

  const Scene yard = make_yard();  // a plane has no steps, however small the angle at which it is seen
  ScannerParams plane = small(yard);
  plane.max_incidence_deg = 80;
  plane.highest_deg = -10;
  const ScanSet flat = virtual_scan(surface_of(yard), plane, Context(1));
  plane.mixed_pixels = 1;
  EXPECT_EQ(virtual_scan(surface_of(yard), plane, Context(1)).cloud.positions, flat.cloud.positions);
}

}  // namespace TEST_FILE
}  // namespace soapfilm
