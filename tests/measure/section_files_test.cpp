#include "tools/measure/section_files.h"

#include <gtest/gtest.h>

#include <sstream>

#include "measure/solids.h"
#include "soapfilm/error.h"
#include "support/process.h"

namespace soapfilm::test {
namespace TEST_FILE {

class SectionFiles : public testing::Test {
 protected:
  /// Two levels of a box far away, of a third.
  SectionFiles() {
    const Mesh box = box_mesh({500000, 4649000, 100}, {500002, 4649003, 104});
    for (const double z : {101.0, 102.5}) sections.push_back(section(box, {{0, 0, z}, {0, 0, 1}}));
  }
  std::string written(const std::string& name) {
    write_sections(folder.file(name), sections);
    return read_file(folder.file(name));
  }
  static size_t count(const std::string& text, const std::string& what) {
    size_t found = 0;
    for (size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + what.size())) ++found;
    return found;
  }
  size_t points() const { return sections[0].contours[0].points.size() + sections[1].contours[0].points.size(); }

  TemporaryFolder folder;
  std::vector<Section> sections;
};

TEST_F(SectionFiles, CsvHasEachPointToItsLastDigit) {
  std::istringstream lines(written("s.csv"));
  std::string line;
  std::getline(lines, line);
  EXPECT_EQ(line, "section,contour,closed,x,y,z");
  std::vector<Vec3d> read;
  while (std::getline(lines, line)) {
    int s = 0, c = 0, closed = 0;
    Vec3d p;
    ASSERT_EQ(std::sscanf(line.c_str(), "%d,%d,%d,%lf,%lf,%lf", &s, &c, &closed, &p.x, &p.y, &p.z), 6) << line;
    EXPECT_EQ(closed, 1);
    EXPECT_EQ(c, 1);
    EXPECT_EQ(p.z, s == 1 ? 101.0 : 102.5);
    read.push_back(p);
  }
  std::vector<Vec3d> expected = sections[0].contours[0].points;
  expected.insert(expected.end(), sections[1].contours[0].points.begin(), sections[1].contours[0].points.end());
  EXPECT_EQ(read, expected);
}

TEST_F(SectionFiles, DxfIsPairsOfCodesAndValuesWithALayerForEachSection) {
  const std::string text = written("s.dxf");
  EXPECT_EQ(count(text, "\n") % 2, 0u);
  EXPECT_EQ(count(text, "\nPOLYLINE\n8\nSECTION_1\n"), 1u);
  EXPECT_EQ(count(text, "\nPOLYLINE\n8\nSECTION_2\n"), 1u);
  EXPECT_EQ(count(text, "\nVERTEX\n"), points());
  EXPECT_EQ(count(text, "\n70\n9\n"), 2u) << "closed, in 3D";
  EXPECT_EQ(text.substr(text.size() - 6), "0\nEOF\n");
  EXPECT_NE(text.find("\n10\n500002\n"), std::string::npos);
  sections[1].contours[0].closed = false;
  EXPECT_EQ(count(written("open.dxf"), "\n70\n8\n"), 1u);
}

TEST_F(SectionFiles, SvgShowsThemInTheirFrameWithYUp) {
  const std::string text = written("s.svg");
  EXPECT_EQ(count(text, "<g id="), 2u);
  EXPECT_EQ(count(text, "M"), 2u);
  EXPECT_EQ(count(text, "Z\""), 2u);
  EXPECT_NE(text.find("x = 500000 + x of the drawing, y = 4649003 - y of it"), std::string::npos);
  double x = 0, y = 0, width = 0, height = 0;
  ASSERT_EQ(std::sscanf(text.c_str() + text.find("viewBox="), "viewBox=\"%lf %lf %lf %lf", &x, &y, &width, &height), 4);
  EXPECT_NEAR(width - 2 * -x, 2, 1e-6);
  EXPECT_NEAR(height - 2 * -y, 3, 1e-6);
}

TEST_F(SectionFiles, OtherExtensionsAreRefused) {
  EXPECT_THROW(write_sections(folder.file("s.pdf"), sections), ParameterError);
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

}  // namespace TEST_FILE
}  // namespace soapfilm::test
