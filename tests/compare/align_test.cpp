#include "tools/compare/align.h"

#include <gtest/gtest.h>

#include "measure/solids.h"
#include "soapfilm/error.h"
#include "tools/mesh/sample_mesh.h"
#include "tools/scanner/shape.h"

namespace soapfilm::test {
namespace TEST_FILE {

class AlignPart : public testing::Test {
 protected:
  AlignPart() {
    for (const MeshPoint& p : sample_mesh(mesh, 4000, 1, Context(2))) points.push_back(p.position);
  }

  /// A turn of `degrees` about a random axis through the center and a shift, the inverse of which is to be found.
  static Motion small_motion(Random& random, double degrees, double shift) {
    const Vec3d axis = normalized(Vec3d{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)});
    const double angle = degrees / 180 * std::numbers::pi;
    Motion m;
    for (int k = 0; k < 3; ++k) {
      Vec3d unit;
      unit[k] = 1;
      m.axis[k] = unit * std::cos(angle) + cross(axis, unit) * std::sin(angle) +
                  axis * (dot(axis, unit) * (1 - std::cos(angle)));
    }
    m.shift = normalized(Vec3d{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)}) * shift;
    return m;
  }
  static std::vector<Vec3d> moved(const std::vector<Vec3d>& points, const Motion& m) {
    std::vector<Vec3d> out;
    for (const Vec3d& p : points) out.push_back(m.point(p));
    return out;
  }
  /// How far the motion found leaves the points from where they were.
  static double left_over(const std::vector<Vec3d>& points, const Motion& m, const RigidMotion& found) {
    double most = 0;
    for (const Vec3d& p : points) most = std::max(most, norm(found.point(m.point(p)) - p));
    return most;
  }

  Mesh mesh = make_part()->tessellate(1e-3);
  std::vector<Vec3d> points;
  SignedDistance model{mesh, Context(2)};
  Context context{2};
};

TEST_F(AlignPart, FindsASmallMotionAgain) {
  Random random(2);
  for (int i = 0; i < 5; ++i) {
    const Motion m = small_motion(random, 5, 0.05);
    const Alignment a = align(moved(points, m), model, context);
    EXPECT_TRUE(a.converged);
    EXPECT_LT(left_over(points, m, a.motion), 1e-6);
    EXPECT_NEAR(a.motion.angle_deg(), 5, 1e-5);
    EXPECT_GT(a.median_before, 0.005);
    EXPECT_LT(a.median_after, 1e-8);
    EXPECT_EQ(a.free_directions, 0);
  }
}

TEST_F(AlignPart, NoiseAveragesOut) {
  Random random(3);
  const Motion m = small_motion(random, 3, 0.03);
  std::vector<Vec3d> noisy = moved(points, m);
  constexpr double noise = 2e-3;
  for (Vec3d& p : noisy) p += Vec3d{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)} * noise;
  EXPECT_LT(left_over(points, m, align(noisy, model, context).motion), 3e-4);
}

TEST_F(AlignPart, APieceOfItIsEnoughAndATableDoesNotPull) {
  Random random(4);
  const Motion m = small_motion(random, 3, 0.03);
  std::vector<Vec3d> piece, with_table;
  for (const Vec3d& p : points)
    if (p.x + p.y < 0.05) piece.push_back(p);
  ASSERT_GT(piece.size(), 1000u);
  ASSERT_LT(piece.size(), 3000u);
  EXPECT_LT(left_over(points, m, align(moved(piece, m), model, context).motion), 1e-4);
  with_table = points;
  const double floor = mesh.box().lo.z - 0.08;
  for (int i = 0; i < 1000; ++i) with_table.push_back({random.uniform(-1, 1), random.uniform(-1, 1), floor});
  EXPECT_LT(left_over(points, m, align(moved(with_table, m), model, context).motion), 1e-4);
}

TEST_F(AlignPart, FarFromTheOriginAsNearIt) {
  Random random(5);
  const Vec3d far{500000, 4649000, 100};
  Mesh there = mesh;
  for (Vec3d& v : there.vertices) v += far;
  Motion m = small_motion(random, 2, 0.02);
  std::vector<Vec3d> shifted = moved(points, m), wanted = points;
  for (Vec3d& p : shifted) p += far;
  for (Vec3d& p : wanted) p += far;
  const Alignment a = align(shifted, SignedDistance(there, context), context);
  for (size_t i = 0; i < wanted.size(); i += 50) EXPECT_LT(norm(a.motion.point(shifted[i]) - wanted[i]), 1e-5);
}

TEST_F(AlignPart, TheSameForAnyNumberOfThreads) {
  Random random(6);
  const std::vector<Vec3d> from = moved(points, small_motion(random, 4, 0.04));
  const Alignment one = align(from, model, Context(1)), many = align(from, model, Context(3));
  EXPECT_EQ(one.motion.shift, many.motion.shift);
  EXPECT_EQ(one.motion.rows, many.motion.rows);
}

TEST_F(AlignPart, WhatSlidesStaysAndIsCounted) {
  // A plane slides along itself in two directions and turns about its normal.
  const Mesh sheet = relief(10, 10, [](double, double) { return 0; });
  std::vector<Vec3d> flat;
  for (const MeshPoint& p : sample_mesh(sheet, 500, 1, context)) flat.push_back(p.position * 0.5 + Vec3d{2, 2, 0.1});
  const Alignment a = align(flat, SignedDistance(sheet, context), context);
  EXPECT_EQ(a.free_directions, 3);
  EXPECT_NEAR(a.motion.shift.z, -0.1, 1e-9);
  EXPECT_NEAR(a.motion.shift.x, 0, 1e-9);
}

TEST_F(AlignPart, RefusesNonsense) {
  EXPECT_THROW(align({}, model, context), ParameterError);
  EXPECT_THROW(align(std::vector<Vec3d>(9, Vec3d{}), model, context), ParameterError);
  EXPECT_THROW(align(std::vector<Vec3d>(100, Vec3d{1, 2, 3}), model, context), ParameterError);
  std::vector<Vec3d> line, cloud;
  Random random(7);
  for (int i = 0; i < 100; ++i) line.push_back({0.1 * i, 0.2 * i, -0.3 * i});
  EXPECT_THROW(align(line, model, context), ParameterError);
  for (int i = 0; i < 500; ++i)
    cloud.push_back(Vec3d{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)} * 5.0);
  EXPECT_THROW(align(cloud, model, context), ParameterError) << "fits nowhere";
}

}  // namespace TEST_FILE
}  // namespace soapfilm::test
