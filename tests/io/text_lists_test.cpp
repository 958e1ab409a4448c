// Text whose rows end with lists, and headers that name positions in other words or not at all.
#include <fmt/format.h>

#include "files.h"
#include "soapfilm/core/random.h"
#include "soapfilm/core/vec.h"
#include "soapfilm/io.h"

namespace soapfilm {
namespace TEST_FILE {

using Names = std::vector<std::string>;

struct Read {
  PointCloud cloud;
  ReadReport report;
  Names columns;
};

Read read(const std::string& text, const std::string& columns = {}, const std::string& name = "t.txt") {
  const TemporaryFolder folder;
  Read result;
  ReadOptions options;
  options.columns = columns;
  result.cloud = read_points(folder.write(name, text), &result.report, Context(1), options);
  for (const Column& column : result.cloud.columns) result.columns.push_back(column.name);
  return result;
}

/// COLMAP's points3D.txt: a list of images and features behind each point.
std::string tracks(size_t rows) {
  Random random(5);
  std::string text;
  for (size_t i = 0; i < rows; ++i) {
    text += fmt::format("{} {} 2.5 {} 10 20 30 0.75", 63390 - 7 * i, 0.125 * static_cast<double>(i),
                        3.5 - 0.25 * static_cast<double>(i * i % 5));
    for (size_t k = 0; k < 2 + (i * i) % 5; ++k) text += fmt::format(" {} {}", k, random.uniform() < 0.5 ? 17 : 18);
    text += "\n";
  }
  return text;
}

const std::string colmap =
    "# 3D point list with one line of data per point:\n"
    "#   POINT3D_ID, X, Y, Z, R, G, B, ERROR, TRACK[] as (IMAGE_ID, POINT2D_IDX)\n"
    "# Number of points: 3, mean track length: 3.3\n";

TEST(TextLists, TheFixedColumnsBeforeAListAreRead) {
  for (const size_t rows : {1u, 3u, 30u}) {
    const Read found = read(colmap + tracks(rows));
    ASSERT_EQ(found.cloud.size(), rows);
    EXPECT_EQ(found.cloud.positions[0], (Vec3d{0, 2.5, 3.5}));
    EXPECT_EQ(found.cloud.colors, std::vector<Rgb8>(rows, Rgb8{10, 20, 30}));
    EXPECT_EQ(found.columns, (Names{"POINT3D_ID", "ERROR"}));
    ASSERT_EQ(found.report.warnings.size(), 1u);
    EXPECT_NE(found.report.warnings[0].find("the first 8"), std::string::npos) << found.report.warnings[0];
  }
}

TEST(TextLists, TheOptionNamesTheFixedColumnsAlone) {
  const Read found = read(tracks(30), "id,x,y,z,red,green,blue,error");
  EXPECT_EQ(found.cloud.positions[1], (Vec3d{0.125, 2.5, 3.25}));
  EXPECT_EQ(found.columns, (Names{"id", "error"}));
  EXPECT_TRUE(found.report.warnings.empty());
  EXPECT_EQ(read(tracks(30), "-,x,y,z").cloud.positions, found.cloud.positions);
  // A table of as many columns everywhere wants a name for each, and a broken row is no list.
  expect_refusal<InputError>([] { read("1 2 3 4\n2 3 4 5\n3 4 5 6\n", "x,y,z"); }, {"4 columns, must be 3"});
  std::string broken;
  for (int i = 0; i < 40; ++i) broken += i == 7 ? "1 2 3 4 5 6\n" : "1 2 3\n";
  expect_refusal<InputError>([&] { read(broken); }, {"t.txt:8:", "6 columns, must be 3"});
}

TEST(TextLists, EmptyFieldsAtTheEndAreNoShorterRows) {
  std::string text;
  for (int i = 0; i < 30; ++i)
    text += fmt::format("{},2.5,3.5,{}\n", i * 7 % 11, i % 3 == 0 ? ",," : i % 3 == 1 ? "4," : "4,5");
  const Read found = read("x,y,z,a,b\n" + text, {}, "t.csv");
  EXPECT_EQ(found.cloud.size(), 30u);
  EXPECT_EQ(found.columns, (Names{"a", "b"}));
  EXPECT_TRUE(found.report.warnings.empty());
}

TEST(TextHeaders, PositionsHaveManyNames) {
  for (const std::string names : {"Point:0,Point:1,Point:2", "Points:0,Points:1,Points:2", "Points_0,Points_1,Points_2",
                                  "X_0,Y_0,Z_0", "E,N,H", "Easting,Northing,Height", "East (m),North (m),Elev (m)",
                                  "Rechtswert,Hochwert,H\xC3\xB6he", "X_m,Y_m,Z_m", "coords_0,coords_1,coords_2"}) {
    const Read found = read(names + ",photons,reflectivity,channel\n1.5,2.5,3.5,72,105,3\n2.5,3.5,1.5,21,50,4\n");
    EXPECT_EQ(found.cloud.positions[0], (Vec3d{1.5, 2.5, 3.5})) << names;
    EXPECT_EQ(found.columns, (Names{"photons", "reflectivity", "channel"})) << names;
    EXPECT_TRUE(found.cloud.colors.empty());
    EXPECT_TRUE(found.report.warnings.empty()) << names << found.report.warnings[0];
  }
  const Read paraview = read(
      "Points:0,Points:1,Points:2,Normals:0,Normals:1,Normals:2,RGB:0,RGB:1,RGB:2\n"
      "1,2,3,0,0,1,10,20,30\n4,5,6,0,0,1,255,20,30\n");
  EXPECT_EQ(paraview.cloud.normals.at(0), (Vec3f{0, 0, 1}));
  EXPECT_EQ(paraview.cloud.colors.at(0), (Rgb8{10, 20, 30}));
  // Beside x y z they are a sensor's.
  EXPECT_EQ(read("x y z x0 y0 z0\n1 2 3 4 5 6\n").cloud.sensors.at(0), (Vec3d{4, 5, 6}));
}

TEST(TextHeaders, NamesAreKeptWhereNoneIsAPosition) {
  std::string rows;
  for (int i = 0; i < 30; ++i) rows += fmt::format("{},{},{},{},{},{}\n", 0.5 * i, 0.25 * i, i % 7, i, i * 7 % 256, 3);
  const Read found = read("first,second,third,Signal Photons,Reflectivity,Channel\n" + rows);
  EXPECT_EQ(found.cloud.positions[1], (Vec3d{0.5, 0.25, 1}));
  EXPECT_EQ(found.columns, (Names{"Signal_Photons", "Reflectivity", "Channel"}));
  EXPECT_TRUE(found.cloud.colors.empty());
  ASSERT_EQ(found.report.warnings.size(), 1u);
  EXPECT_NE(found.report.warnings[0].find("--columns"), std::string::npos);
  const Read timed = read("time,p,q,s\n1,1.5,2.5,3.5\n2,2.5,3.5,4.5\n");
  EXPECT_EQ(timed.cloud.positions[0], (Vec3d{1.5, 2.5, 3.5}));
  EXPECT_EQ(timed.columns, Names{"time"});
}

TEST(TextHeaders, AnIncompleteColorIsSaid) {
  const Read found = read("x y z red green\n1 2 3 4 5\n2 3 4 5 6\n");
  EXPECT_TRUE(found.cloud.colors.empty());
  ASSERT_EQ(found.report.warnings.size(), 1u);
  EXPECT_NE(found.report.warnings[0].find("'red', 'green'"), std::string::npos);
  EXPECT_TRUE(read("x y z r\n1 2 3 4\n2 3 4 5\n").report.warnings.empty());  // a range
}

TEST(TextHeaders, NamesBeyondAsciiAreKept) {
  EXPECT_EQ(read("x;y;z;H\xC3\xB6he \xE2\x84\x83\n1;2;3;4\n").columns, Names{"H\xC3\xB6he_\xE2\x84\x83"});
  EXPECT_EQ(read("x;y;z;H\xF6he\n1;2;3;4\n").columns, Names{"H\xC3\xB6he"});  // Latin-1
}

}  // namespace TEST_FILE
}  // namespace soapfilm
