// LAZ: files that the tests' own encoder makes, and real ones when SOAPFILM_DATA names the data.
#include "laz_files.h"

#include "files.h"
#include "laz_reading.h"
#include "laz_records.h"
#include "samples.h"
#include "soapfilm/io.h"
#include "support/real_data.h"
#include "support/sanitized.h"

namespace soapfilm {
namespace TEST_FILE {

/// The same without wave packets, which are passed over.
std::string without_waves(std::string records, int format, size_t record_bytes) {
  const size_t place = laz::places_of(format).waves;
  for (size_t at = 0; at < records.size() && place > 0; at += record_bytes) records.replace(at + place, 29, 29, '\0');
  return records;
}

void expect_same_records(const std::string& las, const std::string& laz, size_t most_bytes = size_t{32} << 20) {
  const int format = las[104];
  const auto record_bytes = laz::at<uint16_t>(las, 105);
  const std::string expected = without_waves(records_of(las), format, record_bytes);
  const std::string found = without_waves(records_of(laz, Context(2), most_bytes), format, record_bytes);
  ASSERT_EQ(found.size(), expected.size());
  const auto differs = std::mismatch(found.begin(), found.end(), expected.begin()).first;
  if (differs == found.end()) return;
  const auto at = static_cast<size_t>(differs - found.begin());
  ADD_FAILURE() << "byte " << at % record_bytes << " of point " << at / record_bytes;
}

TEST(Laz, RecordsOfAllFormatsComeBack) {
  for (int format = 0; format <= 10; ++format)
    for (const size_t extra : {0, 7})
      for (const uint16_t version : versions_of(format)) {
        SCOPED_TRACE(testing::Message() << "format " << format << ", extra bytes " << extra << ", version " << version);
        const std::string las = random_las(format, 3000, extra, static_cast<uint64_t>(format) + 100 * extra);
        expect_same_records(las, laz_of(las, {.version = version}));
      }
}

TEST(Laz, ChunksOfAllKindsAreRead) {
  for (const int format : {3, 7}) {
    SCOPED_TRACE(format);
    const std::string las = random_las(format, 150, 3, 17);
    for (const uint32_t points : {1u, 2u, 49u, 150u, 151u, 0xfffffffeu}) {
      SCOPED_TRACE(points);
      expect_same_records(las, laz_of(las, {.chunk_points = points}));
      expect_same_records(las, laz_of(las, {.chunk_points = points, .streamed = true}), 2000);  // some in parts
    }
    expect_same_records(las, laz_of(las, {.chunks = {3, 100, 0, 1, 46}}));
    expect_same_records(las, laz_of(las, {.chunks = {150}, .streamed = true}), 1);
  }
}

TEST(Laz, PointsThatAreAllEqualTakeNoRoom) {
  for (int format = 0; format <= 10; ++format) {
    LasFile file;
    file.format = format;
    file.minor = format >= 6 ? 4 : 2;
    file.points.resize(2000);
    for (LasPoint& point : file.points) point = {{1, 2, 3}, 4, 5, 6, false, 7, {8, 8, 8}, 9, "extra"};
    const std::string laz = laz_of(file.bytes());
    EXPECT_LT(laz.size(), 2600u);  // most of it are the models' first points
    expect_same_records(file.bytes(), laz);
  }
}

TEST(Laz, IsTheCloudOfTheLasFileForAnyNumberOfThreads) {
  const TemporaryFolder folder;
  for (int format = 0; format <= 10; ++format) {
    SCOPED_TRACE(format);
    const std::string las = survey(format, 3000).bytes();
    ReadReport las_report, laz_report;
    const PointCloud cloud = read_points(folder.write("a.las", las), &las_report);
    const std::string path = folder.write("a.laz", laz_of(las, {.chunk_points = 130}));
    EXPECT_EQ(cloud.size(), 2571u);
    expect_same_cloud(read_points(path, &laz_report), cloud);
    expect_same_cloud(read_points(path, nullptr, Context(4)), cloud);
    EXPECT_EQ(laz_report.warnings.size(), las_report.warnings.size());
    EXPECT_NE(laz_report.files[0].format.find("LAZ 1."), std::string::npos);
    EXPECT_EQ(laz_report.files[0].properties, las_report.files[0].properties);
  }
}

TEST(Laz, OnlyNamedColumnsAreKeptAndOnlyTheirLayersDecoded) {
  const TemporaryFolder folder;
  const std::string las = survey(7, 2000).bytes(), laz = laz_of(las);
  const std::string las_path = folder.write("a.las", las), path = folder.write("a.laz", laz);
  const PointCloud all = read_points(path);
  const auto with = [&](const std::string& from, std::vector<std::string> attributes) {
    ReadOptions options;
    options.attributes = std::move(attributes);
    return read_points(from, nullptr, Context(1), options);
  };
  for (const std::string& from : {las_path, path}) {
    const PointCloud none = with(from, {});
    EXPECT_EQ(none.positions, all.positions);
    EXPECT_TRUE(none.columns.empty());
    EXPECT_TRUE(none.colors.empty());
    EXPECT_EQ(none.scans.size(), all.scans.size());
    const PointCloud some = with(from, {"width", "color"});
    EXPECT_EQ(some.colors, all.colors);
    ASSERT_EQ(some.columns.size(), 1u);
    EXPECT_EQ(some.columns[0].values, all.columns.back().values);
    expect_same_cloud(with(from, {"color", "no such column"}), all);
  }
  // The layer of intensities is the fifth. Of bytes that no writer makes there nothing is seen unless it is read.
  const size_t sizes = laz.find(las.substr(laz::at<uint32_t>(las, 96), 40)) + 40 + 4;
  size_t begin = sizes + 4 * (9 + 1 + 4);
  for (size_t k = 0; k < 4; ++k) begin += laz::at<uint32_t>(laz, sizes + 4 * k);
  std::string broken = laz;
  broken.replace(begin, 8, 8, '\xff');
  const std::string broken_path = folder.write("b.laz", broken);
  EXPECT_EQ(with(broken_path, {"width"}).positions, all.positions);
  expect_refusal<InputError>([&] { read_points(broken_path); }, {"b.laz", "byte", "does not hold its 2000 points"});
}

TEST(Laz, FilesThatEndTooSoonAreRefused) {
  const TemporaryFolder folder;
  for (const int format : {3, 8})
    for (const bool streamed : {false, true}) {
      const std::string whole = laz_of(random_las(format, 60, 2, 5), {.chunk_points = 25, .streamed = streamed});
      for (size_t size = 4; size < whole.size(); ++size) {
        SCOPED_TRACE(size);
        const std::string path = folder.write("r.laz", whole.substr(0, size));
        expect_refusal<InputError>([&] { read_points(path); }, {path});
      }
    }
}

TEST(Laz, ChunksThatAreCutShortAreRefused) {
  for (const int format : {0, 3, 6, 8}) {
    const std::string laz = laz_of(random_las(format, 80, 2, 5));
    io::ByteSource source("a.laz", laz);
    ReadReport report;
    const io::LasHeader header = io::read_las_header(source, report);
    const io::LasRecords records = io::read_las_records(source, header, 2, report);
    const io::LazLayout layout = io::read_laz_layout(source, header, records.laszip);
    ASSERT_EQ(layout.chunks.size(), 1u);
    std::string to(80 * header.record_bytes, '\0');
    const auto decodes = [&](size_t size) {
      const std::string bytes = laz.substr(static_cast<size_t>(layout.chunks[0].begin), size);
      const auto points = io::laz_points(layout, 80, bytes, std::vector<bool>(header.record_bytes, true));
      return points && points->read(80, to.data());
    };
    const auto whole = static_cast<size_t>(layout.chunks[0].bytes);
    EXPECT_TRUE(decodes(whole));
    for (size_t size = 0; size + 4 < whole; ++size)
      EXPECT_FALSE(decodes(size)) << format << ": " << size << " of " << whole;
  }
}

TEST(Laz, RefusalsNamePlaceValueAndConstraint) {
  const TemporaryFolder folder;
  const auto refused = [&](const std::string& bytes, std::initializer_list<std::string> parts) {
    const std::string path = folder.write("r.laz", bytes);
    expect_refusal<InputError>([&] { read_points(path); }, parts);
    expect_refusal<InputError>([&] { read_points(path); }, {path});
  };
  const std::string las = random_las(3, 60, 0, 5), whole = laz_of(las, {.chunk_points = 25});
  const size_t record = whole.find("laszip encoded") - 2 + 54, points = laz::at<uint32_t>(whole, 96);
  const auto table = laz::at<uint64_t>(whole, points);
  const auto with = [&](size_t at, auto value) {
    std::string bytes = whole;
    put(bytes, at, value);
    return bytes;
  };
  refused(with(record - 54 + 2, 'x'), {"LAZ", "no record of LASzip"});
  refused(with(record, uint16_t{4}), {"compressor = 4", "1 to 3"});
  refused(with(record, uint16_t{3}), {"compressor = 3", "1 or 2", "point format 3"});
  refused(with(record + 2, uint16_t{1}), {"coder = 1", "must be 0"});
  refused(with(record + 12, uint32_t{0}), {"points in a chunk = 0", "> 0"});
  refused(with(record + 12, uint32_t{19}), {"3 chunks hold 57 points", "60"});
  refused(with(record + 32, uint16_t{2}), {"2 items, must be 3"});
  refused(with(record + 32, uint16_t{9}), {"record of LASzip has 52 bytes, must have 88"});
  refused(with(record + 34, uint16_t{10}), {"item 1 is of type 10", "type 6"});
  refused(with(record + 40 + 2, uint16_t{7}), {"item 2", "7 bytes", "8 bytes"});
  refused(with(record + 38, uint16_t{3}), {"version of an item = 3", "1 or 2"});
  refused(with(points, ~uint64_t{0}), {"table of chunks", "never finished"});
  refused(with(points, uint64_t{points}), {"byte " + std::to_string(points), "table of chunks"});
  refused(with(points, uint64_t{1} << 40), {"1099511627776", "table of chunks"});
  refused(with(static_cast<size_t>(table), uint32_t{1}), {"version of the table", "= 1"});
  refused(with(static_cast<size_t>(table) + 4, uint32_t{2}), {"2 chunks hold 50 points", "60"});
  refused(with(static_cast<size_t>(table) + 4, uint32_t{4000000000}), {"number of chunks = 4000000000", "at most"});
  refused(with(107, uint32_t{61}), {"chunk of", "does not hold its 11 points", "damaged"});
  const std::string one = laz_of(las, {.chunk_points = 4000000000u});
  std::string many = one;
  put(many, 107, uint32_t{2000000000});
  refused(many, {"number of points = 2000000000", "must be at most", "bytes"});
}

TEST(Laz, BytesThatAreWrongDoNoHarm) {
  const TemporaryFolder folder;
  Random random(11);
  for (const int format : {1, 3, 5, 8, 10}) {
    const uint16_t version = format == 3 ? 1 : 0;
    const std::string whole = laz_of(random_las(format, 300, 4, 5), {.chunk_points = 70, .version = version});
    const size_t first = laz::at<uint32_t>(whole, 96);
    for (int trial = 0; trial < (test::sanitized ? 60 : 300); ++trial) {
      std::string bytes = whole;
      for (int k = 0; k < 3; ++k)
        bytes[first + random.next() % (bytes.size() - first)] = static_cast<char>(random.next());
      const std::string path = folder.write("r.laz", bytes);
      try {
        EXPECT_LE(read_points(path).size(), 300u);
      } catch (const InputError& error) {
        EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
      }
    }
  }
}

/// FNV-1a of the bytes of all coordinates, as doubles.
uint64_t checksum_of_positions(const std::string& records, const io::LasHeader& header) {
  uint64_t sum = 0x14650fb0739d0383;
  for (size_t at = 0; at < records.size(); at += header.record_bytes)
    for (int axis = 0; axis < 3; ++axis) {
      const auto raw = laz::at<int32_t>(records, at + 4 * static_cast<size_t>(axis));
      for (const char byte : bytes_of(raw * header.scale[axis] + header.offset[axis]))
        sum = (sum ^ static_cast<uint8_t>(byte)) * 0x100000001b3;
    }
  return sum;
}

std::string content(const std::string& path) {
  const io::ByteSource source(path);
  return std::string(source.bytes());
}

/// What LASzip and laz-perf, or the same points as LAS, say of a file.
struct RealFile {
  const char* name;
  size_t points;
  uint64_t positions;
  const char* las;  // the same records; empty: none
};

// clang-format off
const RealFile real_files[] = {
    {"1.2-with-color.copc.laz", 1065, 0xd5fe47c0d5d3fe22, ""},
    {"1815.laz", 1247, 0x3770f5f56b420218, "1815.las"},
    {"1_4_w_evlr.laz", 1000, 0x18054de3b596025b, "1_4_w_evlr.las"},
    {"autzen_trim.laz", 110000, 0xc9e9d783d843d753, "autzen_trim.las"},
    {"ellipsoid.copc.laz", 100000, 0x8a882f64d913a5d8, ""},
    {"extra-bytes.laz", 1065, 0xb5b9c21fd10f5316, "extra-bytes.las"},
    {"fullwave.laz", 10750, 0x280e68538bae7d78, ""},
    {"indoor.laz", 808042, 0xd25e49d4163f749f, ""},
    {"liblas-generated.laz", 1065, 0xb5b9c21fd10f5316, "basefile.las"},
    {"lone-star.copc.laz", 518862, 0x310d4acad722716f, ""},
    {"padding2.laz", 1065, 0xb5b9c21fd10f5316, "basefile.las"},
    {"pdrf10-1.4.laz", 1024, 0xfbc78dc6380e7629, "pdrf10-1.4.las"},
    {"pdrf4-1.3.laz", 1024, 0xf0a3e0e1646abc55, "pdrf4-1.3.las"},
    {"pdrf5-1.3.laz", 1024, 0xf0a3e0e1646abc55, "pdrf5-1.3.las"},
    {"pdrf6-1.4.laz", 1024, 0xc98b34ca1a84e56d, "pdrf6-1.4.las"},
    {"pdrf7-v4-1.4.laz", 1024, 0xab4ce57ee9e5831e, "pdrf7-v4-1.4.las"},
    {"pdrf9-1.4.laz", 1024, 0xc98b34ca1a84e56d, "pdrf9-1.4.las"},
    {"point-color.laz", 1065, 0x3260de457c14d3b4, "point-color.las"},
    {"point-time-color.laz", 1065, 0x3260de457c14d3b4, "point-time-color.las"},
    {"point-version-1-point-wise.laz", 11781, 0x013987fb70015ba9, "point-version-1-point-wise.las"},
    {"point10.laz", 1065, 0x3260de457c14d3b4, "point10.las"},
    {"simple-laszip-compressor-version-1.2r0.laz", 1065, 0xb5b9c21fd10f5316, "simple.las"}
};
// clang-format on

TEST(Laz, RealFilesAreReadAsIndependentReadersDo) {
  if (!real_data("laz/autzen_trim.laz")) GTEST_SKIP() << "no LAZ files in SOAPFILM_DATA";
  for (const RealFile& file : real_files) {
    SCOPED_TRACE(file.name);
    const std::string laz = content(*real_data("laz/" + std::string(file.name)));
    io::ByteSource source("a.laz", laz);
    ReadReport report;
    const io::LasHeader header = io::read_las_header(source, report);
    EXPECT_EQ(header.count, file.points);
    EXPECT_EQ(checksum_of_positions(records_of(laz), header), file.positions);
    if (*file.las == '\0') continue;
    const std::string las_path = *real_data("laz/" + std::string(file.las));
    expect_same_records(content(las_path), laz);
    const PointCloud cloud = read_points(*real_data("laz/" + std::string(file.name)), nullptr, Context(2));
    EXPECT_EQ(cloud.positions, read_points(las_path).positions);
  }
  for (const char* name : {"coder", "compressor", "size", "type", "version"}) {
    const std::string path = *real_data("laz/broken_" + std::string(name) + ".laz");
    expect_refusal<InputError>([&] { read_points(path); }, {path, "LAZ", "must be"});
  }
  const std::string empty = *real_data("laz/no-points-1.3.laz");
  expect_refusal<InputError>([&] { read_points(empty); }, {empty, "number of points = 0"});
}

}  // namespace TEST_FILE
}  // namespace soapfilm
