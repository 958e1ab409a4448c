// NumPy arrays of numbers and of named fields.
#include "binary_bytes.h"
#include "files.h"
#include "npy_files.h"
#include "soapfilm/core/random.h"
#include "soapfilm/core/vec.h"
#include "soapfilm/io.h"

namespace soapfilm {
namespace TEST_FILE {

template <class T>
std::string numbers(const std::vector<double>& values, bool big_endian = false) {
  std::string bytes;
  for (const double v : values) bytes += bytes_of(static_cast<T>(v), big_endian);
  return bytes;
}

/// Of `columns` floats.
PointCloud read_floats(const TemporaryFolder& folder, const std::vector<double>& values, size_t columns,
                       ReadReport* report = nullptr) {
  const std::string shape = "(" + std::to_string(values.size() / columns) + ", " + std::to_string(columns) + ")";
  return read_points(folder.write("a.npy", npy(npy_literal("'<f4'", shape), numbers<float>(values))), report);
}

TEST(Npy, PositionsOfAllTypesOrdersAndVersions) {
  const TemporaryFolder folder;
  const std::vector<Vec3d> expected{{1, 2, 3}, {4, 5, 6}};
  const std::vector<double> rows{1, 2, 3, 4, 5, 6}, columns{1, 4, 2, 5, 3, 6};
  for (const bool fortran : {false, true}) {
    const auto check = [&](const std::string& type, const std::string& data) {
      for (const int version : {1, 2, 3})
        EXPECT_EQ(
            read_points(folder.write("a.npy", npy(npy_literal(type, "(2, 3)", fortran), data, version))).positions,
            expected)
            << type;
    };
    const std::vector<double>& v = fortran ? columns : rows;
    check("'<f4'", numbers<float>(v));
    check("'>f4'", numbers<float>(v, true));
    check("'<f8'", numbers<double>(v));
    check("\">f8\"", numbers<double>(v, true));
    check("'|i1'", numbers<int8_t>(v));
    check("'|u1'", numbers<uint8_t>(v));
    check("'<i2'", numbers<int16_t>(v));
    check("'>u2'", numbers<uint16_t>(v, true));
    check("'<i4'", numbers<int32_t>(v));
    check("'>u4'", numbers<uint32_t>(v, true));
    check("'<i8'", numbers<int64_t>(v));
    check("'>u8'", numbers<uint64_t>(v, true));
  }
}

TEST(Npy, DoublesKeepAllTheirDigitsAndTheNameIsTheScans) {
  const TemporaryFolder folder;
  ReadReport report;
  const PointCloud cloud = read_points(
      folder.write("left.npy", npy(npy_literal("'<f8'", "(1, 3)"), numbers<double>({512345.678901, 1e-9, -3}))),
      &report);
  EXPECT_EQ(cloud.positions[0], (Vec3d{512345.678901, 1e-9, -3}));
  ASSERT_EQ(cloud.scans.size(), 1u);
  EXPECT_EQ(cloud.scans[0].name, "left");
  EXPECT_EQ(report.files.at(0).properties, std::vector<std::string>({"x", "y", "z"}));
  EXPECT_TRUE(report.warnings.empty());
}

TEST(Npy, FourthColumnIsAnIntensity) {
  const TemporaryFolder folder;
  const PointCloud cloud = read_floats(folder, {1, 2, 3, 0.5, 4, 5, 6, 0.25}, 4);
  ASSERT_EQ(cloud.columns.size(), 1u);
  EXPECT_EQ(cloud.columns[0].name, "intensity");
  EXPECT_EQ(cloud.columns[0].values, std::vector<float>({0.5, 0.25}));
}

std::vector<double> normal(Random& random) {
  const Vec3d v = normalized(Vec3d{random.normal(), random.normal(), random.normal()});
  return {v.x, v.y, v.z};
}
std::vector<double> color(Random& random, double range) {
  std::vector<double> rgb;
  for (int k = 0; k < 3; ++k) rgb.push_back(range == 1 ? random.uniform() : std::floor(random.uniform(0, 256)));
  rgb[0] = range == 1 ? rgb[0] : 255;
  return rgb;
}

/// Rows of x y z and of what the letters say: n(ormal), c(olor to 255), u(nit color), i(ntensity), l(abel).
std::vector<double> rows_of(const std::string& kinds, size_t rows = 50) {
  Random random(7);
  std::vector<double> values;
  for (size_t i = 0; i < rows; ++i) {
    for (int axis = 0; axis < 3; ++axis) values.push_back(random.uniform(-10, 10));
    for (const char kind : kinds) {
      std::vector<double> part{kind == 'i' ? random.uniform(0, 4000) : static_cast<double>(i % 13)};
      if (kind == 'n') part = normal(random);
      if (kind == 'c' || kind == 'u') part = color(random, kind == 'c' ? 255 : 1);
      values.insert(values.end(), part.begin(), part.end());
    }
  }
  return values;
}

TEST(Npy, FurtherColumnsAreJudgedByTheirValues) {
  const TemporaryFolder folder;
  struct Case {
    std::string kinds;
    std::string names;
    size_t warnings;
  };
  const Case cases[] = {{"n", "x y z nx ny nz", 0},
                        {"c", "x y z red green blue", 0},
                        {"u", "x y z red green blue", 0},
                        {"ic", "x y z intensity red green blue", 0},
                        {"in", "x y z intensity nx ny nz", 0},
                        {"cl", "x y z red green blue intensity", 1},
                        {"nl", "x y z nx ny nz column_7", 1},
                        {"cn", "x y z red green blue nx ny nz", 0},
                        {"nu", "x y z nx ny nz red green blue", 0},
                        {"inc", "x y z intensity nx ny nz red green blue", 0},
                        {"ii", "x y z column_4 column_5", 1},
                        {"iil", "x y z column_4 column_5 column_6", 1}};
  for (const Case& one : cases) {
    ReadReport report;
    const std::vector<double> values = rows_of(one.kinds);
    const PointCloud cloud = read_floats(folder, values, values.size() / 50, &report);
    std::string names;
    for (const std::string& name : report.files.at(0).properties) names += (names.empty() ? "" : " ") + name;
    EXPECT_EQ(names, one.names) << one.kinds;
    EXPECT_EQ(report.warnings.size(), one.warnings) << one.kinds;
    EXPECT_EQ(cloud.normals.size(), one.kinds.find('n') != std::string::npos ? 50u : 0u) << one.kinds;
    EXPECT_EQ(cloud.colors.size(), one.kinds.find_first_of("cu") != std::string::npos ? 50u : 0u) << one.kinds;
  }
}

TEST(Npy, APointsNumberMayComeFirst) {
  const TemporaryFolder folder;
  std::vector<double> values;
  for (int i = 0; i < 30; ++i) values.insert(values.end(), {100.0 + i, std::sin(i), std::cos(i), 1e6 + 0.25 * i});
  const std::string shape = "(30, 4)";
  ReadReport report;
  const PointCloud cloud =
      read_points(folder.write("a.npy", npy(npy_literal("'<f8'", shape), numbers<double>(values))), &report);
  EXPECT_EQ(cloud.positions[3], (Vec3d{std::sin(3), std::cos(3), 1e6 + 0.75}));
  EXPECT_EQ(report.files.at(0).properties, std::vector<std::string>({"id", "x", "y", "z"}));
  EXPECT_EQ(report.warnings.size(), 1u);
}

TEST(Npy, OddRowsDoNotChangeWhatColumnsAre) {
  const TemporaryFolder folder;
  std::vector<double> colors = rows_of("c"), unit_colors = rows_of("u"), normals = rows_of("n");
  for (size_t k = 3; k < 6; ++k) {
    colors[60 + k] = -1;
    unit_colors[60 + k] = 200;
    normals[60 + k] = 0;
  }
  ReadReport report;
  const PointCloud cloud = read_floats(folder, colors, 6, &report);
  ASSERT_EQ(cloud.colors.size(), 50u);
  EXPECT_EQ(cloud.colors[10], (Rgb8{128, 128, 128}));
  EXPECT_EQ(cloud.colors[11][0], 255);
  EXPECT_EQ(report.warnings.size(), 1u);
  const PointCloud unit = read_floats(folder, unit_colors, 6);
  ASSERT_EQ(unit.colors.size(), 50u);
  EXPECT_EQ(unit.colors[10], (Rgb8{128, 128, 128}));
  EXPECT_EQ(unit.colors[11][1], std::lround(255 * unit_colors[66 + 4]));
  EXPECT_EQ(read_floats(folder, normals, 6).normals.size(), 50u);
  EXPECT_EQ(read_floats(folder, {1, 2, 3, 0, 0, 1, 4, 5, 3, 0, 0, 1}, 6).normals.size(), 2u);  // a plane's
}

TEST(Npy, NamedFieldsMeanWhatTheirNamesSay) {
  const TemporaryFolder folder;
  const std::string type =
      "[('label', '<i2'), ('', '|V2'), ('x', '<f8'), ('y', '<f8'), ('z', '>f8'), ('normal', '<f4', (3,)), "
      "('red', '|u1'), ('green', '|u1'), ('blue', '|u1'), ('name', '<U2'), (('The time', 't'), '<f4'),]";
  std::string row = bytes_of(int16_t{-3}) + "??" + bytes_of<double>({1, 2}) + bytes_of(3.5, true) +
                    bytes_of<float>({0, 0.6f, -0.8f}) + "\x01\x02\xff" + "12345678" + bytes_of(4.5f);
  ReadReport report;
  const PointCloud cloud = read_points(folder.write("a.npy", npy(npy_literal(type, "(2,)"), row + row)), &report);
  EXPECT_EQ(cloud.positions, std::vector<Vec3d>(2, {1, 2, 3.5}));
  EXPECT_EQ(cloud.normals, std::vector<Vec3f>(2, {0, 0.6f, -0.8f}));
  EXPECT_EQ(cloud.colors, std::vector<Rgb8>(2, {1, 2, 255}));
  ASSERT_EQ(cloud.columns.size(), 2u);
  EXPECT_EQ(cloud.columns[0].name, "label");
  EXPECT_TRUE(cloud.columns[0].is_label);
  EXPECT_EQ(cloud.columns[0].values, std::vector<float>(2, -3));
  EXPECT_EQ(cloud.columns[1].name, "t");
  ASSERT_EQ(report.warnings.size(), 1u);
  EXPECT_NE(report.warnings[0].find("'name'"), std::string::npos);
}

TEST(Npy, PackedColorsAndPartsOfFieldsAreUsed) {
  const TemporaryFolder folder;
  const std::string type = "[('xyz', '>f4', 3), ('rgb', '>u4'), ('d', '<f4', (2, 1)), ('e', [('f', '<f4')])]";
  const std::string row = numbers<float>({1, 2, 3}, true) + bytes_of(0x00010203u, true) + bytes_of<float>({7, 8, 9});
  const PointCloud cloud = read_points(folder.write("a.npy", npy(npy_literal(type, "(1,)"), row)));
  EXPECT_EQ(cloud.positions, std::vector<Vec3d>({{1, 2, 3}}));
  EXPECT_EQ(cloud.colors, std::vector<Rgb8>({{1, 2, 3}}));
  ASSERT_EQ(cloud.columns.size(), 3u);
  EXPECT_EQ(cloud.columns[1].name, "d_2");
  EXPECT_EQ(cloud.columns[1].values, std::vector<float>({8}));
  EXPECT_EQ(cloud.columns[2].name, "e.f");
}

TEST(Npy, RefusalsNamePlaceValueAndConstraint) {
  const TemporaryFolder folder;
  const std::string data = numbers<float>({1, 2, 3, 4, 5, 6});
  const auto refused_bytes = [&](const std::string& bytes, std::initializer_list<std::string> parts) {
    const std::string path = folder.write("r.npy", bytes);
    expect_refusal<InputError>([&] { read_points(path); }, parts);
    expect_refusal<InputError>([&] { read_points(path); }, {path});
  };
  const auto refused = [&](const std::string& text, std::initializer_list<std::string> parts) {
    refused_bytes(npy(text, data), parts);
  };
  const std::string whole = npy(npy_literal("'<f4'", "(2, 3)"), data);
  for (size_t size = 6; size < whole.size(); ++size) refused_bytes(whole.substr(0, size), {"byte"});
  refused_bytes("words that are no array", {"byte 0", "'words '", "NUMPY"});
  refused_bytes(npy(npy_literal("'<f4'", "(2, 3)"), data, 4), {"version = 4", "1 to 3"});
  refused(npy_literal("'<f4'", "(3, 3)"), {"(3, 3)", "at most 2 rows", "truncated"});
  refused(npy_literal("'<f4'", "(18446744073709551615, 3)"), {"byte", "too large"});
  refused(npy_literal("'<f4'", "(1000000000000000000, 3)"), {"(1000000000000000000, 3)", "truncated"});
  refused(npy_literal("'<f4'", "(0, 3)"), {"(0, 3)", "no samples"});
  refused(npy_literal("'<f4'", "(6,)"), {"(6,)", "(n, 3)"});
  refused(npy_literal("'<f4'", "(3, 2)"), {"(3, 2)", "transposed"});
  refused(npy_literal("'<f4'", "(1, 2, 3, 1)"), {"(1, 2, 3, 1)"});
  refused(npy_literal("'<f4'", "()"), {"()"});
  refused(npy_literal("'<f4'", "(-2, 3)"), {"'-2, 3)", "whole number"});
  refused(npy_literal("'<f2'", "(2, 3)"), {"'<f2'", "f4, f8"});
  refused(npy_literal("'|O'", "(2, 3)"), {"Python objects"});
  refused(npy_literal("'<q4'", "(2, 3)"), {"'<q4'"});
  refused(npy_literal("'<f0'", "(2, 3)"), {"'<f0'"});
  refused(npy_literal("'|V0'", "(2, 3)"), {"'|V0'"});
  refused(npy_literal("[('x', '<f4'), ('y', '<f4')]", "(2,)"), {"'x', 'y'", "x, y and z"});
  refused(npy_literal("[('x', '<f4', (99999999, 99999999))]", "(2,)"), {"too many parts"});
  refused(npy_literal("[('x', '<f4', 400)]", "(2,)"), {"256"});
  refused(npy_literal("[('x', [('x', [('x', [('x', [('x', [('x', '<f4')])])])])])]", "(2,)"), {"lists in lists"});
  refused(npy_literal("[]", "(2,)"), {"no bytes"});
  refused("{'descr': '<f4', 'shape': (2, 3)}", {"'fortran_order'"});
  refused("{'descr': '<f4', 'descr': '<f4'}", {"'descr' is there twice"});
  refused("{'descr': '<f4', 'fortran_order': 1}", {"True or False"});
  refused("{'descr': '<f4', 'color': 1}", {"'color'"});
  refused("{'descr': '<f4", {"without an end"});
  refused(npy_literal("'<f4'", "(2, 3)") + " __import__('os')", {"must end here"});
  refused_bytes(
      npy(npy_literal("[('x','<f4'),('y','<f4'),('z','<f4'),('weight','<f4')]", "(1,)"), numbers<float>({1, 2, 3, -5})),
      {"sample 0", "weight = -5", ">= 0"});
}

TEST(Npy, ImagesOfPositionsAreRangeGrids) {
  constexpr int height = 30, width = 40;
  const auto position = [](int r, int c) {
    const double t = 3 + 0.5 * std::sin(c / 4.0) * std::cos(r / 5.0);
    return Vec3d{(c - 19.5) / 40 * t, (r - 14.5) / 40 * t, t};
  };
  std::vector<double> by_rows, by_columns(3 * height * width);
  for (int r = 0; r < height; ++r)
    for (int c = 0; c < width; ++c)
      for (int k = 0; k < 3; ++k) {
        const double value = r == 4 && c < 9 ? (c < 3 ? std::nan("") : 0) : position(r, c)[k];
        by_rows.push_back(value);
        by_columns[static_cast<size_t>(r + height * (c + width * k))] = value;
      }
  for (const bool fortran : {false, true}) {
    const TemporaryFolder folder;
    ReadReport report;
    const std::string bytes =
        npy(npy_literal("'<f4'", "(30, 40, 3)", fortran), numbers<float>(fortran ? by_columns : by_rows));
    const PointCloud cloud = read_points(folder.write("a.npy", bytes), &report);
    EXPECT_EQ(cloud.size(), 1191u);
    EXPECT_EQ(report.files.at(0).no_return, 9u);
    const Scan& scan = cloud.scans.at(0);
    ASSERT_TRUE(scan.range_grid && scan.sensor);
    EXPECT_EQ(*scan.sensor, (Vec3d{0, 0, 0}));
    EXPECT_EQ(scan.range_grid->rows, height);
    EXPECT_EQ(scan.range_grid->sample[4 * width + 5], -1);
    const auto sample = static_cast<size_t>(scan.range_grid->sample[7 * width + 11]);
    EXPECT_LT(norm(cloud.positions[sample] - position(7, 11)), 1e-6);
  }
}

TEST(Npy, ImagesMayHaveNamedFields) {
  const TemporaryFolder folder;
  const PointCloud cloud =
      read_points(folder.write("a.npy", npy(npy_literal("[('x','<f4'),('y','<f4'),('z','<f4')]", "(2, 2)"),
                                            numbers<float>({1, 2, 3, 4, 5, 6, 0, 0, 0, 7, 8, 9}))));
  EXPECT_EQ(cloud.positions, (std::vector<Vec3d>{{1, 2, 3}, {4, 5, 6}, {7, 8, 9}}));
  ASSERT_TRUE(cloud.scans.at(0).range_grid);
  EXPECT_EQ(cloud.scans[0].range_grid->sample, (std::vector<int32_t>{0, 1, -1, 2}));
}

TEST(Npy, BytesAfterTheArrayAreTold) {
  const TemporaryFolder folder;
  ReadReport report;
  read_points(folder.write("a.npy", npy(npy_literal("'<f4'", "(1, 3)"), numbers<float>({1, 2, 3, 4}))), &report);
  ASSERT_EQ(report.warnings.size(), 1u);
  EXPECT_NE(report.warnings[0].find("4 bytes after the array"), std::string::npos);
}

TEST(Npy, RowsWithoutFiniteCoordinatesAreDropped) {
  const TemporaryFolder folder;
  ReadReport report;
  EXPECT_EQ(read_floats(folder, {1, 2, 3, std::nan(""), 5, 6}, 3, &report).size(), 1u);
  EXPECT_EQ(report.dropped(), 1u);
}

}  // namespace TEST_FILE
}  // namespace soapfilm
