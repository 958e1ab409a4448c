// LAS: files made here, and real ones when SOAPFILM_DATA names the data.
#include "las_files.h"

#include "files.h"
#include "samples.h"
#include "soapfilm/io.h"
#include "support/real_data.h"

namespace soapfilm {
namespace TEST_FILE {

const Column* find_column(const PointCloud& cloud, const std::string& name) {
  for (const Column& column : cloud.columns)
    if (column.name == name) return &column;
  return nullptr;
}

std::vector<float> values_of(const PointCloud& cloud, const std::string& name) {
  const Column* column = find_column(cloud, name);
  return column != nullptr ? column->values : std::vector<float>();
}

bool warns(const ReadReport& report, const std::string& part) {
  return std::count_if(report.warnings.begin(), report.warnings.end(),
                       [&](const std::string& w) { return w.find(part) != std::string::npos; }) == 1;
}

LasFile three_points(int format) {
  LasFile file;
  file.format = format;
  file.minor = format >= 6 ? 4 : format >= 4 ? 3 : 2;
  file.points = {{{1500, 2250, 3125}, 100, 2, 0, false, 1000.25, {30069, 0, 65535}, 7},
                 {{2500, 2500, 3000}, 101, 5, 0, false, 1000.5, {257, 514, 771}, 8},
                 {{-2147483647 - 1, 2147483647, -1}, 0, 2, 0, false, 1001, {0, 0, 0}, 9}};
  return file;
}

TEST(Las, AllPointFormatsHaveTheirFieldsAtTheirPlaces) {
  const TemporaryFolder folder;
  for (int format = 0; format <= 10; ++format) {
    SCOPED_TRACE(format);
    ReadReport report;
    const PointCloud cloud = read_points(folder.write("a.las", three_points(format).bytes()), &report);
    ASSERT_EQ(cloud.size(), 3u);
    EXPECT_EQ(cloud.positions[0], (Vec3d{1500 * 0.001 + 500000, 2250 * 0.001 + 4649000, 3125 * 0.001}));
    EXPECT_EQ(cloud.positions[2], (Vec3d{-2147483648.0 * 0.001 + 500000, 2147483647 * 0.001 + 4649000, -0.001}));
    EXPECT_EQ(values_of(cloud, "intensity"), std::vector<float>({100, 101, 0}));
    EXPECT_EQ(values_of(cloud, "return_number"), std::vector<float>({2, 2, 2}));
    EXPECT_EQ(values_of(cloud, "number_of_returns"), std::vector<float>({3, 3, 3}));
    EXPECT_EQ(values_of(cloud, "classification"), std::vector<float>({2, 5, 2}));
    EXPECT_TRUE(find_column(cloud, "classification")->is_label);
    EXPECT_EQ(values_of(cloud, "scan_angle"), std::vector<float>({-9, -9, -9}));
    EXPECT_EQ(find_column(cloud, "user_data"), nullptr);  // zero everywhere
    EXPECT_EQ(find_column(cloud, "point_source_id"), nullptr);
    const bool has_time = format != 0 && format != 2;
    const bool has_color = format != 0 && format != 1 && format != 4 && format != 6 && format != 9;
    EXPECT_EQ(values_of(cloud, "gps_time"), has_time ? std::vector<float>({0, 0.25, 0.75}) : std::vector<float>());
    EXPECT_EQ(cloud.colors, has_color ? std::vector<Rgb8>({{117, 0, 255}, {1, 2, 3}, {0, 0, 0}}) : std::vector<Rgb8>());
    EXPECT_EQ(values_of(cloud, "nir"),
              format == 8 || format == 10 ? std::vector<float>({7, 8, 9}) : std::vector<float>());
    ASSERT_EQ(cloud.scans.size(), 1u);
    EXPECT_EQ(cloud.scans[0].name, "a");
    const bool has_waves = format == 4 || format == 5 || format >= 9;
    EXPECT_EQ(report.warnings.size(), has_waves ? 1u : 0u);
    if (has_waves) {
      EXPECT_TRUE(warns(report, "waveforms"));
    }
    EXPECT_NE(report.files.at(0).format.find("point format " + std::to_string(format)), std::string::npos);
  }
}

TEST(Las, IsKnownByItsFirstBytesWhateverTheName) {
  const TemporaryFolder folder;
  EXPECT_EQ(read_points(folder.write("cloud.dat", three_points(2).bytes())).size(), 3u);
}

TEST(Las, ColorsOfEightBitsStayAsTheyAre) {
  const TemporaryFolder folder;
  LasFile file = three_points(2);
  file.points[0].rgb = {255, 1, 0};
  file.points[1].rgb = {7, 8, 9};
  EXPECT_EQ(read_points(folder.write("a.las", file.bytes())).colors,
            std::vector<Rgb8>({{255, 1, 0}, {7, 8, 9}, {0, 0, 0}}));
  for (LasPoint& point : file.points) point.rgb = {};
  EXPECT_TRUE(read_points(folder.write("a.las", file.bytes())).colors.empty());
}

TEST(Las, ColumnThatIsZeroForALongTimeIsWhole) {
  const TemporaryFolder folder;
  LasFile file;
  file.points.resize(5000);
  for (size_t i = 0; i < file.points.size(); ++i) file.points[i].xyz = {static_cast<int32_t>(i), 1, 2};
  file.points[4321].intensity = 65535;
  const std::vector<float> values = values_of(read_points(folder.write("a.las", file.bytes())), "intensity");
  ASSERT_EQ(values.size(), 5000u);
  EXPECT_EQ(std::count(values.begin(), values.end(), 0.0f), 4999);
  EXPECT_EQ(values[4321], 65535);
}

TEST(Las, WithheldPointsAreLeftOutAndNoiseIsTold) {
  const TemporaryFolder folder;
  for (const int format : {1, 6}) {
    LasFile file = three_points(format);
    file.points[1].withheld = true;
    file.points[2].classification = 7;
    ReadReport report;
    const PointCloud cloud = read_points(folder.write("a.las", file.bytes()), &report);
    EXPECT_EQ(cloud.size(), 2u);
    EXPECT_EQ(values_of(cloud, "classification"), std::vector<float>({2, 7}));
    EXPECT_EQ(values_of(cloud, "gps_time"), std::vector<float>({0, 0.75}));
    EXPECT_TRUE(warns(report, "1 of 3 points are marked as withheld"));
    EXPECT_TRUE(warns(report, "1 of 2 samples are classified as noise"));
    EXPECT_EQ(report.warnings.size(), 2u);
    for (LasPoint& point : file.points) point.withheld = true;
    const std::string path = folder.write("b.las", file.bytes());
    expect_refusal<InputError>([&] { read_points(path); }, {"b.las", "all of its 3 points", "withheld"});
  }
}

TEST(Las, ExtraBytesBecomeColumnsByTheirRecord) {
  const TemporaryFolder folder;
  LasFile file = three_points(0);
  const auto extra = [](int16_t amplitude, float width, uint8_t flag) {
    return bytes_of(amplitude) + bytes_of(width) + bytes_of(flag);
  };
  file.points[0].extra = extra(-100, 2.5f, 1) + "??";
  file.points[1].extra = extra(200, 3.5f, 255) + "??";
  file.points[2].extra = extra(300, -1.0f, 3) + "??";
  std::string flag = LasFile::extra("flag", 1, 1);
  put(flag, 40, uint64_t{255});  // means none
  file.records = {LasFile::record(
      "LASF_Spec", 4, LasFile::extra("Amplitude", 4, 8 | 16, 0.01, 5) + LasFile::extra("Pulse width", 9) + flag)};
  ReadReport report;
  const PointCloud cloud = read_points(folder.write("a.las", file.bytes()), &report);
  EXPECT_EQ(values_of(cloud, "Amplitude"), std::vector<float>({4, 7, 8}));
  EXPECT_EQ(values_of(cloud, "Pulse_width"), std::vector<float>({2.5f, 3.5f, -1.0f}));
  const std::vector<float> flags = values_of(cloud, "flag");
  ASSERT_EQ(flags.size(), 3u);
  EXPECT_EQ(flags[0], 1);
  EXPECT_TRUE(std::isnan(flags[1]));
  EXPECT_TRUE(warns(report, "2 extra bytes"));
  EXPECT_EQ(report.warnings.size(), 1u);

  file.records.clear();
  report = {};
  EXPECT_EQ(read_points(folder.write("a.las", file.bytes()), &report).columns.size(), 5u);
  EXPECT_TRUE(warns(report, "9 extra bytes"));
}

TEST(Las, ExtraBytesOfAllTypesAndArraysAreRead) {
  const TemporaryFolder folder;
  LasFile file;
  file.minor = 4;
  file.points.resize(1);
  file.points[0].extra = bytes_of(uint8_t{200}) + bytes_of(int8_t{-3}) + bytes_of(uint16_t{60000}) +
                         bytes_of(int16_t{-300}) + bytes_of(uint32_t{4000000000}) + bytes_of(int32_t{-5}) +
                         bytes_of(uint64_t{1} << 63) + bytes_of(int64_t{-6}) + bytes_of(1.5f) + bytes_of(-2.5) +
                         bytes_of<uint16_t>({1, 2, 3}) + bytes_of<float>({4, 5});
  std::string list;
  for (uint8_t type = 1; type <= 10; ++type) list += LasFile::extra("t" + std::to_string(type), type);
  list += LasFile::extra("triple", 23) + LasFile::extra("pair", 19);
  file.extended_records = {LasFile::record("LASF_Spec", 4, list, true)};
  ReadReport report;
  const PointCloud cloud = read_points(folder.write("a.las", file.bytes()), &report);
  EXPECT_TRUE(report.warnings.empty());
  const std::vector<float> expected{200, -3, 60000, -300, 4e9f, -5, 9223372036854775808.0f, -6, 1.5f, -2.5f};
  for (size_t k = 0; k < expected.size(); ++k)
    EXPECT_EQ(values_of(cloud, "t" + std::to_string(k + 1)), std::vector<float>({expected[k]})) << k;
  EXPECT_EQ(values_of(cloud, "triple_3"), std::vector<float>({3}));
  EXPECT_EQ(values_of(cloud, "pair_2"), std::vector<float>({5}));
}

TEST(Las, NormalsAndScannerPositionsInExtraBytesAreUsed) {
  const TemporaryFolder folder;
  LasFile file = three_points(0);
  for (LasPoint& point : file.points) point.extra = bytes_of<float>({0, 0.6f, 0.8f}) + bytes_of<double>({1e6, 2, 3});
  std::string list;
  for (const char* name : {"NormalX", "NormalY", "NormalZ"}) list += LasFile::extra(name, 9);
  for (const char* name : {"x_origin", "y_origin", "z_origin"}) list += LasFile::extra(name, 10);
  file.records = {LasFile::record("LASF_Spec", 4, list)};
  const PointCloud cloud = read_points(folder.write("a.las", file.bytes()));
  EXPECT_EQ(cloud.normals, std::vector<Vec3f>(3, {0, 0.6f, 0.8f}));
  EXPECT_EQ(cloud.sensors, std::vector<Vec3d>(3, {1e6, 2, 3}));
}

std::string geotiff_keys(std::initializer_list<uint16_t> keys) {
  std::string bytes = bytes_of<uint16_t>({1, 1, 0, static_cast<uint16_t>(keys.size() / 4)});
  for (const uint16_t word : keys) bytes += bytes_of(word);
  return bytes;
}

TEST(Las, CoordinateSystemIsWktOrAnEpsgNumber) {
  const TemporaryFolder folder;
  LasFile file = three_points(0);
  const auto system = [&](const std::vector<std::string>& records, ReadReport* report = nullptr) {
    file.records = records;
    return read_points(folder.write("a.las", file.bytes()), report).coordinate_system;
  };
  const std::string wkt = LasFile::record("LASF_Projection", 2112, std::string("PROJCS[\"A\",\r\n  B]\0\0", 19));
  const std::string keys = LasFile::record("LASF_Projection", 34735, geotiff_keys({1024, 0, 1, 1, 3072, 0, 1, 26915}));
  EXPECT_EQ(system({}), "");
  EXPECT_EQ(system({keys}), "EPSG:26915");
  EXPECT_EQ(system({keys, wkt}), "PROJCS[\"A\", B]");
  EXPECT_EQ(system({LasFile::record("LASF_Projection", 34735, geotiff_keys({2048, 0, 1, 4326}))}), "EPSG:4326");
  ReadReport report;
  EXPECT_EQ(system({LasFile::record("LASF_Projection", 34735, geotiff_keys({3072, 0, 1, 32767}))}, &report), "");
  EXPECT_TRUE(warns(report, "without an EPSG number"));
  EXPECT_EQ(system({LasFile::record("other", 34735, geotiff_keys({3072, 0, 1, 1234}))}), "");
  file.minor = 4;
  file.extended_records = {LasFile::record("LASF_Projection", 2112, "GEOGCS[]", true)};
  EXPECT_EQ(system({}), "GEOGCS[]");
}

TEST(Las, FlightLinesAreScansIfTheyAreFewAndLong) {
  const TemporaryFolder folder;
  LasFile file;
  for (int i = 0; i < 6000; ++i) {
    file.points.push_back({});
    file.points.back().xyz = {i, 2 * i, 7};
    file.points.back().source = static_cast<uint16_t>(i < 2500 ? 17 : i < 4000 ? 18 : 17);
  }
  file.points[5].withheld = true;
  const PointCloud cloud = read_points(folder.write("tile.las", file.bytes()));
  ASSERT_EQ(cloud.scans.size(), 3u);
  EXPECT_EQ(cloud.scans[0].name, "tile 17");
  EXPECT_EQ(cloud.scans[1].name, "tile 18");
  EXPECT_EQ(cloud.scans[1].begin, 2499u);
  EXPECT_EQ(cloud.scans[1].end, 3999u);
  EXPECT_EQ(cloud.scans[2].end, 5999u);
  for (size_t i = 0; i < file.points.size(); ++i) file.points[i].source = static_cast<uint16_t>(i / 500);
  EXPECT_EQ(read_points(folder.write("tile.las", file.bytes())).scans.size(), 1u);
}

TEST(Las, HeaderThatContradictsThePointsIsWarnedOf) {
  const TemporaryFolder folder;
  std::string bytes = three_points(0).bytes();
  const auto put_box = [&](double lo, double hi) {
    for (size_t k = 0; k < 3; ++k) {
      put(bytes, 179 + 16 * k, hi);
      put(bytes, 187 + 16 * k, lo);
    }
  };
  ReadReport report;
  put_box(-1e8, 1e8);
  read_points(folder.write("a.las", bytes), &report);
  EXPECT_TRUE(report.warnings.empty());
  put_box(0, 600000);
  read_points(folder.write("a.las", bytes), &report);
  EXPECT_EQ(report.warnings.size(), 1u);
  EXPECT_TRUE(warns(report, "in the header"));

  put_box(0, 0);
  report = {};
  put(bytes, 107, uint32_t{2});
  EXPECT_EQ(read_points(folder.write("a.las", bytes), &report).size(), 2u);
  EXPECT_TRUE(warns(report, "20 bytes after the last of 2 points"));
}

TEST(Las, RefusalsNamePlaceValueAndConstraint) {
  const TemporaryFolder folder;
  const auto refused = [&](std::string bytes, std::initializer_list<std::string> parts) {
    const std::string path = folder.write("r.las", bytes);
    expect_refusal<InputError>([&] { read_points(path); }, parts);
    expect_refusal<InputError>([&] { read_points(path); }, {path});
  };
  const std::string whole = three_points(3).bytes();
  const auto with = [&](size_t at, auto value) {
    std::string bytes = whole;
    put(bytes, at, value);
    return bytes;
  };
  for (size_t size = 4; size < whole.size(); size += 3) refused(whole.substr(0, size), {"must be"});
  refused(whole.substr(0, whole.size() - 1), {"byte 107", "= 3", "at most 2", "truncated"});
  refused("words that are no points", {"byte 0", "'word'", "'LASF'"});
  refused(with(24, uint8_t{2}), {"byte 24", "2.2", "1.0 to 1.4"});
  refused(with(94, uint16_t{226}), {"byte 94", "226", "227"});
  refused(with(96, uint32_t{100}), {"byte 96", "100"});
  refused(with(96, uint32_t{4000000000}), {"byte 96", "4000000000"});
  refused(with(104, uint8_t{11}), {"byte 104", "11", "0 to 10"});
  refused(with(105, uint16_t{33}), {"byte 105", "33", "at least 34"});
  refused(with(107, uint32_t{0}), {"byte 107", "= 0", "> 0"});
  refused(with(107, uint32_t{4294967295}), {"byte 107", "4294967295", "at most 3"});
  refused(with(131, 0.0), {"byte 131", "scale of x", "not 0"});
  refused(with(163, std::numeric_limits<double>::infinity()), {"byte 163", "offset of y", "inf", "finite"});
  refused(with(104, uint8_t{0x83}), {"LAZ", "no record of LASzip"});
  std::string huge = three_points(6).bytes();
  put(huge, 247, uint64_t{1} << 63);
  refused(huge, {"byte 247", "9223372036854775808", "at most 3"});
}

TEST(Las, RecordsThatLieAreWarnedOfAndThePointsRead) {
  const TemporaryFolder folder;
  LasFile file = three_points(6);
  std::string record = LasFile::record("LASF_Projection", 2112, "WKT");
  put(record, 20, uint16_t{60000});
  file.records = {record};
  file.extended_records = {LasFile::record("LASF_Projection", 2112, "WKT", true)};
  std::string bytes = file.bytes();
  put(bytes, 243, uint32_t{4294967295});
  ReadReport report;
  const PointCloud cloud = read_points(folder.write("a.las", bytes), &report);
  EXPECT_EQ(cloud.size(), 3u);
  EXPECT_EQ(cloud.coordinate_system, "WKT");
  EXPECT_TRUE(warns(report, "record 1 of 1"));
  EXPECT_TRUE(warns(report, "record 2 of 4294967295"));
  put(bytes, 235, uint64_t{3});
  report = {};
  read_points(folder.write("a.las", bytes), &report);
  EXPECT_TRUE(warns(report, "byte 235"));
  file = three_points(0);
  for (LasPoint& point : file.points) point.extra = "ab";
  file.records = {LasFile::record("LASF_Spec", 4, LasFile::extra("a", 1) + LasFile::extra("wide", 10))};
  report = {};
  EXPECT_EQ(values_of(read_points(folder.write("a.las", file.bytes()), &report), "a"), std::vector<float>(3, 'a'));
  EXPECT_TRUE(warns(report, "more than the 2 extra bytes"));
}

TEST(Las, CanBeWrittenAsPlyWithAllItsColumns) {
  const TemporaryFolder folder;
  LasFile file = three_points(10);
  for (LasPoint& point : file.points) point.extra = bytes_of<float>({1, 2, 3});
  file.records = {LasFile::record(
      "LASF_Spec", 4, LasFile::extra("x", 9) + LasFile::extra("two words", 9) + LasFile::extra("weight.", 9))};
  const PointCloud cloud = read_points(folder.write("a.las", file.bytes()));
  write_points(folder / "a.ply", cloud);
  expect_same_cloud(read_points(folder / "a.ply"), cloud);
}

TEST(Las, ReadingCanBeCancelled) {
  const TemporaryFolder folder;
  const std::string path = folder.write("a.las", three_points(3).bytes());
  Progress progress;
  progress.cancel();
  const Context context(1, progress);
  EXPECT_THROW(read_points(path, nullptr, context), Cancelled);
}

TEST(Las, RealFilesAreReadAsAnIndependentReaderDoes) {
  const auto simple = real_data("formats/las-simple.las"), new_one = real_data("formats/las-1.4.las");
  if (!simple || !new_one) GTEST_SKIP() << "no LAS files in SOAPFILM_DATA";
  ReadReport report;
  const PointCloud cloud = read_points(*simple, &report);
  EXPECT_EQ(cloud.size(), 1065u);
  EXPECT_EQ(cloud.colors.size(), 1065u);
  const Box3d box = cloud.box();
  EXPECT_NEAR(box.hi.x, 638982.55, 1e-6);
  EXPECT_NEAR(box.lo.x, 635619.85, 1e-6);
  EXPECT_EQ(read_points(*new_one, &report).size(), 1000u);
  EXPECT_EQ(read_points(*real_data("formats/las-extra-bytes.las"), &report).size(), 1065u);
  const PointCloud one = read_points(*real_data("formats/las-utm15.las"), &report);
  EXPECT_EQ(one.size(), 1u);
  EXPECT_EQ(one.coordinate_system, "EPSG:26915");
  EXPECT_THROW(read_points(*real_data("formats/las-1.2-clipped.las")), InputError);
  EXPECT_EQ(read_points(*real_data("formats/laz-simple.laz")).positions, cloud.positions);
}

}  // namespace TEST_FILE
}  // namespace soapfilm
