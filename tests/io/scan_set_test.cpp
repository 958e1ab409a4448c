// Stanford scan sets: conventions on scans made here, and on the real bunny when SOAPFILM_DATA names the data.
#include <nanoflann.hpp>

#include "files.h"
#include "samples.h"
#include "soapfilm/io.h"
#include "soapfilm/io/sets/scan_set.h"
#include "soapfilm/io/summary.h"
#include "support/real_data.h"

namespace soapfilm {
namespace TEST_FILE {

const double half = std::sqrt(0.5);

TEST(ScanPose, RotatesByTheTransposeOfTheTextbookMatrix) {
  ScanPose pose;
  pose.quaternion = {0, 0, half, half};  // textbook: +90 degrees about z, x to y; here y to x
  EXPECT_LT(norm(pose.rotate({0, 1, 0}) - Vec3d{1, 0, 0}), 1e-15);
  EXPECT_LT(norm(pose.rotate({1, 0, 0}) - Vec3d{0, -1, 0}), 1e-15);
  pose.translation = {10, 20, 30};
  EXPECT_LT(norm(pose.apply({0, 1, 5}) - Vec3d{11, 20, 35}), 1e-14);

  // The textbook matrix of an arbitrary quaternion, transposed.
  const double x = 0.1, y = -0.5, z = 0.7, w = std::sqrt(1 - x * x - y * y - z * z);
  pose.quaternion = {x, y, z, w};
  const Vec3d first_row{1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)};
  EXPECT_LT(norm(pose.rotate({1, 0, 0}) - first_row), 1e-15);
}

TEST(ScanSet, PosesMoveAllThatAScanHas) {
  const TemporaryFolder folder;
  const PointCloud cloud = rich_cloud(2, 4, 3, 21);
  write_points(folder / "two scans.ply", cloud);
  const std::string bare =
      "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
      "property float z\nend_header\n0 1 0\n";
  folder.write("bare.ply", bare);
  folder.write("sensor.ply", std::string(bare).insert(4, "comment sensor 0 0 9\n"));
  folder.write("set.conf",
               "camera 0 0 0 0 0 0 1\n# a comment\n\nbmesh two scans.ply 1 2 3 0 0 0.70710678 0.70710678\r\n"
               "mesh ignored.ply\nbmesh bare.ply 0 0 0 0.70710678 0 0 0.70710678\nbmesh sensor.ply 1 0 0 0 0 0 1\n"
               "bgcolor 1 1 1\n");
  ReadReport report;
  const PointCloud posed = read_points(folder / "set.conf", &report);
  ASSERT_EQ(posed.scans.size(), 4u);
  EXPECT_EQ(report.files.size(), 3u);
  ASSERT_EQ(report.warnings.size(), 1u);
  EXPECT_NE(report.warnings[0].find("set.conf:8"), std::string::npos);
  EXPECT_NE(report.warnings[0].find("'bgcolor'"), std::string::npos);

  const auto rotated = [](Vec3d v) { return Vec3d{v.y, -v.x, v.z}; };
  for (size_t i = 0; i < cloud.size(); ++i) {
    EXPECT_LT(norm(posed.positions[i] - (rotated(cloud.positions[i]) + Vec3d{1, 2, 3})), 1e-8);
    EXPECT_LT(norm(posed.sensors[i] - (rotated(cloud.sensors[i]) + Vec3d{1, 2, 3})), 1e-8);
    const Vec3d normal = rotated(static_cast<Vec3d>(cloud.normals[i]));
    EXPECT_LT(norm(static_cast<Vec3d>(posed.normals[i]) - normal), 1e-6 * (1 + norm(normal)));
  }
  EXPECT_LT(norm(*posed.scans[0].sensor - (rotated(*cloud.scans[0].sensor) + Vec3d{1, 2, 3})), 1e-8);
  EXPECT_FALSE(posed.scans[0].view_direction);  // it has sensor positions
  EXPECT_LT(norm(*posed.scans[1].view_direction - rotated(*cloud.scans[1].view_direction)), 1e-8);

  // Without a position or direction of its own a scan was seen along local +Z: here 90 degrees about x, transposed.
  ASSERT_TRUE(posed.scans[2].view_direction);
  EXPECT_LT(norm(*posed.scans[2].view_direction - Vec3d{0, 1, 0}), 1e-8);
  EXPECT_LT(norm(posed.positions[posed.scans[2].begin] - Vec3d{0, 0, -1}), 1e-8);
  EXPECT_EQ(posed.scans[3].sensor, (Vec3d{1, 0, 9}));
  EXPECT_FALSE(posed.scans[3].view_direction);
}

TEST(ScanSet, WrittenEntriesComeBack) {
  const TemporaryFolder folder;
  const double w = std::sqrt(1 - 0.14);
  std::vector<ScanSetEntry> entries{{"a b.ply", {{1, -2.5, 1e-9}, {0.1, 0.2, 0.3, w}}}, {"c.ply", {}}};
  write_scan_set(folder / "set.conf", entries);
  const std::vector<ScanSetEntry> read = read_scan_set(folder / "set.conf");
  ASSERT_EQ(read.size(), 2u);
  EXPECT_EQ(read[0].file, "a b.ply");
  EXPECT_EQ(read[0].pose.translation, entries[0].pose.translation);
  for (size_t i = 0; i < 4; ++i) EXPECT_NEAR(read[0].pose.quaternion[i], entries[0].pose.quaternion[i], 1e-15);
  EXPECT_EQ(read[1].pose.quaternion, entries[1].pose.quaternion);
}

TEST(Spacing, IsTheSideOfASamplesShareOfTheSurface) {
  PointCloud grid;
  for (int i = 0; i < 60; ++i)
    for (int j = 0; j < 60; ++j) grid.positions.push_back({5e6 + 0.01 * i, 0.01 * j, 7});
  EXPECT_NEAR(sample_spacing(grid), 0.01, 0.0015);
  PointCloud scattered;
  Random random(3);
  for (int i = 0; i < 3600; ++i) scattered.positions.push_back({random.uniform(0, 0.6), random.uniform(0, 0.6), 7});
  EXPECT_NEAR(sample_spacing(scattered), 0.01, 0.0015);
  PointCloud same;
  same.positions.assign(50, {1, 2, 3});
  EXPECT_EQ(sample_spacing(same), 0);
  same.positions.resize(1);
  EXPECT_EQ(sample_spacing(same), 0);
  EXPECT_EQ(sample_spacing({}), 0);
}

/// Brute force would take minutes: nearest positions by a tree.
struct Positions {
  std::vector<Vec3d> points;
  size_t kdtree_get_point_count() const { return points.size(); }
  double kdtree_get_pt(size_t i, size_t axis) const { return points[i][static_cast<int>(axis)]; }
  template <class Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};
using Tree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, Positions>, Positions, 3, size_t>;

std::pair<size_t, double> nearest(const Tree& tree, Vec3d p) {
  size_t index = 0;
  double squared = 0;
  tree.knnSearch(&p.x, 1, &index, &squared);
  return {index, std::sqrt(squared)};
}

class Bunny : public testing::Test {
 protected:
  void SetUp() override {
    const auto scans = real_data("bunny/bun.conf"), zippered = real_data("bunny/bun_zipper.ply");
    if (!scans || !zippered) GTEST_SKIP() << "no bunny in SOAPFILM_DATA";
    scans_ = *scans;
    zippered_ = *zippered;
  }
  std::string scans_, zippered_;
};

TEST_F(Bunny, ScansCoincideOncePosed) {
  const PointCloud cloud = read_points(scans_);
  EXPECT_EQ(cloud.size(), 362272u);
  ASSERT_EQ(cloud.scans.size(), 10u);
  for (const Scan& scan : cloud.scans) {
    ASSERT_TRUE(scan.range_grid);
    EXPECT_EQ(scan.range_grid->columns, 512);
    EXPECT_EQ(scan.range_grid->rows, 400);
    Positions others;
    for (size_t i = 0; i < cloud.size(); ++i)
      if (i < scan.begin || i >= scan.end) others.points.push_back(cloud.positions[i]);
    const Tree tree(3, others, nanoflann::KDTreeSingleIndexAdaptorParams(16));
    std::vector<double> distances;
    for (size_t i = scan.begin; i < scan.end; i += 40) distances.push_back(nearest(tree, cloud.positions[i]).second);
    std::nth_element(distances.begin(), distances.begin() + static_cast<long>(distances.size() / 2), distances.end());
    EXPECT_LT(distances[distances.size() / 2], 0.0005) << scan.name;
  }
}

TEST_F(Bunny, ViewingDirectionsPointOutOfTheSurface) {
  const PointCloud cloud = read_points(scans_);
  const Mesh mesh = read_mesh(zippered_);
  std::vector<Vec3d> normals(mesh.vertices.size());
  for (const Triangle& t : mesh.triangles) {
    const Vec3d a = mesh.vertices[t[0]];
    const Vec3d n = cross(mesh.vertices[t[1]] - a, mesh.vertices[t[2]] - a);
    for (const uint32_t v : t) normals[v] += n;
  }
  const Positions vertices{mesh.vertices};
  const Tree tree(3, vertices, nanoflann::KDTreeSingleIndexAdaptorParams(16));
  size_t near = 0;
  size_t outward = 0;
  for (const Scan& scan : cloud.scans)
    for (size_t i = scan.begin; i < scan.end; i += 10) {
      const auto [vertex, distance] = nearest(tree, cloud.positions[i]);
      if (distance > 0.001 || normals[vertex] == Vec3d{}) continue;  // some vertices have no triangle
      ++near;
      outward += dot(normals[vertex], *scan.view_direction) > 0;
    }
  const double share = static_cast<double>(outward) / static_cast<double>(near);
  RecordProperty("outward_share", std::to_string(share));
  EXPECT_GT(near, 30000u);
  EXPECT_GT(share, 0.99);
}

}  // namespace TEST_FILE
}  // namespace soapfilm
