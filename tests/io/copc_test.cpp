// COPC: levels of a file that is made here, and of real ones when SOAPFILM_DATA names the data.
#include "soapfilm/io/las/copc.h"

#include "copc_files.h"
#include "files.h"
#include "samples.h"
#include "soapfilm/io.h"
#include "support/real_data.h"

namespace soapfilm {
namespace TEST_FILE {

PointCloud read_levels(const std::string& file, double spacing, ReadReport& report) {
  const TemporaryFolder folder;
  ReadOptions options;
  options.spacing = spacing;
  return read_points(folder.write("a.copc.laz", file), &report, Context(2), options);
}

TEST(Copc, LevelsAreReadUntilPointsAreNearEnough) {
  struct Case {
    double spacing;
    int levels;
    size_t points;
  };
  for (const int pages : {1, 2})
    for (const Case& c : {Case{9, 1, 20}, Case{8, 1, 20}, Case{7.9, 2, 75}, Case{4, 2, 75}, Case{2, 3, 135},
                          Case{1, 4, 235}, Case{1e-9, 4, 235}, Case{0, 4, 235}}) {
      SCOPED_TRACE(c.spacing);
      ReadReport report;
      const PointCloud cloud = read_levels(copc_file(pages), c.spacing, report);
      ASSERT_EQ(cloud.size(), c.points);
      size_t next = 0;
      for (const copc::Node& node : copc::nodes)
        for (uint32_t i = 0; i < node.points && node.level < c.levels; ++i, ++next)
          ASSERT_NEAR(cloud.positions[next].z, node.level, 1e-9);  // in the file's order
      EXPECT_EQ(report.warnings.size(), c.points < 235);
    }
}

TEST(Copc, DamagedOctreesGiveAllPointsAndAWarning) {
  const auto expect_all = [](std::string file, size_t place, uint64_t value) {
    put(file, place, value);
    ReadReport report;
    EXPECT_EQ(read_levels(file, 8, report).size(), 235U);
    ASSERT_EQ(report.warnings.size(), 1U);
    EXPECT_NE(report.warnings[0].find("octree"), std::string::npos);
  };
  const std::string file = copc_file(2);
  const size_t info = copc::info_of(file), entries = file.size() - 5 * 32;
  expect_all(file, info + 32, 0);                    // spacing
  expect_all(file, info + 40, file.size() + 1);      // the first page
  expect_all(file, info + 48, ~uint64_t{0});         // its size
  expect_all(file, entries + 16, 12345);             // a chunk that is none
  expect_all(file, entries, 0xffffffff);             // a level below 0
  expect_all(file, entries + 4 * 32 + 16, entries);  // a page that leads back
}

TEST(Copc, RealFilesAreThinnedEvenly) {
  const auto path = real_data("laz/lone-star.copc.laz");
  if (!path) GTEST_SKIP() << "no LAZ files in SOAPFILM_DATA";
  size_t before = 0;
  for (const double spacing : {1., .25, .01}) {
    ReadOptions options;
    options.spacing = spacing;
    const PointCloud cloud = read_points(*path, nullptr, Context(2), options);
    EXPECT_GT(cloud.size(), before);
    before = cloud.size();
    // The box stays that of the file, but for a few of its points' distances.
    const Box3d box = cloud.box(Context(1));
    EXPECT_NEAR(box.lo.x, 515368.6, 3 * spacing + .5);
    EXPECT_NEAR(box.hi.y, 4918381.1, 3 * spacing + .5);
  }
  EXPECT_EQ(before, 518862U);
}

}  // namespace TEST_FILE
}  // namespace soapfilm
