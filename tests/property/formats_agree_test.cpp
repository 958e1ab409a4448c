// The same scans in every format of scanners: the same mesh, and their colors on its vertices.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "io/e57_writer.h"
#include "io/files.h"
#include "io/laz_files.h"
#include "io/pcd_files.h"
#include "soapfilm/core/vec.h"
#include "soapfilm/io.h"
#include "soapfilm/reconstruct.h"
#include "support/hash.h"
#include "support/sanitized.h"
#include "tools/scanner/shape.h"
#include "tools/scanner/virtual_scan.h"

namespace soapfilm {
namespace TEST_FILE {

using namespace test;

constexpr double step = 1.0 / (1 << 20);  // of all coordinates: every format keeps them, sums with a pose are exact

double quantized(double v) { return std::round(v / step) * step; }
Vec3d quantized(Vec3d p) { return {quantized(p.x), quantized(p.y), quantized(p.z)}; }

/// A smooth pattern.
Rgb8 color_at(Vec3d p) {
  const auto wave = [](double v) { return static_cast<uint8_t>(std::lround(128 + 100 * std::sin(3 * v))); };
  return {wave(p.x), wave(p.y + 1), wave(p.z + p.x)};
}

/// Scans of a part from all around.
PointCloud part_scans() {
  ScannerParams scanner;
  scanner.views = 6;
  scanner.columns = scanner.rows = sanitized ? 40 : 80;
  PointCloud cloud = virtual_scan(*make_part(), scanner, Context(1)).cloud;
  for (Vec3d& p : cloud.positions) p = quantized(p);
  for (Scan& scan : cloud.scans) scan.sensor = quantized(*scan.sensor);
  cloud.normals.clear();
  for (const Vec3d& p : cloud.positions) cloud.colors.push_back(color_at(p));
  return cloud;
}

/// Column by column, cells without a return as zeros.
std::string ptx_of(const PointCloud& cloud) {
  std::string text;
  for (const Scan& scan : cloud.scans) {
    const RangeGrid& grid = *scan.range_grid;
    const Vec3d& s = *scan.sensor;
    text += fmt::format("{}\n{}\n{} {} {}\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n{} {} {} 1\n", grid.columns,
                        grid.rows, s.x, s.y, s.z, s.x, s.y, s.z);
    for (int column = 0; column < grid.columns; ++column)
      for (int row = 0; row < grid.rows; ++row) {
        const int32_t sample = grid.sample[static_cast<size_t>(row * grid.columns + column)];
        if (sample < 0) {
          text += "0 0 0 0.5 0 0 0\n";
          continue;
        }
        const size_t i = scan.begin + static_cast<size_t>(sample);
        const Vec3d p = cloud.positions[i] - s;
        const Rgb8& c = cloud.colors[i];
        text += fmt::format("{} {} {} 0.5 {} {} {}\n", p.x, p.y, p.z, c[0], c[1], c[2]);
      }
  }
  return text;
}

std::string e57_of(const PointCloud& cloud) {
  std::vector<E57TestScan> scans;
  for (const Scan& scan : cloud.scans) {
    const Vec3d& s = *scan.sensor;
    std::vector<double> at[3];
    std::vector<int64_t> color[3];
    for (size_t i = scan.begin; i < scan.end; ++i)
      for (int k = 0; k < 3; ++k) {
        at[k].push_back(cloud.positions[i][k] - s[k]);
        color[k].push_back(cloud.colors[i][static_cast<size_t>(k)]);
      }
    scans.push_back({{doubles("cartesianX", at[0]), doubles("cartesianY", at[1]), doubles("cartesianZ", at[2]),
                      integers("colorRed", color[0], 0, 255), integers("colorGreen", color[1], 0, 255),
                      integers("colorBlue", color[2], 0, 255)},
                     pose_xml("1 0 0 0", fmt::format("{} {} {}", s.x, s.y, s.z))});
  }
  return E57Writer::file(scans);
}

std::string pcd_of(const PointCloud& cloud, const Scan& scan, PcdCoding coding) {
  PcdFile file;
  file.fields = {{"x", "F", 8}, {"y", "F", 8}, {"z", "F", 8}, {"rgb", "U", 4}};
  const Vec3d& s = *scan.sensor;
  file.viewpoint = fmt::format("VIEWPOINT {} {} {} 1 0 0 0\n", s.x, s.y, s.z);
  for (size_t i = scan.begin; i < scan.end; ++i) {
    const Vec3d& p = cloud.positions[i];
    const Rgb8& c = cloud.colors[i];
    file.rows.push_back({p.x, p.y, p.z, static_cast<double>(c[0] << 16 | c[1] << 8 | c[2])});
  }
  return file.text(coding);
}

/// At the time `scan` of a trajectory.
std::string las_of(const PointCloud& cloud, size_t scan) {
  LasFile file;
  file.format = 3;
  file.scale = {step, step, step};
  file.offset = {};
  for (size_t i = cloud.scans[scan].begin; i < cloud.scans[scan].end; ++i) {
    LasPoint point;
    for (int k = 0; k < 3; ++k) {
      point.xyz[static_cast<size_t>(k)] = static_cast<int32_t>(std::lround(cloud.positions[i][k] / step));
      point.rgb[static_cast<size_t>(k)] = static_cast<uint16_t>(257 * cloud.colors[i][static_cast<size_t>(k)]);
    }
    point.time = static_cast<double>(scan);
    file.points.push_back(point);
  }
  return file.bytes();
}

struct FormatsAgree : testing::Test {
  void SetUp() override {
    folder.write("scans.ptx", ptx_of(part_scans()));
    cloud = read_points(folder / "scans.ptx");
    params.place.resolution = sanitized ? 40 : 64;
    truth = reconstruct(cloud, params, Context(2)).mesh;
  }
  void expect_same(const PointCloud& other, const std::string& format) const {
    ASSERT_EQ(other.positions, cloud.positions) << format;
    ASSERT_EQ(other.colors, cloud.colors) << format;
    const Mesh mesh = reconstruct(other, params, Context(2)).mesh;
    EXPECT_EQ(hash_mesh(mesh), hash_mesh(truth)) << format;
    EXPECT_EQ(mesh.colors, truth.colors) << format;
  }
  std::vector<std::string> each_scan(const char* extension,
                                     const std::function<std::string(size_t scan)>& bytes) const {
    std::vector<std::string> files;
    for (size_t k = 0; k < cloud.scans.size(); ++k)
      files.push_back(folder.write(fmt::format("{}{}", k, extension), bytes(k)));
    return files;
  }

