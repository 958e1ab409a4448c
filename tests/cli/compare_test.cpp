// soapfilm compare as a user runs it.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "soapfilm/core/vec.h"
#include "soapfilm/io.h"
#include "support/program.h"
#include "tools/scanner/sample_surface.h"
#include "tools/scanner/shape.h"
#include "tools/view/view.h"

namespace soapfilm::test {
namespace TEST_FILE {

class CompareCommand : public testing::Test {
 protected:
  CompareCommand() {
    write_mesh(model, make_part()->tessellate(1e-3));
    write_points(scan, sample_surface(*make_part(), 3000, 1));
    write_mesh(larger, make_part({.size = 1.02})->tessellate(1e-3));
  }

  TemporaryFolder folder;
  std::string model = folder.file("model.stl"), scan = folder.file("scan.ply"), larger = folder.file("larger.ply");
};

TEST_F(CompareCommand, TheExitCodeIsTheVerdict) {
  const ProcessResult good = run({"compare", scan, model, "--tolerance", "0.002", "--unit", "mm", "--quiet"});
  EXPECT_EQ(good.exit_code, 0) << good.err;
  EXPECT_EQ(good.err, "");
  for (const char* words :
       {"scan to model", "100.00 % within +-0.002 mm", "verdict            within tolerance: at least 99.00 %"})
    EXPECT_TRUE(contains(good.out, words)) << words << " in\n" << good.out;
  EXPECT_FALSE(contains(good.out, "model to mesh"));
  const ProcessResult bad = run({"compare", larger, model, "--tolerance", "0.002"});
  EXPECT_EQ(bad.exit_code, 4) << bad.err;
  for (const char* words : {"mesh to model", "model to mesh", "NOT within tolerance"})
    EXPECT_TRUE(contains(bad.out, words)) << words << " in\n" << bad.out;
  const ProcessResult none = run({"compare", larger, model});
  EXPECT_EQ(none.exit_code, 0);
  EXPECT_FALSE(contains(none.out, "verdict"));
  EXPECT_EQ(run({"compare", larger, model, "--tolerance", "0.002", "--least", "0.05"}).exit_code, 0);
}

TEST_F(CompareCommand, WritesWhatWasMeasured) {
  const std::string out = folder.file("out.ply"), json = folder.file("out.json"), png = folder.file("out.png");
  const ProcessResult result = run({"compare", larger, model, "--tolerance", "0.002", "-o", out, "--json", json,
                                    "--picture", png, "--range", "0.01"});
  ASSERT_EQ(result.exit_code, 4) << result.err;
  const Mesh colored = read_mesh(out);
  ASSERT_EQ(colored.attributes.size(), 1u);
  EXPECT_EQ(colored.attributes[0].name, "distance");
  EXPECT_EQ(colored.colors.size(), colored.vertices.size());
  const auto facts = nlohmann::json::parse(read_file(json));
  EXPECT_EQ(facts["within_tolerance"], false);
  EXPECT_GT(facts["part_to_model"]["mean"].get<double>(), 0.002);
  EXPECT_GT(facts["model_to_part"]["above"].get<double>(), 0.5);
  EXPECT_EQ(facts["part_to_model"]["histogram"]["counts"].size(), 21u);
  EXPECT_TRUE(facts["alignment"].is_null());
  EXPECT_EQ(read_file(png).substr(1, 3), "PNG");
}

TEST_F(CompareCommand, AlignsAndWritesTheMovedScan) {
  PointCloud moved = read_points(scan);
  for (Vec3d& p : moved.positions) p = {p.x * 0.9998 - p.y * 0.02 + 0.02, p.x * 0.02 + p.y * 0.9998, p.z + 0.01};
  const std::string cloud = folder.file("moved.ply"), out = folder.file("out.ply"), json = folder.file("out.json");
  write_points(cloud, moved);
  EXPECT_EQ(run({"compare", cloud, model, "--tolerance", "0.002"}).exit_code, 4);
  const ProcessResult result =
      run({"compare", cloud, model, "--tolerance", "0.002", "--align", "-o", out, "--json", json});
  ASSERT_EQ(result.exit_code, 0) << result.out << result.err;
  EXPECT_TRUE(contains(result.out, "aligned            turned by 1.14"));
  const PointCloud back = read_points(out), before = read_points(scan);
  for (size_t i = 0; i < back.size(); i += 100) EXPECT_LT(norm(back.positions[i] - before.positions[i]), 1e-3);
  EXPECT_EQ(back.columns.at(0).name, "distance");
  EXPECT_EQ(nlohmann::json::parse(read_file(json))["alignment"]["matrix"].size(), 4u);
}

TEST_F(CompareCommand, WritesAPageWhereTheBuildHasTheViewer) {
  const std::string html = folder.file("out.html");
  const ProcessResult result = run({"compare", scan, model, "--html", html});
  ASSERT_EQ(result.exit_code, has_viewer() ? 0 : 2) << result.err;
  if (has_viewer()) {
    EXPECT_TRUE(contains(read_file(html), "model.stl"));
  }
}

TEST_F(CompareCommand, RefusesInOneLine) {
  const std::string line = folder.file("line.xyz");
  std::ofstream(line) << "0 0 0\n1 1 1\n2 2 2\n3 3 3\n4 4 4\n5 5 5\n6 6 6\n7 7 7\n8 8 8\n9 9 9\n";
  const struct {
    std::vector<std::string> arguments;
    const char* words;
  } cases[] = {
      {{scan, "none.stl"}, "none.stl"},
      {{"none.ply", model}, "none.ply"},
      {{scan, model, "--tolerance", "0"}, "tolerance = 0, must be > 0"},
      {{scan, model, "--least", "0.9"}, "--least: only --tolerance"},
      {{scan, model, "--tolerance", "1", "--least", "2"}, "least = 2, must be in (0, 1]"},
      {{scan, model, "--range", "1"}, "--range: only"},
      {{scan, model, "--picture", folder.file("a.jpg")}, "must end in .png"},
      {{scan, model, "-o", folder.file("a.obj")}, "must end in .ply"},
      {{scan, model, "-o", scan}, "scan.ply"},
      {{line, model, "--align"}, "on a line"},
  };
  for (const auto& c : cases) {
    std::vector<std::string> arguments{"compare", "--quiet"};
    arguments.insert(arguments.end(), c.arguments.begin(), c.arguments.end());
    const ProcessResult result = run(arguments);
    EXPECT_EQ(result.exit_code, 2) << c.words;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    EXPECT_TRUE(contains(result.err, c.words)) << result.err;
  }
}

}  // namespace TEST_FILE
}  // namespace soapfilm::test
