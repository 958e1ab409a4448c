// MeshLab's projects and alignments.
#include "files.h"
#include "samples.h"
#include "soapfilm/core/placement.h"
#include "soapfilm/io.h"

namespace soapfilm {
namespace TEST_FILE {

const std::string turned_matrix = "0 -1 0 10\n1 0 0 20\n0 0 1 30\n0 0 0 1\n";  // 90 degrees about z, x to y

std::string mlp(const std::string& meshes) {
  return "<!DOCTYPE MeshLabDocument>\n<MeshLabProject>\n <MeshGroup>\n" + meshes +
         " </MeshGroup>\n <RasterGroup><MLRaster label=\"a.jpg\"/></RasterGroup>\n</MeshLabProject>\n";
}
std::string ml_mesh(const std::string& file, const std::string& matrix, const std::string& more = {}) {
  return "  <MLMesh label=\"a\" filename=\"" + file + "\" " + more + ">\n" +
         (matrix.empty() ? "" : "   <MLMatrix44>\n" + matrix + "</MLMatrix44>\n") +
         "   <RenderingOption pointSize=\"3\">1000</RenderingOption>\n  </MLMesh>\n";
}
std::string aln(const std::vector<std::pair<std::string, std::string>>& meshes) {
  std::string text = std::to_string(meshes.size()) + "\n";
  for (const auto& [file, matrix] : meshes) text += file + "\n#\n" + matrix;
  return text + "0\n";
}

TEST(MeshLab, PosesMoveAllThatAScanHas) {
  const TemporaryFolder folder;
  const PointCloud cloud = rich_cloud(2, 4, 3, 21);
  write_points(folder / "two scans.ply", cloud);
  folder.write("bare.xyz", "0 1 0\n");
  const std::string scaled = "0 -2 0 10\n2 0 0 20\n0 0 2 30\n0 0 0 1\n";
  for (const double scale : {1.0, 2.0}) {
    const std::string& matrix = scale == 1 ? turned_matrix : scaled;
    folder.write("set.mlp",
                 mlp(ml_mesh("two scans.ply", matrix, "visible=\"1\" idInFile=\"-1\"") + ml_mesh("bare.xyz", "")));
    folder.write("set.aln", aln({{"two scans.ply", matrix}, {"bare.xyz", "1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n"}}));
    for (const char* name : {"set.mlp", "set.aln"}) {
      ReadReport report;
      const PointCloud posed = read_points(folder / name, &report);
      EXPECT_TRUE(report.warnings.empty());
      ASSERT_EQ(posed.scans.size(), 3u);
      const auto turned = [](Vec3d v) { return Vec3d{-v.y, v.x, v.z}; };
      const auto moved = [&](Vec3d v) { return scale * turned(v) + Vec3d{10, 20, 30}; };
      for (size_t i = 0; i < cloud.size(); ++i) {
        EXPECT_LT(norm(posed.positions[i] - moved(cloud.positions[i])), 1e-12);
        EXPECT_LT(norm(posed.sensors[i] - moved(cloud.sensors[i])), 1e-12);
        const Vec3d normal = turned(static_cast<Vec3d>(cloud.normals[i]));
        EXPECT_LT(norm(static_cast<Vec3d>(posed.normals[i]) - normal), 1e-6 * (1 + norm(normal)));
      }
      EXPECT_LT(norm(*posed.scans[0].sensor - moved(*cloud.scans[0].sensor)), 1e-12);
      EXPECT_LT(norm(*posed.scans[1].view_direction - turned(*cloud.scans[1].view_direction)), 1e-12);
      EXPECT_EQ(posed.positions[posed.scans[2].begin], (Vec3d{0, 1, 0}));
      EXPECT_FALSE(posed.scans[2].view_direction);  // no file says how it was seen
    }
  }
}

TEST(MeshLab, HiddenMeshesAreLeftOutWithAWarning) {
  const TemporaryFolder folder;
  folder.write("a.xyz", "0 1 0\n");
  const std::string hidden = ml_mesh("missing.ply", turned_matrix, "visible=\"0\"");
  ReadReport report;
  EXPECT_EQ(read_points(folder.write("set.mlp", mlp(hidden + ml_mesh("a.xyz", "") + hidden)), &report).size(), 1u);
  ASSERT_EQ(report.warnings.size(), 1u);
  EXPECT_NE(report.warnings[0].find("'missing.ply' and 1 more"), std::string::npos) << report.warnings[0];
  expect_refusal<InputError>([&] { read_points(folder.write("b.mlp", mlp(hidden))); }, {"b.mlp", "no visible MLMesh"});
}

TEST(MeshLab, VerticesOfMeshesAreSamplesWithTheirNormals) {
  const TemporaryFolder folder;
  const Mesh mesh = torus_mesh(12, 1.0);
  write_mesh(folder / "m.stl", mesh);
  folder.write("set.aln", aln({{"m.stl", turned_matrix}}));
  ReadReport report;
  const PointCloud cloud = read_points(folder / "set.aln", &report);
  ASSERT_EQ(cloud.size(), mesh.vertices.size());
  ASSERT_EQ(cloud.normals.size(), cloud.size());
  EXPECT_EQ(report.samples(), cloud.size());
  for (size_t i = 0; i < cloud.size(); ++i) {
    const Vec3d from_center = cloud.positions[i] - Vec3d{10, 20, 30};
    const Vec3d ring = normalized(Vec3d{from_center.x, from_center.y, 0});
    EXPECT_GT(dot(static_cast<Vec3d>(cloud.normals[i]), normalized(from_center - ring)), 0.8);
  }
}

TEST(MeshLab, ProjectsThatCannotBeAreRefused) {
  const TemporaryFolder folder;
  folder.write("a.xyz", "0 1 0\n");
  const auto refused = [&](const std::string& name, const std::string& text, std::initializer_list<std::string> parts) {
    const std::string path = folder.write(name, text);
    expect_refusal<InputError>([&] { read_points(path); }, parts);
    expect_refusal<InputError>([&] { read_points(path); }, {path});
  };
  const std::string rest = "0 1 0 0\n0 0 1 0\n";
  const std::string mirrors = "-1 0 0 0\n" + rest + "0 0 0 1\n", shears = "1 0.5 0 0\n" + rest + "0 0 0 1\n",
                    sees = "1 0 0 0\n" + rest + "0 0 0.1 1\n", empty = "0 0 0 0\n0 0 0 0\n0 0 0 0\n0 0 0 1\n",
                    nan = "nan 0 0 0\n" + rest + "0 0 0 1\n";
  const std::vector<std::pair<std::string, std::string>> wrong{{mirrors, "mirrors"},
                                                               {shears, "stretches or shears"},
                                                               {sees, "perspective"},
                                                               {empty, "stretches"},
                                                               {nan, "finite"}};
  for (const auto& [matrix, word] : wrong) {
    refused("b.mlp", mlp(ml_mesh("a.xyz", matrix)), {"b.mlp:5:", "'a.xyz'", word});
    refused("b.aln", aln({{"a.xyz", matrix}}), {"b.aln:7:", "'a.xyz'", word});
  }
  refused("b.mlp", mlp(ml_mesh("a.xyz", "1 2 3")), {"b.mlp:5:", "3 numbers, must be 16"});
  refused("b.mlp", mlp(ml_mesh("a.xyz", "1 2 x")), {"b.mlp:5:", "'x', must be a number"});
  refused("b.mlp", mlp(ml_mesh("a.xyz", "", "idInFile=\"2\"")), {"b.mlp:4:", "idInFile = 2"});
  refused("b.mlp", mlp(ml_mesh("", "")), {"b.mlp:4:", "without a filename"});
  refused("b.mlp", "<MeshLabProject>\n<MeshGroup>\n", {"b.mlp:", "XML"});
  refused("b.mlp", "<other/>", {"b.mlp:1:", "'other'", "MeshLabProject"});
  refused("b.mlp", mlp(ml_mesh("none.ply", "")), {"b.mlp", "none.ply", "No such file"});
  for (const char* nested : {"b.mlp", "c.aln", "d.CONF"}) {
    refused("b.mlp", mlp(ml_mesh(nested, "")), {nested, "not a scan set"});
    refused("b.aln", aln({{nested, turned_matrix}}), {nested, "not a scan set"});
    refused("b.conf", std::string("bmesh ") + nested + " 0 0 0 0 0 0 1\n", {nested, "not a scan set"});
  }
  refused("b.aln", "two\n", {"b.aln:1:", "'two'"});
  refused("b.aln", "0\n", {"b.aln:1:", "> 0"});
  refused("b.aln", "2\na.xyz\n#\n" + turned_matrix, {"b.aln:7:", "mesh 2 of 2"});
  refused("b.aln", "1\na.xyz\n#\n1 0 0 0\n0 1 0\n", {"b.aln:5:", "3 numbers, must be 4"});
  refused("b.aln", "1\na.xyz\n#\n1 0 0 a\n", {"b.aln:4:", "'a', must be a number"});
  refused("b.aln", "1\na.xyz\n#\n" + turned_matrix + "b.xyz\n", {"b.aln:8:", "'b.xyz' after 1 meshes"});
}

}  // namespace TEST_FILE
}  // namespace soapfilm
