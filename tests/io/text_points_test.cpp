// Samples as lines of numbers: separators, headers, counts, encodings, and the columns that the user names.
#include <fmt/format.h>

#include "files.h"
#include "samples.h"
#include "soapfilm/core/vec.h"
#include "soapfilm/io.h"
#include "support/sanitized.h"

namespace soapfilm {
namespace TEST_FILE {

const std::vector<Vec3d> five{
    {1.5, 2.25, 3.125}, {2.5, 2.5, 3}, {1.75, 3.5, 2.875}, {2.125, 2.875, 4.25}, {1.25, 3.25, 4.5}};

/// One file's cloud and report.
struct Read {
  PointCloud cloud;
  ReadReport report;
};

Read read(const std::string& text, const std::string& name = "t.xyz", const std::string& columns = {},
          int threads = 1) {
  const TemporaryFolder folder;
  Read result;
  ReadOptions options;
  options.columns = columns;
  result.cloud = read_points(folder.write(name, text), &result.report, Context(threads), options);
  return result;
}

void expect_refused(const std::string& text, std::initializer_list<std::string> parts,
                    const std::string& name = "t.xyz", const std::string& columns = {}) {
  expect_refusal<InputError>([&] { read(text, name, columns); }, parts);
}

/// The five positions as rows, each with `more` at its end.
std::string rows_of_five(const std::string& separator = " ", const std::string& more = {},
                         const std::string& line_end = "\n") {
  std::string text;
  for (const Vec3d& p : five)
    text += fmt::format("{}{}{}{}{}{}{}", p.x, separator, p.y, separator, p.z, more, line_end);
  return text;
}

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  for (size_t at = 0; (at = text.find(what, at)) != std::string::npos; at += by.size())
    text.replace(at, what.size(), by);
  return text;
}

std::vector<std::string> column_names(const PointCloud& cloud) {
  std::vector<std::string> names;
  for (const Column& column : cloud.columns) names.push_back(column.name);
  return names;
}

using Names = std::vector<std::string>;

TEST(Text, OneKindOfSeparatorForAFileWithCommentsAnywhere) {
  for (const std::string separator : {" ", "\t", "  \t ", ",", " , ", ", ", ";", " ; ", ";\t"})
    for (const std::string line_end :
         {"\n", "\r\n", "\r", " \n", " # said\n", " // said, here\n", "\n\n", "\n# a\n//b;c\n"}) {
      const Read found = read("# head\n\n" + rows_of_five(separator, "", line_end));
      EXPECT_EQ(found.cloud.positions, five) << separator << line_end;
      EXPECT_TRUE(found.report.warnings.empty()) << found.report.warnings[0];
      ASSERT_EQ(found.cloud.scans.size(), 1u);
      EXPECT_EQ(found.cloud.scans[0].name, "t");
      EXPECT_EQ(found.cloud.scans[0].end, 5u);
    }
  expect_refused("1 2 3\n4,5,6\n", {"t.xyz:2:", "'4,5,6'"});
  expect_refused("1,2,3\n4 5 6\n", {"t.xyz:2:", "'4 5 6'", "one kind of separator"});
  expect_refused("1,2,3\n4;5;6\n", {"t.xyz:2:", "'4;5;6'", "one kind of separator"});
  expect_refused("1,2,3 0,0,1\n", {"t.xyz:1:", "'3 0'", "one kind of separator"});
}

TEST(Text, SeparatorsAtTheEndOfALineAreNoColumn) {
  for (const std::string separator : {",", ";"}) {
    EXPECT_EQ(read(rows_of_five(separator, separator)).cloud.positions, five);
    EXPECT_EQ(read(rows_of_five(separator) + "7" + separator + "8" + separator + "9" + separator + "\n").cloud.size(),
              6u);
  }
}

TEST(Text, AnEmptyFieldIsAbsentAndShiftsNothing) {
  const Read found =
      read("x,y,z,intensity,nx,ny,nz\n1,2,3,,0,0,1\n4,5,6,7,,,\n,1,2,3,0,0,1\n7,8,9,NA,0,1,0\n", "t.csv");
  EXPECT_EQ(found.cloud.positions, std::vector<Vec3d>({{1, 2, 3}, {4, 5, 6}, {7, 8, 9}}));
  EXPECT_EQ(found.report.dropped(), 1u);
  ASSERT_EQ(column_names(found.cloud), Names{"intensity"});
  EXPECT_TRUE(std::isnan(found.cloud.columns[0].values[0]));
  EXPECT_EQ(found.cloud.columns[0].values[1], 7);
  EXPECT_EQ(found.cloud.normals, std::vector<Vec3f>({{0, 0, 1}, {}, {0, 1, 0}}));
  EXPECT_EQ(read("1;2;3;\n4;5;6;7\n").cloud.columns.at(0).values.at(1), 7);  // the first row's last value is absent
}

TEST(Text, DecimalCommasAreReadWhereTheyAreCertain) {
  for (const std::string separator : {";", " ; ", "\t", " "}) {
    const std::string text = replaced(rows_of_five(separator), ".", ",");
    const Read found = read(text);
    EXPECT_EQ(found.cloud.positions, five) << text;
    EXPECT_TRUE(found.report.warnings.empty());
    EXPECT_EQ(found.report.files.at(0).format, "text, decimal commas");
    EXPECT_EQ(read("X" + separator + "Y" + separator + "Z\n" + text).cloud.positions, five);
    EXPECT_EQ(read("1" + separator + "2" + separator + "3\n" + text).cloud.size(), 6u);
  }
  EXPECT_EQ(read("\"1,5\",\"2,5\",\"3,5\"\n").report.files.size(), 1u);
}

TEST(Text, DecimalCommasAreNeverMisread) {
  expect_refused("1,5;2.25;3\n", {"t.xyz:1:", "'2.25'", "decimal comma"});
  expect_refused("1,234.5;2;3\n", {"t.xyz:1:", "'1,234.5'"});
  expect_refused("1,234,567 2,5 3,5\n", {"t.xyz:1:", "'567 2'"});
  expect_refused("1,5, 2,25, 3,125\n", {"t.xyz:1:", "decimal commas"});
  expect_refused("1,050,2,250,3,125\n", {"t.xyz:1:", "decimal commas", "';'"});
  expect_refused("1,5,2,05,3,125,0,0,1,0\n2,5,2,05,3,125,0,0,1,0\n", {"t.xyz:1:", "decimal commas"});
  std::string late;
  for (int i = 0; i < 20000; ++i) late += "1.5;2.5;3.5\n";
  expect_refused(late + "1,5;2,5;3,5\n", {"t.xyz:20001:", "'1,5'", "decimal point"});
}

TEST(Text, AHeaderNamesTheColumns) {
  for (const std::string separator : {" ", ",", ";", "\t", ", "})
    for (const std::string before : {"", "//", "# ", "# comment\n//", "\xEF\xBB\xBF", "A title of this file\n"})
      for (const std::string quote : {"", "\""})
        for (const std::string order : {"count first", "no count"}) {
          std::string header;
          for (const char* name :
               {"X", "Y [m]", "Z(m)", "NormalX", "normal_y", "Normal.Z", "scalar_Intensity", "Rf", "Gf", "Bf"}) {
            if (quote.empty() && separator == " " && name[0] == 'Y') name = "Y";
            header += (header.empty() ? before : separator) + quote + name + quote;
          }
          std::string rows;
          for (const char* value : {"", "0", "0", "1", "12.5", "0.2", "0.4", "1.0"})
            rows += *value ? separator + value : "";
          if (order == "no count")
            header += "\n";
          else
            header += "\n5\n";
          const Read found = read(header + rows_of_five(separator, rows));
          EXPECT_EQ(found.cloud.positions, five) << header;
          ASSERT_EQ(found.cloud.normals, std::vector<Vec3f>(5, Vec3f{0, 0, 1})) << header;
          EXPECT_EQ(found.cloud.colors, std::vector<Rgb8>(5, Rgb8{51, 102, 255})) << header;
          EXPECT_EQ(column_names(found.cloud), Names{"Intensity"});
          EXPECT_EQ(found.report.warnings.size(), before[0] == 'A' ? 1u : 0u);
          EXPECT_EQ(found.report.files.at(0).properties.size(), 10u);
        }
}

TEST(Text, HeadersOfKnownProgramsAreUnderstood) {
  const auto expect = [](const std::string& header, const std::string& row, const std::vector<Vec3f>& normals,
                         const std::vector<Rgb8>& colors, const Names& columns) {
    const Read found = read(header + "\n" + row + "\n");
    EXPECT_EQ(found.cloud.positions, std::vector<Vec3d>({{1.5, 2.5, 3.5}})) << header;
    EXPECT_EQ(found.cloud.normals, normals) << header;
    EXPECT_EQ(found.cloud.colors, colors) << header;
    EXPECT_EQ(column_names(found.cloud), columns) << header;
    EXPECT_TRUE(found.report.warnings.empty()) << header;
  };
  expect("//X Y Z R G B Nx Ny Nz", "1.5 2.5 3.5 117 73 49 0 0.6 0.8", {{0, 0.6f, 0.8f}}, {{117, 73, 49}}, {});
  expect("x y z R G B A", "1.5 2.5 3.5 117.0 73.0 49.0 255.0", {}, {{117, 73, 49}}, {});
  expect("X,Y,Z,Red,Green,Blue", "1.5,2.5,3.5,256,512,65535", {}, {{1, 2, 255}}, {});
  expect("\"X\",\"Y\",\"Z\",\"Intensity\",\"ReturnNumber\",\"Classification\"", "1.5,2.5,3.5,37,1,2", {}, {},
         {"Intensity", "ReturnNumber", "Classification"});
  expect("Point ID\tX\tY\tZ", "7\t1.5\t2.5\t3.5", {}, {}, {"Point_ID"});
  expect("%time,field.x,field.y,field.z", "7,1.5,2.5,3.5", {}, {}, {"%time"});
  expect("Punkt;Rechtswert;Hochwert;Hoehe", "7;1,5;2,5;3,5", {}, {}, {"Punkt"});
  expect("E N H", "\"1.5\" \"2.5\" '3.5'", {}, {}, {});
  expect("id;easting;northing;height", "7;1,5;2,5;3,5", {}, {}, {"id"});
  expect(",x,y,z", "0,1.5,2.5,3.5", {}, {}, {"column"});
  expect("x [m] y [m] z [m] intensity [dB]", "1.5 2.5 3.5 -12.5", {}, {}, {"intensity[dB]"});
  expect("z y x ny nx", "3.5 2.5 1.5 0 1", {}, {}, {"ny_2", "nx_2"});
}

TEST(Text, ScannerPositionsAndWeightsAreUsed) {
  const Read found = read("x y z sx sy sz weight\n1 2 3 500000.125 4649000.25 9 0.5\n4 5 6 nan nan nan 2\n");
  ASSERT_EQ(found.cloud.sensors.size(), 2u);
  EXPECT_EQ(found.cloud.sensors[0], (Vec3d{500000.125, 4649000.25, 9}));
  EXPECT_TRUE(std::isnan(found.cloud.sensors[1].x));
  EXPECT_EQ(found.cloud.weights, std::vector<float>({0.5f, 2}));
  expect_refused("x y z weight\n1 2 3 1\n4 5 6 -1\n", {"t.xyz:3:", "weight = -1", ">= 0"});
}

TEST(Text, AHeaderThatDoesNotFitIsSaidAndNotUsed) {
  for (const std::string header : {"x y z i", "//X Y Z Nx Ny Nz", "x,y,z,r,g,b"}) {
    const Read found = read(header + "\n" + rows_of_five());
    EXPECT_EQ(found.cloud.positions, five);
    ASSERT_EQ(found.report.warnings.size(), 1u) << header;
    EXPECT_NE(found.report.warnings[0].find("t.xyz:1:"), std::string::npos);
    EXPECT_NE(found.report.warnings[0].find("names for 3 columns"), std::string::npos) << found.report.warnings[0];
  }
  EXPECT_EQ(read("# x y z of the points, in meters\n" + rows_of_five()).report.warnings.size(), 0u);
  const Read title = read("Rechts Hoch Hoehe\n" + rows_of_five());
  EXPECT_EQ(title.cloud.positions, five);
  ASSERT_EQ(title.report.warnings.size(), 1u);
  EXPECT_NE(title.report.warnings[0].find("'Rechts Hoch Hoehe'"), std::string::npos);
  expect_refused("lat,lon,height\n50.1,7.5,100\n", {"t.csv:1:", "angles"}, "t.csv");
}

TEST(Text, NamesThatAreRepeatedAreSaid) {
  const Read found = read("x y z x intensity intensity\n1 2 3 4 5 6\n");
  EXPECT_EQ(found.cloud.positions, std::vector<Vec3d>({{1, 2, 3}}));
  EXPECT_EQ(column_names(found.cloud), Names({"x_2", "intensity", "intensity_2"}));
  ASSERT_EQ(found.report.warnings.size(), 1u);
  EXPECT_NE(found.report.warnings[0].find("'x', 'intensity' more than once"), std::string::npos);
}

TEST(Text, ANamedColumnOfTextIsPassedOver) {
  const Read found = read("x,y,z,date,class\n1,2,3,2020-01-01,2\n4,5,6,\"Jan, 2nd\",ground\n7,8,9,-,5\n", "t.csv");
  EXPECT_EQ(found.cloud.size(), 3u);
  EXPECT_EQ(column_names(found.cloud), Names{"class"});
  EXPECT_EQ(found.cloud.columns[0].values[2], 5);
  ASSERT_EQ(found.report.warnings.size(), 2u);
  EXPECT_NE(found.report.warnings[0].find("t.csv:2: column 'date' holds '2020-01-01'"), std::string::npos);
  EXPECT_NE(found.report.warnings[1].find("t.csv:3: column 'class' holds 'ground'"), std::string::npos);
  expect_refused("x,y,z\n1,2,high\n", {"t.csv:2:", "column 3 = 'high'"}, "t.csv");
}

TEST(Text, AHeaderThatComesAgainIsPassedOver) {
  const std::string one = "x,y,z,i\n1,2,3,4\n5,6,7,8\n";
  EXPECT_EQ(read(one + one, "t.csv").cloud.size(), 4u);
}

TEST(Text, TheUsersColumnsOverrideAll) {
  const Read found = read("z y x\n" + rows_of_five(" ", " 9 text 0 0 1"), "t.xyz", "x, y, z, -, -, nx, ny, nz");
  EXPECT_EQ(found.cloud.positions, five);
  EXPECT_EQ(found.cloud.normals, std::vector<Vec3f>(5, Vec3f{0, 0, 1}));
  EXPECT_TRUE(found.cloud.columns.empty());
  EXPECT_EQ(read("P1 1 2 3\nP2 4 5 6\n", "t.xyz", "-,y,x,z").cloud.positions,
            std::vector<Vec3d>({{2, 1, 3}, {5, 4, 6}}));
  EXPECT_EQ(column_names(read("1 2 3 4\n", "t.xyz", "time,x,y,z").cloud), Names{"time"});
  for (const std::string columns : {"x,y", "a,b,c", "-", ",", "x,y,z,X", "x,y,z,i,i"})
    EXPECT_THROW(read("1 2 3 4 5\n", "t.xyz", columns), ParameterError) << columns;
  expect_refused("#\n1 2 3 4\n", {"t.xyz:2:", "4 columns, must be 3"}, "t.xyz", "x,y,z");
  expect_refused("1 2 3 4\n", {"t.xyz:1:", "4 columns, must be 5"}, "t.xyz", "x,y,z,a,b");
  expect_refused("1 2 3\n1 2\n", {"t.xyz:2:", "2 columns, must be 3 as --columns"}, "t.xyz", "x,y,z");
}

TEST(Text, CountsBeginScans) {
  const Read found = read("2\n0 0 0 5\n1 1 1 6\n0\n1\n2 2 2 7\n", "p.pts");
  EXPECT_EQ(found.cloud.size(), 3u);
  ASSERT_EQ(found.cloud.scans.size(), 2u);
  EXPECT_EQ(found.cloud.scans[0].end, 2u);
  EXPECT_EQ(found.cloud.scans[1].begin, 2u);
  EXPECT_EQ(found.cloud.scans[1].end, 3u);
  EXPECT_EQ(found.cloud.scans[1].name, "p");
  EXPECT_TRUE(found.report.warnings.empty());
  expect_refused("2\n1 2 3\n1\n4 5 6\n", {"t.xyz:3:", "1 samples, must be 2 as the count in line 1"});
  expect_refused("1\n1 2 3\n4 5 6\n1\n4 5 6\n", {"t.xyz:4:", "2 samples, must be 1"});
  expect_refused("1 2 3\n1\n4 5 6\n", {"t.xyz:2:", "must come first"});
  expect_refused("3\n2\n1 2 3\n", {"t.xyz:2:", "0 samples, must be 3"});
  expect_refused("-1\n1 2 3\n", {"t.xyz:1:", "'-1'"});
  expect_refused("1 2 3\n0.5\n", {"t.xyz:2:", "'0.5'"});
}

TEST(Text, ACountThatDiffersFromTheLastRowsIsSaid) {
  for (const std::string count : {"4", "6", "1000000000000"}) {
    const Read found = read(count + "\n" + rows_of_five(), "t.pts");
    EXPECT_EQ(found.cloud.positions, five);
    ASSERT_EQ(found.report.warnings.size(), 1u);
    EXPECT_NE(found.report.warnings[0].find("t.pts:1: count = "), std::string::npos);
    EXPECT_NE(found.report.warnings[0].find("but 5 samples follow"), std::string::npos);
  }
}

TEST(Text, NormalsMayFollowAllPositions) {
  const Read found = read("2\n1 2 3\n4 5 6\n0 0 1\n0 0.6 -0.8\n", "t.pwn");
  EXPECT_EQ(found.cloud.positions, std::vector<Vec3d>({{1, 2, 3}, {4, 5, 6}}));
  EXPECT_EQ(found.cloud.normals, std::vector<Vec3f>({{0, 0, 1}, {0, 0.6f, -0.8f}}));
  EXPECT_EQ(found.cloud.scans.at(0).end, 2u);
  EXPECT_TRUE(found.report.warnings.empty());
  expect_refused("2\n1 2 3\n4 5 6\n7 8 9\n0 0.6 -0.8\n", {"t.pwn:1:", "count = 2", "normals of length 1"}, "t.pwn");
  EXPECT_EQ(read("1 2 3 0 0 7\n4 5 6 1 2 3\n", "t.npts").cloud.normals, std::vector<Vec3f>({{0, 0, 7}, {1, 2, 3}}));
  EXPECT_EQ(read("1 2 3 0 0 1\n4 5 6 1 0 0\n", "t.xyzrgb").cloud.colors, std::vector<Rgb8>({{0, 0, 255}, {255, 0, 0}}));
}

TEST(Text, RowsOfOtherLengthsAreRefused) {
  expect_refused("1 2 3\n\n# c\n4 5\n", {"t.xyz:4:", "2 columns, must be 3 as in line 1"});
  expect_refused("1 2 3\n4 5 6 7\n", {"t.xyz:2:", "4 columns, must be 3"});
  expect_refused("1,2,3\n4,5", {"t.xyz:2:", "2 columns, must be 3"});
  expect_refused("x y z\n1 2 3\n4 5 6 7\n", {"t.xyz:3:", "4 columns, must be 3 as the header names"});
  expect_refused("1 2\n3 4\n", {"t.xyz:1:", "2 columns, must be at least 3"});
  std::string wide;
  for (int i = 0; i < 300; ++i) wide += "1 ";
  EXPECT_EQ(read(wide).cloud.columns.size(), 297u);
  for (int i = 0; i < 1000; ++i) wide += "1 ";
  expect_refused(wide, {"t.xyz:1:", "1000 columns", "--columns"});
  EXPECT_EQ(column_names(read(wide, "t.xyz", "x,y,z,a").cloud), Names{"a"});
}

TEST(Text, Utf16IsConverted) {
  std::string text = "X;Y;Z;Höhe\n" + rows_of_five(";", ";7");
  for (const bool big : {false, true})
    for (const bool marked : {false, true}) {
      std::string bytes = marked ? (big ? "\xFE\xFF" : "\xFF\xFE") : "";
      for (size_t i = 0; i < text.size(); ++i) {
        char low = text[i];
        if (low == '\xC3') low = static_cast<char>(text[++i] + 0x40);
        bytes += big ? '\0' : low;
        bytes += big ? low : '\0';
      }
      const Read found = read(bytes, "t.csv");
      EXPECT_EQ(found.cloud.positions, five);
      EXPECT_EQ(found.report.files.at(0).properties.at(3), "Höhe");
    }
}

TEST(Text, WhatIsNoTextIsRefused) {
  std::string bytes;
  Random random(1);
  for (int i = 0; i < 2000; ++i) bytes += static_cast<char>(random.uniform() * 256);
  expect_refused(bytes, {"t.xyz", "must be text"});
  expect_refused(std::string("1 2 3\n\0 5 6\n", 12), {"byte 6", "must be text"});
  expect_refused("C 0 0 0\nH 0 0 1\n", {"t.xyz:1:", "column 1 = 'C'", "--columns"});
  expect_refused("ncols 3\nnrows 2\n1 2 3\n4 5 6\n", {"t.asc:1:", "grid of heights"}, "t.asc");
  expect_refused("P1 1 2 3\n5 6 7 8\n", {"t.xyz:1:", "column 1 = 'P1'"});
  expect_refused("x y z\n", {"holds no samples"});
  expect_refused("5\n", {"holds no samples"});
  EXPECT_EQ(read("1 2 3\n4 5 6\n\x1A").cloud.size(), 2u);
}

TEST(Text, NonFiniteSamplesAreDroppedAndCounted) {
  const Read found = read("1 nan 3\n4 5 6\n7 8 -inf\n+1e1 1.#QNAN 2\n");
  EXPECT_EQ(found.cloud.positions, std::vector<Vec3d>({{4, 5, 6}}));
  EXPECT_EQ(found.report.dropped(), 3u);
  EXPECT_EQ(found.cloud.scans.at(0).end, 1u);
}

/// Chunks of lines are read by all threads: cloud, report and errors are those of one thread.
TEST(Text, IsReadTheSameOnAnyNumberOfThreads) {
  constexpr size_t count = test::sanitized ? 20000 : 70000;
  Random random(1);
  std::vector<std::string> rows;
  for (size_t i = 0; i < count; ++i)
    rows.push_back(fmt::format("{} {:.4f} {:e} {}", random.uniform(), random.normal(), random.normal(), i % 7));
  const auto outcome = [&](const std::string& text, int threads) {
    try {
      const Read found = read(text, "t.xyz", {}, threads);
      std::vector<size_t> ends;
      for (const Scan& scan : found.cloud.scans) ends.push_back(scan.end);
      return std::tuple(found.cloud.positions, found.cloud.columns.at(0).values, ends, found.report.warnings,
                        std::string());
    } catch (const InputError& error) {
      const std::string what = error.what();
      return std::tuple(std::vector<Vec3d>(), std::vector<float>(), std::vector<size_t>(), std::vector<std::string>(),
                        what.substr(what.find("t.xyz")));
    }
  };
  const auto expect_same = [&](const std::string& line_end, const std::string& complaint) {
    std::string text;
    for (const std::string& row : rows) text += row + line_end;
    const auto expected = outcome(text, 1);
    const std::string& error = std::get<4>(expected);
    EXPECT_EQ(error.empty(), complaint.empty()) << error;
    EXPECT_NE(error.find(complaint), std::string::npos) << error;
    EXPECT_EQ(std::get<0>(expected).size(), error.empty() ? count : 0);
    for (const int threads : {2, 3, 8}) EXPECT_TRUE(outcome(text, threads) == expected) << threads << complaint;
  };
  expect_same("\n", "");
  expect_same("\r\n", "");
  expect_same("\r", "");
  expect_same(" # said\n\n", "");
  const std::string good = rows[count / 2];
  rows[count / 2] = "1 2 3";
  expect_same("\n", fmt::format("t.xyz:{}: 3 columns", count / 2 + 1));
  rows[count / 2] = "1 2 3 x";
  expect_same("\r\n", fmt::format("t.xyz:{}: column 4 = 'x'", count / 2 + 1));
  rows[count / 2] = good;
  rows[0] = fmt::format("{}\n{}", count / 2, rows[0]);
  rows[count / 2] = fmt::format("{}\n{}", count - count / 2, good);
  expect_same("\n", "");
}

}  // namespace TEST_FILE
}  // namespace soapfilm
