// How many samples a file can have, and what reading many of them takes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <vector>

#include "e57_writer.h"
#include "files.h"
#include "las_files.h"
#include "laz_files.h"
#include "npy_files.h"
#include "samples.h"
#include "soapfilm/io/formats.h"
#include "soapfilm/io/point_stream.h"
#include "soapfilm/io/summary.h"

namespace soapfilm {
namespace TEST_FILE {

using test::E57TestScan;
using test::E57Writer;
using test::line_scan;

/// Counts of 64 bits are read as such: files that do not hold so many samples are refused, with their number.
TEST(SampleCounts, CountsOf64BitsAreNamedWhereAFileIsTooShort) {
  const TemporaryFolder folder;
  const std::string many = "5000000000";
  LasFile las;
  las.minor = 4;
  las.format = 6;
  las.points.resize(20);
  std::string las_bytes = las.bytes(), laz_bytes = laz_of(las_bytes);
  put(las_bytes, 247, uint64_t{5'000'000'000});
  put(laz_bytes, 247, uint64_t{5'000'000'000});
  E57TestScan scan = line_scan(20);
  scan.record_count = 5'000'000'000;
  const std::string row(12, '\0');
  const std::vector<std::string> files = {
      folder.write("a.las", las_bytes),
      folder.write("a.laz", laz_bytes),
      folder.write("a.e57", E57Writer::file({scan})),
      folder.write("a.npy", npy(npy_literal("'<f4'", "(" + many + ", 3)"), row)),
      folder.write("a.pcd", "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH " + many +
                                "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " + many + "\nDATA binary\n" + row),
      folder.write("a.ply", "ply\nformat binary_little_endian 1.0\nelement vertex " + many +
                                "\nproperty float x\nproperty float y\nproperty float z\nend_header\n" + row),
      folder.write("b.ply", "ply\nformat ascii 1.0\nelement vertex " + many +
                                "\nproperty float x\nproperty float y\nproperty float z\nend_header\n1 2 3\n")};
  for (const std::string& file : files) {
    SCOPED_TRACE(file);
    SummarySink sink;
    ReadReport report;
    expect_refusal<InputError>([&] { read_points(file); }, {many});
    expect_refusal<InputError>([&] { stream_points(file, sink, report, {}, Context(1)); }, {many});
    EXPECT_EQ(sink.held_bytes(), 0u);
  }
}

/// A cloud holds 2^31 - 1 samples of a file; who takes blocks has no such limit.
TEST(SampleCounts, OnlyACloudLimitsTheSamplesOfAFile) {
  const TemporaryFolder folder;
  const std::string file = folder.write("a.npy", npy(npy_literal("'|u1'", "(3000000000, 3)"), ""));
  std::error_code error;
  std::filesystem::resize_file(file, std::filesystem::file_size(file) + 9'000'000'000, error);  // a hole
  if (error) GTEST_SKIP() << "no file of 9 GB: " << error.message();
  expect_refusal<InputError>([&] { read_points(file); }, {"holds 3000000000 samples, must be at most 2147483647"});
  struct Enough {};
  struct First : io::PointSink {
    void begin(const io::PointHeader& header, const std::string&) override { EXPECT_EQ(header.samples, 3'000'000'000); }
    void take(io::PointBlock&& block) override {
      EXPECT_EQ(block.size(), block_samples());
      throw Enough();
    }
    void end(io::PointEnd&&) override {}
  } sink;
  ReadReport report;
  EXPECT_THROW(stream_points(file, sink, report, {}, Context(1)), Enough);
}

/// Counting the samples of a long file takes the memory of a block, and of the places that tell their spacing.
TEST(SummarySink, HoldsNoMoreForALongFile) {
  const TemporaryFolder folder;
  constexpr size_t most = 1024;
  Random random(4);
  std::string bytes;
  constexpr size_t count = 300'000;
  for (size_t i = 0; i < count; ++i)
    for (const double v : {random.uniform(0, 30), random.uniform(0, 20), 1.0, 0.5})
      bytes += bytes_of(static_cast<float>(v));
  struct Bounded : SummarySink {
    using SummarySink::SummarySink;
    void take(io::PointBlock&& block) override {
      EXPECT_LE(block.samples.positions.capacity(), block_samples() + (size_t{1} << 14));
      largest = std::max(largest, block.size());
      SummarySink::take(std::move(block));
    }
    size_t largest = 0;
  } sink(most);
  ReadReport report;
  stream_points(folder.write("a.bin", bytes), sink, report, {}, Context(1));
  const CloudSummary summary = sink.summary();
  EXPECT_EQ(summary.samples, count);
  EXPECT_EQ(sink.largest, sink.block_samples());
  EXPECT_LE(sink.held_bytes(), 2 * most * sizeof(Vec3d));
  EXPECT_NEAR(summary.spacing, std::sqrt(600.0 / count), 0.05 * std::sqrt(600.0 / count));
}

}  // namespace TEST_FILE
}  // namespace soapfilm
