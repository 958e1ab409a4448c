#include "soapfilm/io/point_stream.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "e57_writer.h"
#include "files.h"
#include "las_files.h"
#include "laz_files.h"
#include "npy_files.h"
#include "pcd_files.h"
#include "samples.h"
#include "soapfilm/io/formats.h"
#include "soapfilm/io/summary.h"
#include "support/real_data.h"

namespace soapfilm {
namespace TEST_FILE {

using test::E57TestScan;
using test::E57Writer;
using test::floats;
using test::integers;
using test::line_scan;
using test::pose_xml;

/// Passes blocks on, and looks at their sizes and columns.
class Watched : public io::CloudSink {
 public:
  using CloudSink::CloudSink;

  void take(io::PointBlock&& block) override {
    EXPECT_GT(block.size(), 0u);
    EXPECT_LE(block.size(), block_samples());
    EXPECT_TRUE(block.samples.scans.empty());
    largest = std::max(largest, block.size());
    ++blocks;
    CloudSink::take(std::move(block));
  }

  size_t largest = 0, blocks = 0;
};

void expect_same_report(const ReadReport& a, const ReadReport& b) {
  EXPECT_EQ(a.warnings, b.warnings);
  ASSERT_EQ(a.files.size(), b.files.size());
  for (size_t i = 0; i < a.files.size(); ++i) {
    EXPECT_EQ(a.files[i].format, b.files[i].format);
    EXPECT_EQ(a.files[i].samples, b.files[i].samples);
    EXPECT_EQ(a.files[i].dropped, b.files[i].dropped);
    EXPECT_EQ(a.files[i].no_return, b.files[i].no_return);
    EXPECT_EQ(a.files[i].ignored_normals, b.files[i].ignored_normals);
    EXPECT_EQ(a.files[i].properties, b.files[i].properties);
  }
}

/// Not-a-number equals itself.
template <class T>
void expect_same_bits(const std::vector<T>& a, const std::vector<T>& b) {
  ASSERT_EQ(a.size(), b.size());
  EXPECT_TRUE(a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

void expect_identical(const PointCloud& a, const PointCloud& b) {
  expect_same_bits(a.positions, b.positions);
  expect_same_bits(a.normals, b.normals);
  expect_same_bits(a.sensors, b.sensors);
  expect_same_bits(a.weights, b.weights);
  EXPECT_EQ(a.colors, b.colors);
  ASSERT_EQ(a.columns.size(), b.columns.size());
  for (size_t c = 0; c < a.columns.size(); ++c) {
    EXPECT_EQ(a.columns[c].name, b.columns[c].name);
    EXPECT_EQ(a.columns[c].is_label, b.columns[c].is_label);
    expect_same_bits(a.columns[c].values, b.columns[c].values);
  }
  ASSERT_NO_FATAL_FAILURE(expect_same_scans(a, b));
  for (size_t s = 0; s < a.scans.size(); ++s) EXPECT_EQ(a.scans[s].view_direction, b.scans[s].view_direction);
  EXPECT_EQ(a.coordinate_system, b.coordinate_system);
  EXPECT_EQ(a.is_survey, b.is_survey);
}

/// What is counted of the samples is what the cloud says.
void expect_summary(const CloudSummary& summary, const PointCloud& cloud) {
  EXPECT_EQ(summary.samples, cloud.size());
  EXPECT_EQ(summary.box.lo, cloud.box().lo);
  EXPECT_EQ(summary.box.hi, cloud.box().hi);
  EXPECT_EQ(summary.spacing, sample_spacing(cloud));
  EXPECT_EQ(summary.normals, static_cast<size_t>(std::count_if(cloud.normals.begin(), cloud.normals.end(),
                                                               [](const Vec3f& n) { return !(n == Vec3f{}); })));
  EXPECT_EQ(summary.sensors, static_cast<size_t>(std::count_if(cloud.sensors.begin(), cloud.sensors.end(),
                                                               [](const Vec3d& s) { return is_finite(s); })));
  EXPECT_EQ(summary.weights, !cloud.weights.empty());
  EXPECT_EQ(summary.colors, !cloud.colors.empty());
  ASSERT_EQ(summary.columns.size(), cloud.columns.size());
  for (size_t c = 0; c < cloud.columns.size(); ++c) EXPECT_EQ(summary.columns[c], cloud.columns[c].name);
  ASSERT_EQ(summary.scans.size(), cloud.scans.size());
  for (size_t s = 0; s < cloud.scans.size(); ++s) {
    EXPECT_EQ(summary.scans[s].name, cloud.scans[s].name);
    EXPECT_EQ(summary.scans[s].samples, cloud.scans[s].size());
    EXPECT_EQ(summary.scans[s].grid.has_value(), cloud.scans[s].range_grid.has_value());
  }
  EXPECT_EQ(summary.coordinate_system, cloud.coordinate_system);
}

/// The cloud, from blocks of any size.
PointCloud expect_blocks(const std::string& path, bool in_blocks, const ReadOptions& options = {}) {
  SCOPED_TRACE(path);
  ReadReport report;
  PointCloud cloud = read_points(path, &report, Context(1), options);
  for (const size_t most : {size_t{1}, size_t{7}, size_t{1} << 16}) {
    for (const int threads : {1, 3}) {
      SCOPED_TRACE(fmt::format("blocks of {}, {} threads", most, threads));
      Watched sink(most);
      ReadReport other;
      stream_points(path, sink, other, options, Context(threads));
      expect_identical(sink.cloud(), cloud);
      expect_same_report(other, report);
      EXPECT_EQ(sink.largest, most < cloud.size() ? most : sink.largest);
    }
  }
  SummarySink sink;
  ReadReport other;
  stream_points(path, sink, other, options, Context(1));
  expect_summary(sink.summary(), cloud);
  const io::Format* format = io::format_of(io::ByteSource(path));
  EXPECT_EQ(format->stream_points != nullptr, in_blocks);
  return cloud;
}

/// Rows of x y z and `more` columns; some at (0, 0, 0), some without coordinates.
std::vector<std::vector<double>> rows_of(size_t count, size_t more, uint64_t seed) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  Random random(seed);
  std::vector<std::vector<double>> rows;
  for (size_t i = 0; i < count; ++i) {
    std::vector<double> row;
    for (size_t k = 0; k < 3; ++k) row.push_back(i % 11 == 3 ? 0 : i % 17 == 5 && k == 1 ? nan : random.uniform(1, 9));
    for (size_t k = 0; k < more; ++k) row.push_back(std::floor(random.uniform(0, 200)));
    rows.push_back(std::move(row));
  }
  return rows;
}

std::string text_of(const std::vector<std::vector<double>>& rows, const std::string& head = {}) {
  std::string text = head;
  for (const std::vector<double>& row : rows) text += fmt::format("{}\n", fmt::join(row, " "));
  return text;
}

TEST(PointStream, PlyInBlocksIsTheCloud) {
  const TemporaryFolder folder;
  for (const bool ascii : {false, true}) {
    WriteOptions as;
    as.ascii = ascii;
    PointCloud cloud = rich_cloud(3, 12, 9, 1, {10, 20, 30});
    const std::string grids = folder / fmt::format("grids{}.ply", ascii);
    write_points(grids, cloud, as);
    expect_blocks(grids, true);
    for (Scan& scan : cloud.scans) scan.range_grid.reset();
    const std::string scans = folder / fmt::format("scans{}.ply", ascii);
    write_points(scans, cloud, as);
    EXPECT_EQ(expect_blocks(scans, true).scans.size(), 3u);
  }
  // Colors whose range the last row tells; zeros and cells without coordinates in the middle.
  std::vector<std::vector<double>> rows = rows_of(300, 4, 2);
  rows.back()[3] = 40000;
  const std::string head = fmt::format(
      "ply\nformat ascii 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\n"
      "property ushort red\nproperty ushort green\nproperty ushort blue\nproperty float heat\nend_header\n",
      rows.size());
  const PointCloud cloud = expect_blocks(folder.write("colors.ply", text_of(rows, head)), true);
  EXPECT_LT(cloud.size(), rows.size());
  EXPECT_EQ(cloud.colors[0][0], std::lround(rows[0][3] / 257));
  // Normals of faces: only at its end does the file tell them.
  std::string mesh =
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 4\nproperty list uchar int vertex_indices\nend_header\n"
      "0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";
  EXPECT_EQ(expect_blocks(folder.write("mesh.ply", mesh), true).normals.size(), 4u);
}

TEST(PointStream, TextInBlocksIsTheCloud) {
  const TemporaryFolder folder;
  expect_blocks(folder.write("a.xyz", text_of(rows_of(500, 0, 1))), true);
  expect_blocks(folder.write("unnamed.xyz", text_of(rows_of(500, 4, 2))), true);
  std::vector<std::vector<double>> rows = rows_of(500, 4, 3);
  rows.back()[5] = 255;
  std::string text = text_of(rows, "x y z red green blue heat name\n");
  for (size_t at = text.find('\n') + 1; (at = text.find('\n', at)) != std::string::npos; at += 6)
    text.insert(at, " wall");
  const PointCloud cloud = expect_blocks(folder.write("named.xyz", text), true);
  EXPECT_EQ(cloud.columns.size(), 1u);  // not the names
  expect_blocks(folder.write("halves.pwn", "3\n1 2 3\n4 5 6\n7 8 9\n1 0 0\n0 1 0\n0 0 1\n"), true);
  expect_blocks(folder.write("counts.pts", "3\n1 2 3\n4 5 6\n7 8 9\n2\n1 0 0\n0 1 0\n"), true);
  std::string cells = "x y z row column\n";
  for (int i = 0; i < 60; ++i)
    cells += fmt::format("{} {} {} {} {}\n", i % 10, 0.1 * (i / 10), 2 + i % 3, i / 10, i % 10);
  EXPECT_TRUE(expect_blocks(folder.write("cells.xyz", cells), true).scans[0].range_grid);
}

TEST(PointStream, PcdInBlocksIsTheCloud) {
  const TemporaryFolder folder;
  PcdFile pcd;
  pcd.fields = {{"x"}, {"y"}, {"z"}, {"r", "U", 1}, {"g", "U", 1}, {"b", "U", 1}, {"weight"}, {"heat"}};
  pcd.rows = rows_of(300, 5, 4);
  for (const PcdCoding coding : {PcdCoding::ascii, PcdCoding::binary, PcdCoding::compressed})
    expect_blocks(folder.write("a.pcd", pcd.text(coding)), true);
  pcd.width = 30;
  pcd.height = 10;
  for (std::vector<double>& row : pcd.rows)
    if (std::isnan(row[1])) row[0] = row[2] = row[1];
  for (const PcdCoding coding : {PcdCoding::ascii, PcdCoding::binary, PcdCoding::compressed})
    EXPECT_TRUE(expect_blocks(folder.write("a.pcd", pcd.text(coding)), true).scans[0].range_grid);
}

std::vector<LasPoint> las_points(size_t count) {
  Random random(5);
  std::vector<LasPoint> points(count);
  for (size_t i = 0; i < count; ++i) {
    LasPoint& point = points[i];
    for (int32_t& v : point.xyz) v = static_cast<int32_t>(random.uniform(0, 9000));
    point.withheld = i % 13 == 4;
    point.source = static_cast<uint16_t>(7 + i / 1500);
    point.time = static_cast<double>(i);
    if (i > count / 2) point.intensity = static_cast<uint16_t>(i);  // zeros before
    if (i + 1 == count) point.rgb = {300, 2, 70};                   // and only here do colors begin
  }
  return points;
}

TEST(PointStream, LasAndLazInBlocksAreTheCloud) {
  const TemporaryFolder folder;
  LasFile las;
  las.format = 3;
  las.points = las_points(4500);
  const PointCloud cloud = expect_blocks(folder.write("a.las", las.bytes()), true);
  EXPECT_EQ(cloud.scans.size(), 3u);
  EXPECT_EQ(cloud.colors.back(), (Rgb8{1, 0, 0}));
  expect_identical(expect_blocks(folder.write("a.laz", laz_of(las.bytes())), true), cloud);
  std::string way = "0 0 0 100\n4500 10 0 100\n";
  ReadOptions options;
  options.trajectory = folder.write("way.txt", way);
  EXPECT_EQ(expect_blocks(folder / "a.las", true, options).sensors.size(), cloud.size());
}

TEST(PointStream, E57InBlocksIsTheCloud) {
  const TemporaryFolder folder;
  std::vector<double> x{0, 0}, heat;
  for (int i = 0; i < 400; ++i) heat.push_back(i);
  E57TestScan plain = line_scan(400, {floats("heat", heat)}, pose_xml("0 1 0 0", "3 4 5"));
  plain.fields[0].floats.assign(2, 0.0);
  plain.fields[0].floats.resize(400, 2.5);
  const E57TestScan other = line_scan(50);
  EXPECT_EQ(expect_blocks(folder.write("a.e57", E57Writer::file({plain, other, plain})), true).scans.size(), 3u);
}

TEST(PointStream, ArraysAndSweepsInBlocksAreTheCloud) {
  const TemporaryFolder folder;
  const auto file = [&](size_t columns, bool image) {
    std::string data;
    for (const std::vector<double>& row : rows_of(240, columns - 3, columns))
      for (const double v : row) data += bytes_of(static_cast<float>(v));
    const std::string shape = image ? fmt::format("(12, 20, {})", columns) : fmt::format("(240, {})", columns);
    return npy(npy_literal("'<f4'", shape), data);
  };
  for (const size_t columns : {3, 4, 6, 7})
    for (const bool image : {false, true}) expect_blocks(folder.write("a.npy", file(columns, image)), true);
  std::string sweep;
  for (const std::vector<double>& row : rows_of(240, 1, 9))
    for (const double v : row) sweep += bytes_of(std::isnan(v) ? 0.5f : static_cast<float>(v));
  expect_blocks(folder.write("a.bin", sweep), true);
}

/// Formats that are read whole hand their cloud over in blocks, too.
TEST(PointStream, WholeFormatsComeInBlocks) {
  const TemporaryFolder folder;
  std::string obj;
  for (int i = 0; i < 50; ++i) obj += fmt::format("v {} {} {}\n", i, i % 7, i % 5);
  expect_blocks(folder.write("a.obj", obj), false);
  std::string off = "OFF\n50 0 0\n";
  for (int i = 0; i < 50; ++i) off += fmt::format("{} {} {}\n", i, i % 7, i % 5);
  expect_blocks(folder.write("a.off", off), false);
  folder.write("a.xyz", text_of(rows_of(60, 0, 1)));
  expect_blocks(folder.write("a.conf", "bmesh a.xyz 0 0 1 0 0 0 1\nbmesh a.xyz 5 0 1 0 0 0 1\n"), false);
  std::string ptx = "10\n6\n1 2 3\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n1 2 3 1\n";
  for (int i = 0; i < 60; ++i)
    ptx += fmt::format("{} {} {} 0.5\n", i % 7 == 0 ? 0 : 1 + i % 10, 0.1 * (i / 10), i % 7 == 0 ? 0 : 1);
  expect_blocks(folder.write("a.ptx", ptx), false);
}

TEST(PointStream, FilesOfAFolderAddUp) {
  const TemporaryFolder folder;
  folder.write("b.xyz", text_of(rows_of(60, 0, 1)));
  folder.write("a.xyz", text_of(rows_of(70, 1, 2), "x y z heat\n"));
  const PointCloud cloud = read_points(folder / "");
  SummarySink sink;
  ReadReport report;
  stream_points(folder / "", sink, report, {}, Context(1));
  expect_summary(sink.summary(), cloud);
  EXPECT_EQ(cloud.scans.size(), 2u);
}

/// What is not asked for is not kept; who asks for what is not there gets all, to be told what is.
TEST(PointStream, OnlyColumnsThatAreNamedAreKept) {
  const TemporaryFolder folder;
  const auto columns_of = [&](const std::string& path, const std::vector<std::string>& attributes) {
    ReadOptions options;
    options.attributes = attributes;
    const PointCloud cloud = read_points(path, nullptr, Context(1), options);
    std::string names = cloud.colors.empty() ? "" : "color ";
    for (const Column& column : cloud.columns) names += column.name + " ";
    return names;
  };
  const std::string all = "color heat cold ";
  std::vector<std::string> files;
  std::vector<std::vector<double>> rows = rows_of(90, 5, 6);
  files.push_back(folder.write("a.xyz", text_of(rows, "x y z red green blue heat cold\n")));
  PcdFile pcd;
  pcd.fields = {{"x"}, {"y"}, {"z"}, {"r", "U", 1}, {"g", "U", 1}, {"b", "U", 1}, {"heat"}, {"cold"}};
  pcd.rows = rows;
  for (const PcdCoding coding : {PcdCoding::ascii, PcdCoding::binary, PcdCoding::compressed})
    files.push_back(folder.write(fmt::format("{}.pcd", files.size()), pcd.text(coding)));
  PointCloud cloud = read_points(files[0]);
  for (const bool ascii : {false, true}) {
    files.push_back(folder / fmt::format("{}.ply", files.size()));
    WriteOptions as;
    as.ascii = ascii;
    write_points(files.back(), cloud, as);
  }
  files.push_back(folder.write("a.conf", "bmesh a.xyz 0 0 1 0 0 0 1\n"));
  std::vector<double> heat(20, 3.0);
  files.push_back(
      folder.write("a.e57", E57Writer::file({line_scan(20, {integers("colorRed", std::vector<int64_t>(20, 5), 0, 255),
                                                            integers("colorGreen", std::vector<int64_t>(20, 6), 0, 255),
                                                            integers("colorBlue", std::vector<int64_t>(20, 7), 0, 255),
                                                            floats("heat", heat), floats("cold", heat)})})));
  for (const std::string& file : files) {
    SCOPED_TRACE(file);
    EXPECT_EQ(columns_of(file, {"all"}), all);
    EXPECT_EQ(columns_of(file, {"color"}), "color ");
    EXPECT_EQ(columns_of(file, {}), "");
    EXPECT_EQ(columns_of(file, {"cold"}), "cold ");
    EXPECT_EQ(columns_of(file, {"cold", "color"}), "color cold ");
    EXPECT_EQ(columns_of(file, {"cold", "warm"}), all);
  }
}

/// Every real file of the folder, as a whole and in blocks.
TEST(PointStream, RealFilesInBlocksAreTheCloud) {
  for (const std::string name : {"autzen-thin.las", "pump.e57", "five_people.pcd", "000094.bin"}) {
    const std::optional<std::string> path = real_data("real/" + name);
    if (!path) GTEST_SKIP() << "SOAPFILM_DATA is not set";
    ReadReport report, other;
    const PointCloud cloud = read_points(*path, &report);
    Watched sink(1000);
    stream_points(*path, sink, other, {}, Context(2));
    expect_identical(sink.cloud(), cloud);
    expect_same_report(other, report);
  }
}

}  // namespace TEST_FILE
}  // namespace soapfilm
