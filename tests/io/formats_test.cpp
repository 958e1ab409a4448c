// Numbers in text, OBJ, OFF, STL: what is read, and round trips of what is written.
#include "files.h"
#include "samples.h"
#include "soapfilm/core/vec.h"
#include "soapfilm/io.h"
#include "soapfilm/io/files.h"
#include "soapfilm/io/text/text.h"

namespace soapfilm {
namespace TEST_FILE {

TEST(Numbers, AreReadAsProgramsWriteThem) {
  double value = 0;
  EXPECT_TRUE(io::parse_number("+1.5e3", value));
  EXPECT_EQ(value, 1500);
  EXPECT_TRUE(io::parse_number("5123456.0012345", value));
  EXPECT_EQ(value, 5123456.0012345);
  for (const char* text : {"nan", "-nan", "NaN", "1.#IND", "-1.#QNAN", "nan(0x7)"}) {
    EXPECT_TRUE(io::parse_number(text, value)) << text;
    EXPECT_TRUE(std::isnan(value)) << text;
  }
  EXPECT_TRUE(io::parse_number("-inf", value));
  EXPECT_EQ(value, -std::numeric_limits<double>::infinity());
  EXPECT_TRUE(io::parse_number("1e999", value));
  EXPECT_EQ(value, std::numeric_limits<double>::infinity());
  EXPECT_TRUE(io::parse_number("-1e-999", value));
  EXPECT_EQ(value, 0);
  for (const char* text : {"", "+", "+-1", "1,5", "0x10", "1e", "one", "1 ", "--1"})
    EXPECT_FALSE(io::parse_number(text, value)) << text;
}

TEST(Text, ByteOrderMarkIsPassedOverAtTheStartAlone) {
  const TemporaryFolder folder;
  const std::string mark = "\xEF\xBB\xBF";
  EXPECT_EQ(read_points(folder.write("p.txt", mark + "1 2 3\r\n4 5 6")).positions,
            std::vector<Vec3d>({{1, 2, 3}, {4, 5, 6}}));
  EXPECT_EQ(read_mesh(folder.write("m.off", mark + "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n")).vertices.size(), 3u);
  EXPECT_EQ(read_mesh(folder.write("m.stl", mark + "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\n"
                                                   "vertex 0 1 0\nendloop\nendfacet\nendsolid\n"))
                .vertices.size(),
            3u);
  EXPECT_EQ(read_points(folder.write("p.ply", mark + "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\n"
                                                     "property float y\nproperty float z\nend_header\n1 2 3\n"))
                .positions,
            std::vector<Vec3d>({{1, 2, 3}}));
  EXPECT_THROW(read_points(folder.write("q.txt", "1 2 3\n" + mark + "4 5 6")), InputError);
  EXPECT_THROW(read_points(folder.write("r.txt", mark)), InputError);
}

TEST(Files, AnOptionThatNoneTakesIsRefused) {
  const TemporaryFolder folder;
  const std::string text = folder.write("a.xyz", "1 2 3\n4 5 7\n"), ply = folder / "a.ply";
  write_points(ply, read_points(text));
  ReadOptions columns, trajectory, viewpoint;
  columns.columns = "y,x,z";
  trajectory.trajectory = "way.txt";
  viewpoint.trust_viewpoint = true;
  const auto read = [&](const ReadOptions& options, const std::vector<std::string>& paths) {
    return read_points(paths, nullptr, Context(1), options);
  };
  EXPECT_EQ(read(columns, {ply, text}).positions.back(), (Vec3d{5, 4, 7}));
  expect_refusal<ParameterError>([&] { read(columns, {ply}); }, {"columns", "a.ply"});
  expect_refusal<ParameterError>([&] { read(trajectory, {text, ply}); }, {"trajectory"});
  expect_refusal<ParameterError>([&] { read(viewpoint, {ply}); }, {"trust_viewpoint"});
}

TEST(Files, SeveralAreSeveralScans) {
  const TemporaryFolder folder;
  const PointCloud first = rich_cloud(2, 3, 4, 8);
  write_points(folder / "first.ply", first);
  const std::string second = folder.write("second.xyz", "1 2 3\n4 5 6\n");
  ReadReport report;
  const PointCloud cloud = read_points({folder / "first.ply", second}, &report);
  ASSERT_EQ(cloud.scans.size(), 3u);
  EXPECT_EQ(cloud.scans[2].name, "second");
  EXPECT_EQ(cloud.scans[2].begin, first.size());
  EXPECT_EQ(cloud.normals.size(), cloud.size());
  EXPECT_EQ(report.files.size(), 2u);
  EXPECT_EQ(report.samples(), cloud.size());
}

TEST(Files, ReadOnAnyNumberOfThreadsAreTheSameCloudReportAndError) {
  const TemporaryFolder folder;
  std::vector<std::string> paths;
  std::string set;
  for (int i = 0; i < 7; ++i) {
    const std::string name = "scan" + std::to_string(i) + ".xyz";
    paths.push_back(folder.write(name, std::to_string(i) + " 2 3\nnan 0 0\n4 5 6\n"));
    set += std::string(i % 3 == 0 ? "odd\n" : "") + "bmesh " + name + " 0 0 1 0 0 0 1\n";
  }
  paths.push_back(folder.write("all.conf", set));
  ReadReport report;
  const PointCloud cloud = read_points(paths, &report);
  ASSERT_EQ(cloud.scans.size(), 14u);
  std::vector<std::string> broken = paths;
  for (const int i : {3, 5})
    broken[static_cast<size_t>(i)] = folder.write("broken" + std::to_string(i) + ".xyz", "1 2 x\n");
  for (const int threads : {2, 3, 8}) {
    const Context context(threads);
    ReadReport other;
    expect_same_cloud(read_points(paths, &other, context), cloud);
    EXPECT_EQ(other.warnings, report.warnings);
    ASSERT_EQ(other.files.size(), report.files.size());
    for (size_t i = 0; i < report.files.size(); ++i) {
      EXPECT_EQ(other.files[i].path, report.files[i].path);
      EXPECT_EQ(other.files[i].dropped, 1u);
    }
    try {
      read_points(broken, nullptr, context);
      ADD_FAILURE() << "read a broken file";
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find("broken3.xyz"), std::string::npos) << error.what();
    }
  }
}

TEST(Obj, WrittenMeshComesBack) {
  const TemporaryFolder folder;
  Mesh mesh = torus_mesh(12, 1.0);
  const WriteReport report = write_mesh(folder / "m.obj", mesh);
  ASSERT_EQ(report.warnings.size(), 1u);
  EXPECT_NE(report.warnings[0].find("attributes"), std::string::npos);
  const Mesh read = read_mesh(folder / "m.obj");
  EXPECT_LT(largest_move(read, mesh), 1e-6);
  EXPECT_EQ(read.triangles, mesh.triangles);
  EXPECT_EQ(read.normals, mesh.normals);
  EXPECT_EQ(read.colors, mesh.colors);
}

TEST(Obj, FacesComeInEveryNotation) {
  const TemporaryFolder folder;
  const Mesh mesh = read_mesh(folder.write(
      "m.OBJ",
      "mtllib x.mtl\no thing\nv 0 0 0\nv 1 0 0 1.0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvn 0 0 1\ng part\nusemtl red\n"
      "f 1/1/1 2/1/1 3/1/1\nf -4//-1 -2//-1 -1//-1\nf 1/1 2/1 3/1 4/1\nl 1 2\nf 1 2 3\n"));
  EXPECT_EQ(mesh.triangles, std::vector<Triangle>({{0, 1, 2}, {0, 2, 3}, {0, 1, 2}, {0, 2, 3}, {0, 1, 2}}));
  EXPECT_TRUE(mesh.normals.empty());
  EXPECT_TRUE(mesh.colors.empty());
}

TEST(Off, WrittenMeshComesBack) {
  const TemporaryFolder folder;
  const Mesh mesh = torus_mesh(20, 1.0);
  const WriteReport written = write_mesh(folder / "m.off", mesh);
  EXPECT_EQ(written.warnings.size(), 1u);  // attributes
  const Mesh read = read_mesh(folder / "m.off");
  EXPECT_LT(largest_move(read, mesh), 1e-6);
  EXPECT_EQ(read.triangles, mesh.triangles);
  EXPECT_EQ(read.normals, mesh.normals);
  EXPECT_EQ(read.colors, mesh.colors);
}

TEST(Off, HeadsAndPrefixesAreRead) {
  const TemporaryFolder folder;
  const std::vector<Triangle> quad{{0, 1, 2}, {0, 2, 3}};
  const std::string plain = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n# faces\n4 0 1 2 3 255 0 0\n";
  for (const char* head : {"OFF\n4 1 0\n", "OFF 4 1 4\n", "# comment\nOFF\n\n4 1 0\n", "4 1 0\n", "OFF\r\n4 1 0\r\n"})
    EXPECT_EQ(read_mesh(folder.write("m.off", head + plain)).triangles, quad) << head;
  const Mesh colored = read_mesh(folder.write("c.off",
                                              "COFF\n3 1 0\n0 0 0 255 128 0 255\n1 0 0 0 0 0 255\n"
                                              "0 1 0 0.0 0.5 1.0 1.0\n3 0 1 2\n"));
  EXPECT_EQ(colored.colors, std::vector<Rgb8>({{255, 128, 0}, {0, 0, 0}, {0, 128, 255}}));
  const Mesh normals =
      read_mesh(folder.write("n.off", "NOFF\n3 1 0\n0 0 0 0 0 1\n1 0 0 0 0 1\n0 1 0 0 0 1\n3 0 1 2\n"));
  EXPECT_EQ(normals.normals.at(2), (Vec3f{0, 0, 1}));
}

TEST(Stl, WrittenMeshComesBackMerged) {
  const TemporaryFolder folder;
  const Mesh mesh = torus_mesh(40, 1.0);
  for (const bool ascii : {false, true}) {
    WriteOptions options;
    options.ascii = ascii;
    write_mesh(folder / "m.stl", mesh, options);
    const Mesh read = read_mesh(folder / "m.stl");
    EXPECT_EQ(read.vertices.size(), mesh.vertices.size());
    ASSERT_EQ(read.triangles.size(), mesh.triangles.size());
    for (size_t t = 0; t < mesh.triangles.size(); ++t)
      for (size_t c = 0; c < 3; ++c)
        ASSERT_LT(norm(read.vertices[read.triangles[t][c]] - mesh.vertices[mesh.triangles[t][c]]), 1e-6);
    EXPECT_NEAR(read.volume(), mesh.volume(), 1e-5);
  }
}

TEST(Stl, BinaryFileThatBeginsWithSolidIsBinary) {
  const TemporaryFolder folder;
  write_mesh(folder / "m.stl", torus_mesh(4, 1));
  std::string bytes = folder.read("m.stl");
  bytes.replace(0, 9, "solid abc");
  EXPECT_EQ(read_mesh(folder.write("n.stl", bytes)).triangles.size(), 32u);
}

TEST(BinaryMeshes, BytesAfterTheLastElementAreToldOf) {
  const TemporaryFolder folder;
  for (const char* name : {"m.stl", "m.ply"}) {
    write_mesh(folder / name, torus_mesh(4, 1));
    ReadReport report;
    const std::string bytes = folder.read(name);
    EXPECT_EQ(read_mesh(folder / name, &report).triangles.size(), 32u);
    EXPECT_TRUE(report.warnings.empty()) << name;
    EXPECT_EQ(read_mesh(folder.write(std::string("longer_") + name, bytes + "abcde"), &report).triangles.size(), 32u);
    ASSERT_EQ(report.warnings.size(), 1u) << name;
    EXPECT_NE(report.warnings[0].find("5 bytes after the last"), std::string::npos) << report.warnings[0];
  }
}

TEST(Stl, SeveralSolidsInAnyCase) {
  const TemporaryFolder folder;
  const std::string solid =
      "  SOLID a name\nFacet NORMAL 0 0 1\n outer loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n"
      "endloop endfacet\nendsolid a name\n";
  const Mesh mesh = read_mesh(folder.write("m.stl", solid + solid));
  EXPECT_EQ(mesh.triangles, std::vector<Triangle>({{0, 1, 2}, {0, 1, 2}}));
}

// Offsets of a national grid, detail of a millimeter: float would move vertices by 0.25.
TEST(Georeferenced, MeshLosesNothing) {
  const TemporaryFolder folder;
  const Vec3d offset{5e6 + 0.123, 4.5e6, 312.5};
  const Mesh mesh = torus_mesh(16, 0.003, offset);
  const double edge = 6.28 * 0.003 / 16;
  for (const char* name : {"m.ply", "m.obj"}) {
    for (const bool ascii : {false, true}) {
      WriteOptions options;
      options.ascii = ascii;
      const WriteReport report = write_mesh(folder / name, mesh, options);
      EXPECT_TRUE(report.double_coordinates);
      EXPECT_EQ(largest_move(read_mesh(folder / name), mesh), 0) << name;
    }
  }
  WriteOptions coarse;
  coarse.coordinate_precision = 1;
  EXPECT_TRUE(write_mesh(folder / "m.ply", mesh, coarse).double_coordinates) << "in float triangles would collapse";
  const Mesh near = torus_mesh(16, 0.003, {5.123, 4.5, 0});
  EXPECT_FALSE(write_mesh(folder / "m.ply", near, coarse).double_coordinates);
  EXPECT_GT(largest_move(read_mesh(folder / "m.ply"), near), 1e-5 * edge);
}

TEST(Georeferenced, StlSaysWhatItLoses) {
  const TemporaryFolder folder;
  Mesh mesh = torus_mesh(16, 0.003, {5e6, 4.5e6, 312.5});
  mesh.colors = {};
  mesh.attributes = {};
  const WriteReport report = write_mesh(folder / "m.stl", mesh);
  ASSERT_EQ(report.warnings.size(), 1u);
  EXPECT_NE(report.warnings[0].find("PLY"), std::string::npos) << report.warnings[0];
  mesh = torus_mesh(16, 0.003);
  mesh.colors = {};
  mesh.attributes = {};
  EXPECT_TRUE(write_mesh(folder / "m.stl", mesh).warnings.empty());
}

TEST(Georeferenced, CloudLosesNothing) {
  const TemporaryFolder folder;
  const PointCloud cloud = rich_cloud(2, 5, 4, 3, {5e6, 4.5e6, 312.5});
  for (const bool ascii : {false, true}) {
    WriteOptions options;
    options.ascii = ascii;
    options.coordinate_precision = 1e-6;
    EXPECT_TRUE(write_points(folder / "c.ply", cloud, options).double_coordinates);
    expect_same_cloud(read_points(folder / "c.ply"), cloud);
  }
}

TEST(Off, CloudsAreRead) {
  const TemporaryFolder folder;
  const std::string path = folder.write("a.off", "NOFF\n2 0 0\n1 2 3 0 0 1\n4 5 6 0 1 0\n");
  EXPECT_EQ(file_kind(path), FileKind::points);
  const PointCloud cloud = read_points(path);
  EXPECT_EQ(cloud.positions, (std::vector<Vec3d>{{1, 2, 3}, {4, 5, 6}}));
  EXPECT_EQ(cloud.normals, (std::vector<Vec3f>{{0, 0, 1}, {0, 1, 0}}));
  const std::string mesh = folder.write("m.off", "OFF\n3 1 0\n0 0 0\n0 0 0\n0 1 0\n3 0 1 2\n");
  EXPECT_EQ(file_kind(mesh), FileKind::mesh);
  EXPECT_EQ(read_points(mesh).size(), 3u);  // corners at the origin are samples
  expect_refusal<InputError>([&] { read_mesh(path); }, {"holds no faces"});
}

TEST(Pcd, CommasSeparateOrAreDecimal) {
  const TemporaryFolder folder;
  for (const std::string rows : {"1.5, 2.5, 3.5, 1\n1.0,2.0,3.0,2\n", "1,5 2,5 3,5 1\n1,0 2,0 3,0 2\n"}) {
    const PointCloud cloud =
        read_points(folder.write("a.pcd",
                                 "VERSION 0.7\nFIELDS x,y,z, i\nSIZE 4 4 4 4\nTYPE F F F F\nCOUNT 1 1 1 1\nWIDTH "
                                 "2\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 2\nDATA ascii\n" +
                                     rows));
    EXPECT_EQ(cloud.positions, (std::vector<Vec3d>{{1.5, 2.5, 3.5}, {1, 2, 3}}));
    EXPECT_EQ(cloud.columns.at(0).values, (std::vector<float>{1, 2}));
  }
}

}  // namespace TEST_FILE
}  // namespace soapfilm
