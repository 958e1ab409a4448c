// soapfilm view: the page that it writes, and what it refuses.
#include "tools/view/view.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "support/process.h"

namespace soapfilm::test {
namespace TEST_FILE {

class ViewCommand : public testing::Test {
 protected:
  void SetUp() override {
    std::ofstream(mesh_) << "OFF\n4 4 6\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n";
    std::ofstream(cloud_) << "0 0 0\n1 0 0\n0 1 0\n0 0 1\n";
    if (!has_viewer()) GTEST_SKIP() << "built without the viewer";
  }
  static ProcessResult view(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {SOAPFILM_PROGRAM, "view"});
    unsetenv("DISPLAY");  // no browser opens
    unsetenv("WAYLAND_DISPLAY");
    return run_process(arguments);
  }
  /// Exit code 2, one line with `part`, and no page.
  void expect_refused(const std::vector<std::string>& arguments, const std::string& part) {
    const ProcessResult result = view(arguments);
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_NE(result.err.find(part), std::string::npos) << result.err;
    const size_t line = result.err.rfind("soapfilm: ");  // after the stages' lines
    ASSERT_NE(line, std::string::npos) << result.err;
    EXPECT_EQ(result.err.find('\n', line), result.err.size() - 1) << result.err;
    EXPECT_FALSE(std::filesystem::exists(page_));
  }

  TemporaryFolder folder_;
  std::string mesh_ = folder_.file("a b'$(x).off");
  std::string cloud_ = folder_.file("cloud.xyz");
  std::string page_ = folder_.file("page.html");
};

TEST_F(ViewCommand, WritesOnePageForAll) {
  const ProcessResult result = view({mesh_, cloud_, "--html", page_, "--unit", "mm", "--title", "T<i>t"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(result.out.find("page.html: "), std::string::npos);
  const std::string html = read_file(page_);
  for (const char* part : {"<title>T&lt;i&gt;t</title>", "\"unit\":\"mm\"", "\"name\":\"cloud.xyz\"", "\"up\":\"y\""})
    EXPECT_NE(html.find(part), std::string::npos) << part;
}

TEST_F(ViewCommand, WritesBesideTheFirstFileAndSpareForeignPages) {
  const std::string beside = folder_.file("a b'$(x).html");
  ASSERT_EQ(view({mesh_}).exit_code, 0);
  EXPECT_TRUE(std::filesystem::exists(beside));
  EXPECT_EQ(view({mesh_}).exit_code, 0);  // again over its own page
  std::ofstream(beside) << "<html>mine</html>";
  const ProcessResult result = view({mesh_});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_NE(result.err.find("is no page of soapfilm view"), std::string::npos) << result.err;
  EXPECT_EQ(read_file(beside), "<html>mine</html>");
}

TEST_F(ViewCommand, ShowsTheReportBesideTheMesh) {
  std::ofstream(folder_.file("a b'$(x).report.json")) << R"({"parameters": {}, "warnings": ["look here"]})";
  ASSERT_EQ(view({mesh_, "--html", page_}).exit_code, 0);
  EXPECT_NE(read_file(page_).find("look here"), std::string::npos);
  const std::string other = folder_.file("other.json");
  std::ofstream(other) << R"({"parameters": {}, "input": {"coordinate_system": "EPSG:25832"}})";
  ASSERT_EQ(view({mesh_, "--html", page_, "--report", other}).exit_code, 0);
  const std::string html = read_file(page_);
  EXPECT_EQ(html.find("look here"), std::string::npos);
  EXPECT_NE(html.find("\"up\":\"z\""), std::string::npos);  // maps have z upward
}

TEST_F(ViewCommand, WarnsOfAReportThatIsNone) {
  std::ofstream(folder_.file("a b'$(x).report.json")) << "{\"half\":";
  const ProcessResult result = view({mesh_, "--html", page_});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_NE(result.err.find("is no report of reconstruct"), std::string::npos) << result.err;
}

TEST_F(ViewCommand, AFolderIsOneCloudAndAPatternEachOfItsFiles) {
  const std::string tiles = folder_.file("tiles.2");
  std::filesystem::create_directory(tiles);
  for (const char* name : {"/t_10.xyz", "/t_9.xyz"}) std::filesystem::copy(cloud_, tiles + name);
  ASSERT_EQ(view({tiles + "/", "--columns", "x,y,z"}).exit_code, 0);
  const std::string html = read_file(folder_.file("tiles.2.html"));
  EXPECT_NE(html.find("\"name\":\"tiles.2\""), std::string::npos);
  EXPECT_EQ(html.find("\"name\":\"t_9.xyz\""), std::string::npos);
  ASSERT_EQ(view({tiles + "/t_*", "--html", page_}).exit_code, 0);
  const std::string both = read_file(page_);
  EXPECT_LT(both.find("\"name\":\"t_9.xyz\""), both.find("\"name\":\"t_10.xyz\""));
  EXPECT_NE(both.find("\"name\":\"t_10.xyz\""), std::string::npos);
  std::filesystem::remove(page_);
  expect_refused({tiles + "/u_*", "--html", page_}, "u_*: a pattern that no file matches");
}

TEST_F(ViewCommand, RefusesInOneLine) {
  expect_refused({folder_.file("none.ply"), "--html", page_}, "none.ply");
  expect_refused({mesh_, "--html", page_, "--report", cloud_}, "is no report");
  expect_refused({cloud_, "--html", page_, "--report", mesh_}, "--report is given 1 times");
  expect_refused({mesh_, "--html", page_, "--columns", "x,y,z"}, "none of the files takes it");
  expect_refused({mesh_, "--html", page_, "--up", "w"}, "--up");
  expect_refused({mesh_, "--html", page_, "--triangles", "-1"}, "--triangles");
  expect_refused({mesh_, "--html", folder_.file("no/page.html")}, "no/page.html");
  expect_refused({mesh_, "--html", mesh_}, "is also an input");
}

TEST(ViewWithoutViewer, SaysHowToGetOne) {
  if (has_viewer()) GTEST_SKIP() << "built with the viewer";
  const ProcessResult result = run_process({SOAPFILM_PROGRAM, "view", "mesh.ply"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_NE(result.err.find("this build has no viewer"), std::string::npos) << result.err;
}

}  // namespace TEST_FILE
}  // namespace soapfilm::test