  const TemporaryFolder folder;
  PointCloud cloud;
  ReconstructParams params;
  Mesh truth;
};

TEST_F(FormatsAgree, OnMeshAndColors) {
  ASSERT_EQ(cloud.scans.size(), 6u);
  write_points(folder / "scans.ply", cloud);
  expect_same(read_points(folder / "scans.ply"), "PLY");
  expect_same(read_points(folder.write("scans.e57", e57_of(cloud))), "E57");
  for (const PcdCoding coding : {PcdCoding::ascii, PcdCoding::binary, PcdCoding::compressed})
    expect_same(read_points(each_scan(".pcd", [&](size_t k) { return pcd_of(cloud, cloud.scans[k], coding); })),
                fmt::format("PCD {}", static_cast<int>(coding)));
  std::string trajectory;
  for (size_t k = 0; k < cloud.scans.size(); ++k) {
    const Vec3d& s = *cloud.scans[k].sensor;
    trajectory += fmt::format("{} {} {} {}\n", k, s.x, s.y, s.z);
  }
  ReadOptions options;
  options.trajectory = folder.write("trajectory.txt", trajectory);
  expect_same(read_points(each_scan(".las", [&](size_t k) { return las_of(cloud, k); }), nullptr, Context(1), options),
              "LAS");
  expect_same(read_points(each_scan(".laz", [&](size_t k) { return laz_of(las_of(cloud, k), {.chunk_points = 1000}); }),
                          nullptr, Context(2), options),
              "LAZ");
}

TEST_F(FormatsAgree, AndColorsOfVerticesAreThoseOfTheirPlaces) {
  ASSERT_EQ(truth.colors.size(), truth.vertices.size());
  double sum = 0;
  for (size_t v = 0; v < truth.vertices.size(); ++v)
    for (size_t k = 0; k < 3; ++k) sum += std::abs(truth.colors[v][k] - color_at(truth.vertices[v])[k]);
  EXPECT_LT(sum / (3.0 * static_cast<double>(truth.vertices.size())), 8);
}

}  // namespace TEST_FILE
}  // namespace soapfilm
