// Columns that no header names: what their values say.
#include <fmt/format.h>

#include "files.h"
#include "samples.h"
#include "soapfilm/core/vec.h"
#include "soapfilm/io.h"

namespace soapfilm {
namespace TEST_FILE {

constexpr int rows = 40;

/// `rows` lines in no order of any coordinate: `row(i, random)` gives each, "{x} {y} {z}" in it are a position's.
template <class Row>
std::string table(Row&& row) {
  Random random(7);
  std::string text;
  for (int i = 0; i < rows; ++i) text += row(i, random) + "\n";
  return text;
}

std::string position(Random& random) {
  return fmt::format("{:.3f} {:.3f} {:.3f}", random.normal(), random.normal(), random.normal());
}

std::string unit(Random& random, double length = 1) {
  const Vec3d n = length * normalized(Vec3d{random.normal(), random.normal(), random.normal()});
  return fmt::format("{:.4f} {:.4f} {:.4f}", n.x, n.y, n.z);
}

std::string color(Random& random, int range = 256) {
  const auto channel = [&] { return static_cast<int>(random.uniform() * range); };
  return fmt::format("{} {} {}", channel(), channel(), channel());
}

std::string float_color(Random& random) {
  return fmt::format("{:.4f} {:.4f} {:.4f}", random.uniform(), random.uniform(), random.uniform());
}

std::string whole(Random& random, int range) { return std::to_string(static_cast<int>(random.uniform() * range)); }

/// What was found, in the order of the file's columns, and the number of warnings.
std::string found(const std::string& text, size_t warnings = 0, const std::string& name = "t.xyz") {
  const TemporaryFolder folder;
  ReadReport report;
  const PointCloud cloud = read_points(folder.write(name, text), &report);
  std::string names;
  for (const std::string& property : report.files.at(0).properties) names += (names.empty() ? "" : " ") + property;
  EXPECT_EQ(report.warnings.size(), warnings) << names << ": " << (report.warnings.empty() ? "" : report.warnings[0]);
  const auto has = [&](const char* word) { return (" " + names + " ").find(fmt::format(" {} ", word)) != names.npos; };
  EXPECT_EQ(cloud.normals.size(), has("nx") ? cloud.size() : 0) << names;
  EXPECT_EQ(cloud.colors.size(), has("red") ? cloud.size() : 0) << names;
  for (const Column& column : cloud.columns) {
    EXPECT_EQ(column.values.size(), cloud.size());
    EXPECT_TRUE(has(column.name.c_str())) << names;
  }
  return names;
}

TEST(TextColumns, NormalsHaveTheLengthsOfNormals) {
  EXPECT_EQ(found(table([](int, Random& r) { return position(r) + " " + unit(r); })), "x y z nx ny nz");
  EXPECT_EQ(found(table([](int, Random& r) { return position(r) + " " + unit(r, 127); })), "x y z nx ny nz");
  EXPECT_EQ(found(table([](int i, Random& r) { return position(r) + " " + (i == 5 ? "0 0 0" : unit(r)); })),
            "x y z nx ny nz");
  EXPECT_EQ(found(table([](int i, Random& r) { return position(r) + " " + (i == 5 ? "9 9 9" : unit(r)); })),
            "x y z nx ny nz");
  EXPECT_EQ(found("1 2 3 0 0 -1\n"), "x y z nx ny nz");
  EXPECT_EQ(found("1 2 3 0 0 1\n4 5 6 1 0 0\n"), "x y z nx ny nz");
  EXPECT_EQ(found(table([](int, Random& r) { return position(r) + " " + unit(r, 1 + r.uniform()); }), 1),
            "x y z column_4 column_5 column_6");
}

TEST(TextColumns, ScannerPositionsAreNoNormals) {
  EXPECT_EQ(found(table([](int, Random& r) { return position(r) + " -10.5 20.25 1.5"; }), 1),
            "x y z column_4 column_5 column_6");
  EXPECT_EQ(found(table([](int i, Random& r) { return position(r) + fmt::format(" {:.2f} -812.5 1.5", 0.1 * i); }), 1),
            "x y z column_4 column_5 column_6");
}

TEST(TextColumns, ColorsAreOfOneRange) {
  for (const int range : {256, 65536})
    EXPECT_EQ(found(table([&](int, Random& r) { return position(r) + " " + color(r, range); })),
              "x y z red green blue");
  EXPECT_EQ(found(table([](int, Random& r) { return position(r) + " " + float_color(r); })), "x y z red green blue");
  EXPECT_EQ(found(table([](int, Random& r) { return position(r) + " " + color(r) + ".0"; })), "x y z red green blue");
  EXPECT_EQ(found("1 2 3 0 0 0\n4 5 6 255 1 2\n"), "x y z red green blue");
}

TEST(TextColumns, OneOddRowDoesNotChangeWhatAFileIs) {
  const TemporaryFolder folder;
  for (const std::string odd : {"-1 -1 -1", "nan nan nan", "300 20 10", "0.5 20 10"}) {
    const std::string text = table([&](int i, Random& r) { return position(r) + " " + (i == 9 ? odd : color(r)); });
    const PointCloud cloud = read_points(folder.write("t.xyz", text));
    ASSERT_EQ(cloud.colors.size(), cloud.size()) << odd;
    EXPECT_TRUE(cloud.normals.empty());
    const Rgb8 expected = odd[1] == '.' ? Rgb8{1, 20, 10} : Rgb8{128, 128, 128};
    EXPECT_EQ(cloud.colors[9], expected) << odd;
    EXPECT_GT(std::max({cloud.colors[8][0], cloud.colors[8][1], cloud.colors[8][2]}), 50) << odd;
  }
  EXPECT_EQ(found("1.5 2 3 117 73 49\n2.5 2 3 91 87 74\n1.7 3 2 74 59 56\n2.1 2 4 103 56 38\n1.2 3 4 -1 -1 -1\n", 1),
            "x y z red green blue");
}

TEST(TextColumns, AttributesAreNeitherNormalsNorColors) {
  for (const int range : {256, 4096, 65536})
    EXPECT_EQ(found(table([&](int, Random& r) {
                      return fmt::format("{} {} {} {}", position(r), whole(r, range), 1 + (whole(r, 3)[0] - '0'), 2);
                    }),
                    1),
              "x y z column_4 column_5 column_6");
  EXPECT_EQ(found("1 2 3 4 5\n", 1), "x y z column_4 column_5");
  EXPECT_EQ(found("1.5 2 3 1000 1 2\n2.5 2 3 1037 1 2\n1.7 3 2 1074 1 2\n2.1 2 4 1111 1 2\n1.2 3 4 1148 1 2\n", 1),
            "x y z column_4 column_5 column_6");
}

TEST(TextColumns, AFourthColumnAloneIsAnIntensity) {
  EXPECT_EQ(found("1 2 3 700\n"), "x y z intensity");
  EXPECT_EQ(found(table([](int, Random& r) { return position(r) + " " + whole(r, 4096); })), "x y z intensity");
}

TEST(TextColumns, ColorsHaveAnIntensityBeforeOrOpacityAfterThem) {
  const auto row = [](const std::string& before, const std::string& after) {
    return found(table([&](int, Random& r) { return position(r) + " " + before + color(r) + after; }));
  };
  EXPECT_EQ(row("-90 ", ""), "x y z intensity red green blue");
  EXPECT_EQ(row("", " 255"), "x y z red green blue alpha");
  EXPECT_EQ(found(table([](int, Random& r) { return position(r) + " " + whole(r, 256) + " " + color(r); })),
            "x y z intensity red green blue");
  EXPECT_EQ(found(table([](int, Random& r) { return position(r) + " " + float_color(r) + " 1"; })),
            "x y z red green blue alpha");
  EXPECT_EQ(found(table([](int, Random& r) { return position(r) + " " + color(r) + " " + whole(r, 12); }), 1),
            "x y z red green blue intensity");
}

TEST(TextColumns, NormalsAndColorsComeInEitherOrder) {
  const auto both = [](auto&& row) { return found(table(row)); };
  EXPECT_EQ(both([](int, Random& r) { return position(r) + " " + unit(r) + " " + color(r); }),
            "x y z nx ny nz red green blue");
  EXPECT_EQ(both([](int, Random& r) { return position(r) + " " + color(r) + " " + unit(r); }),
            "x y z red green blue nx ny nz");
  EXPECT_EQ(both([](int, Random& r) { return position(r) + " " + float_color(r) + " " + unit(r); }),
            "x y z red green blue nx ny nz");
  EXPECT_EQ(both([](int, Random& r) { return position(r) + " " + whole(r, 256) + " " + color(r) + " " + unit(r); }),
            "x y z intensity red green blue nx ny nz");
  EXPECT_EQ(both([](int, Random& r) { return position(r) + " " + unit(r) + " -7.5 " + color(r); }),
            "x y z nx ny nz intensity red green blue");
  EXPECT_EQ(found(table([](int, Random& r) { return position(r) + " " + unit(r) + " 0.25"; }), 1),
            "x y z nx ny nz column_7");
}

TEST(TextColumns, APointsNumberMayComeFirst) {
  for (const int first : {0, 1, 1001}) {
    const auto numbered = [&](int i, const std::string& row) { return std::to_string(first + i) + " " + row; };
    EXPECT_EQ(found(table([&](int i, Random& r) { return numbered(i, position(r)); }), 1), "id x y z");
    EXPECT_EQ(found(table([&](int i, Random& r) { return numbered(i + i / 9, position(r)); }), 1), "id x y z");
    EXPECT_EQ(found(table([&](int i, Random& r) { return numbered(i, position(r) + " " + unit(r)); }), 1),
              "id x y z nx ny nz");
    EXPECT_EQ(found(table([&](int i, Random& r) { return numbered(i, position(r) + " " + whole(r, 4096)); }), 1),
              "id x y z intensity");
  }
  const TemporaryFolder folder;
  const PointCloud cloud =
      read_points(folder.write("t.csv", "1,500000.125,2,3\n2,4,5,6\n3,7,8,4649000.125\n4,1,2,3\n"));
  EXPECT_EQ(cloud.positions[0], (Vec3d{500000.125, 2, 3}));
  EXPECT_EQ(cloud.positions[2], (Vec3d{7, 8, 4649000.125}));
  EXPECT_EQ(cloud.columns.at(0).name, "id");
  EXPECT_TRUE(cloud.columns.at(0).is_label);
  // A profile's x may count as well, where normals or colors follow.
  EXPECT_EQ(found(table([](int i, Random& r) { return fmt::format("{} 0.5 1 {}", i, unit(r)); })), "x y z nx ny nz");
}

TEST(TextColumns, ATimeMayComeFirst) {
  const auto on_the_way = [](int i) {
    return fmt::format("{:.3f} {:.3f} {:.3f}", 0.31 * i, 5 - 0.17 * i, 0.01 * i * i);
  };
  // It looks like a line scanner's x, so it is taken for x, and said.
  EXPECT_EQ(found(table([&](int i, Random&) { return fmt::format("{:.4f} {}", 1000 + 0.05 * i, on_the_way(i)); }), 1),
            "x y z intensity");
  // Sorted by x: the intensity is whole, or what it is cannot be told.
  const auto sorted = [](int i, Random& r) {
    return fmt::format("{:.4f} {:.3f} {:.3f}", 0.05 * i, r.normal(), r.normal());
  };
  EXPECT_EQ(found(table([&](int i, Random& r) { return sorted(i, r) + " " + whole(r, 255); })), "x y z intensity");
  EXPECT_EQ(found(table([&](int i, Random& r) { return fmt::format("{} {:.3f}", sorted(i, r), -9 * r.uniform()); }), 1),
            "x y z intensity");
}

TEST(TextColumns, ALineScannersXIsNoTime) {
  for (const int count : {8, rows})
    for (const int more : {1, 2, 4}) {
      std::string text;
      for (int i = 0; i < count; ++i) {
        text += fmt::format("{:.3f} {:.3f} {:.3f}", 371349.85 + 0.01 * i, 796969.999 - 0.002 * i, 65.5 + 0.01 * i * i);
        for (int k = 0; k < more; ++k) text += fmt::format(" {:.3f}", -20.25 + 0.03 * i + k * i % 3);
        text += "\n";
      }
      const TemporaryFolder folder;
      ReadReport report;
      const PointCloud cloud = read_points(folder.write("t.xyz", text), &report);
      EXPECT_EQ(cloud.positions[0], (Vec3d{371349.85, 796969.999, 65.5}));
      ASSERT_FALSE(report.warnings.empty());
      EXPECT_NE(report.warnings[0].find("--columns time,x,y,z"), std::string::npos);
    }
  // Whole numbers in no order, and a few rows that count: it is said what they may be.
  EXPECT_EQ(found(table([](int, Random& r) { return whole(r, 100000) + " " + position(r); }), 1), "x y z intensity");
  EXPECT_EQ(found("1 1.5 2.25 3.125\n2 2.5 2.5 3.5\n3 1.75 3.5 2.875\n", 1), "x y z intensity");
  // A profile's x may count: the fourth column is like an intensity.
  EXPECT_EQ(
      found(table([](int i, Random& r) { return fmt::format("{} 0.5 {:.3f} {}", i, r.normal(), whole(r, 255)); }), 1),
      "x y z intensity");
}

TEST(TextColumns, RowsAndColumnsMayComeFirst) {
  for (const bool row_first : {false, true})
    for (const int height : {2, 12}) {
      std::string text;
      for (int r = 0; r < height; ++r)
        for (int c = 0; c < 20; ++c) {
          const double u = (c - 9.5) / 20, v = (r - 5.5) / 20, t = 500003 + 0.5 * std::sin(9 * u);
          text += fmt::format("{} {} {:.4f} {:.4f} {:.4f}\n", row_first ? r : c, row_first ? c : r, u * t, v * t, t);
        }
      const TemporaryFolder folder;
      ReadReport report;
      const PointCloud cloud = read_points(folder.write("t.xyz", text), &report);
      EXPECT_NEAR(cloud.positions[5].z, 500003 + 0.5 * std::sin(9 * -4.5 / 20), 1e-4);
      ASSERT_TRUE(cloud.scans.at(0).range_grid);
      EXPECT_EQ(cloud.scans[0].range_grid->columns, 20);
      EXPECT_EQ(cloud.scans[0].range_grid->rows, height);
      ASSERT_EQ(report.warnings.size(), 1u);
      EXPECT_NE(report.warnings[0].find("--columns x,y,z"), std::string::npos);
    }
  // A raster of heights with an intensity and a class stays one; so does one with colors.
  std::string raster, colored;
  for (int r = 0; r < 6; ++r)
    for (int c = 0; c < 8; ++c) {
      raster += fmt::format("{} {} {:.2f} {} {}\n", r, c, 0.31 * r * c, 7 * c, 2);
      colored += fmt::format("{} {} {:.2f} {} {} {}\n", r, c, 0.31 * r * c, 7 * c, 20 + r, 30 * r);
    }
  EXPECT_EQ(found(raster, 2), "x y z column_4 column_5");
  EXPECT_EQ(found(colored), "x y z red green blue");
}

TEST(TextColumns, NormalsThatAreNotOrientedAreNormals) {
  EXPECT_EQ(found(table([](int, Random& r) {
              Vec3d n = normalized(Vec3d{r.normal(), r.normal(), r.normal()});
              n = n.z < 0 ? -n : n;
              return fmt::format("{} {:.3f} {:.3f} {:.3f}", position(r), n.x, n.y, n.z);
            })),
            "x y z nx ny nz");
}

}  // namespace TEST_FILE
}  // namespace soapfilm
