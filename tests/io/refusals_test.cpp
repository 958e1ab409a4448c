// What is refused, and that the message names file, place, value and constraint.
#include "files.h"
#include "samples.h"
#include "soapfilm/io.h"
#include "soapfilm/io/files.h"

namespace soapfilm {
namespace TEST_FILE {

const std::string vertex_head =
    "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\n"
    "property float z\n";  // 6 lines

/// Expects that the text, as a file of this name, is refused as points with a message that holds the parts.
void expect_points_refused(const std::string& name, const std::string& text, std::initializer_list<std::string> parts) {
  const TemporaryFolder folder;
  const std::string path = folder.write(name, text);
  expect_refusal<InputError>([&] { read_points(path); }, parts);
  expect_refusal<InputError>([&] { read_points(path); }, {path});
}

void expect_mesh_refused(const std::string& name, const std::string& text, std::initializer_list<std::string> parts) {
  const TemporaryFolder folder;
  const std::string path = folder.write(name, text);
  expect_refusal<InputError>([&] { read_mesh(path); }, parts);
  expect_refusal<InputError>([&] { read_mesh(path); }, {path});
}

TEST(Refusals, FilesThatCannotBeOpened) {
  const TemporaryFolder folder;
  expect_refusal<InputError>([&] { read_points(folder / "none.ply"); }, {"none.ply", "No such file"});
  expect_refusal<InputError>([&] { read_mesh(folder / "none.obj"); }, {"none.obj", "No such file"});
  std::filesystem::create_directory(folder / "dir.ply");
  expect_refusal<InputError>([&] { read_points(folder / "dir.ply"); }, {"dir.ply", "a folder without scans"});
  expect_refusal<InputError>([&] { read_points("/dev/null"); }, {"/dev/null", "device"});
  folder.write("empty.ply", "");
  expect_refusal<InputError>([&] { read_points(folder / "empty.ply"); }, {"empty.ply", "is empty"});
  expect_refusal<ParameterError>([&] { read_points(std::vector<std::string>{}); }, {"0 input files"});
}

TEST(Refusals, UnknownExtensions) {
  expect_points_refused("cloud.doc", "words", {"'.doc'", ".ply, .xyz, .txt, .csv", ".las"});
  expect_points_refused("mesh.stl", "solid", {"'.stl'", "points"});
  expect_mesh_refused("mesh.xyz", "0 0 0", {"'.xyz'", ".ply, .obj, .off, .glb or .stl"});
  const TemporaryFolder folder;
  const Mesh mesh = torus_mesh(4, 1);
  expect_refusal<OutputError>([&] { write_mesh(folder / "m.xyz", mesh); },
                              {"'.xyz'", ".ply, .obj, .off, .glb, .vdb or .stl"});
  expect_refusal<OutputError>([&] { write_mesh(folder / "m", mesh); }, {"''", ".ply, .obj, .off, .glb, .vdb or .stl"});
  expect_refusal<OutputError>([&] { check_mesh_output(folder / "m.pdf"); },
                              {"'.pdf'", ".ply, .obj, .off, .glb, .vdb or .stl"});
  expect_refusal<OutputError>([&] { write_points(folder / "m.xyz", rich_cloud(1, 2, 2, 1)); }, {"'.xyz'", ".ply"});
  EXPECT_EQ(folder.file_count(), 0u);
}

TEST(Refusals, PlyHeaders) {
  expect_points_refused("a.ply", "solid cube\n", {"a.ply:1:", "not a PLY", "'solid cu'"});
  expect_points_refused("a.ply", "ply\nformat ascii 1.0\n", {"a.ply:2:", "truncated", "end_header"});
  expect_points_refused("a.ply", "ply\nformat utf8 1.0\nend_header\n", {"a.ply:2:", "'utf8'", "binary_big_endian"});
  expect_points_refused("a.ply", "ply\nelement vertex 1\nproperty float x\nend_header\n",
                        {"a.ply:4:", "no format line"});
  expect_points_refused("a.ply", "ply\nformat ascii 1.0\nelement vertex -3\n", {"a.ply:3:", "'-3'", ">= 0"});
  expect_points_refused("a.ply", "ply\nformat ascii 1.0\nelement vertex\n", {"a.ply:3:", "count"});
  expect_points_refused("a.ply", "ply\nformat ascii 1.0\nproperty float x\n", {"a.ply:3:", "before the first element"});
  expect_points_refused("a.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty long x\n",
                        {"a.ply:4:", "'long'", "float64"});
  expect_points_refused("a.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty list float int x\n",
                        {"a.ply:4:", "integer type"});
  expect_points_refused("a.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty int x\nproperty int x\n",
                        {"a.ply:5:", "'x'", "twice"});
  expect_points_refused("a.ply", "ply\nformat ascii 1.0\nelement vertex 1\nelement vertex 1\n",
                        {"a.ply:4:", "'vertex'", "twice"});
  expect_points_refused("a.ply", "ply\nformat ascii 1.0\nelment vertex 1\n", {"a.ply:3:", "'elment'"});
  expect_points_refused("a.ply", "ply\nformat ascii 1.0\nelement face 0\nend_header\n", {"no element 'vertex'"});
  expect_points_refused("a.ply", "ply\nformat ascii 1.0\nelement vertex 0\nend_header\n", {"a.ply:3:", "count = 0"});
  expect_points_refused("a.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty int x\nend_header\n1\n",
                        {"a.ply:3:", "x, y and z"});
}

TEST(Refusals, PlyBodies) {
  expect_points_refused("b.ply", vertex_head + "end_header\n1 2 3\n1 abc 3\n", {"b.ply:9:", "y = 'abc'", "number"});
  expect_points_refused("b.ply", vertex_head + "end_header\n1 2 3\n111111 2\n", {"b.ply:", "truncated", "z"});
  expect_points_refused("b.ply", vertex_head + "end_header\n1 2 3\n1 2 3\n7\n",
                        {"b.ply:10:", "'7'", "end of the file"});
  expect_points_refused("b.ply", vertex_head + "property float weight\nend_header\n1 2 3 1\n1 2 3 -1\n",
                        {"b.ply:10:", "vertex 1", "weight = -1", ">= 0"});
  expect_points_refused("b.ply", vertex_head + "end_header\nnan 2 3\n1 inf 3\n",
                        {"none of its 2 samples", "non-finite"});
  expect_points_refused("b.ply", vertex_head + "property list int int l\nend_header\n1 2 3 999999999 1\n1 2 3 0\n",
                        {"b.ply:9:", "count = 999999999", "hold"});
  expect_points_refused("b.ply", vertex_head + "property list int int l\nend_header\n1 2 3 -1\n1 2 3 0\n",
                        {"b.ply:9:", "count = -1"});
}

TEST(Refusals, CountsLargerThanTheFile) {
  for (const char* format : {"ascii", "binary_little_endian", "binary_big_endian"}) {
    const std::string head = std::string("ply\nformat ") + format + " 1.0\n";
    const std::string xyz = "property float x\nproperty float y\nproperty float z\n";
    expect_points_refused("c.ply", head + "element vertex 4000000000000000000\n" + xyz + "end_header\n0 0 0\n",
                          {"c.ply:3:", "4000000000000000000", "truncated"});
    expect_mesh_refused("c.ply",
                        head + "element vertex 1\n" + xyz +
                            "element face 3000000000\nproperty list uchar int vertex_indices\nend_header\n" +
                            "0.0 0.0 0.0\n1 0 0\n",
                        {"c.ply:7:", "3000000000", "truncated"});
  }
  expect_mesh_refused("c.off", "OFF\n1000000000 1000000000 0\n0 0 0\n", {"c.off:2:", "1000000000", "truncated"});
  expect_mesh_refused("c.stl", std::string(80, ' ') + "\xff\xff\xff\x7f" + std::string(100, ' '),
                      {"byte 80", "2147483647", "to 2"});
}

TEST(Refusals, TruncatedBinaryFiles) {
  const TemporaryFolder folder;
  write_mesh(folder / "whole.ply", torus_mesh(6, 1));
  write_mesh(folder / "whole.stl", torus_mesh(6, 1));
  const std::string ply = folder.read("whole.ply");
  const std::string stl = folder.read("whole.stl");
  for (size_t cut = 1; cut < ply.size(); cut += 37)
    expect_mesh_refused("cut.ply", ply.substr(0, ply.size() - cut), {"cut.ply"});
  for (size_t cut = 1; cut < stl.size(); cut += 37)
    expect_mesh_refused("cut.stl", stl.substr(0, stl.size() - cut), {"cut.stl"});
  expect_mesh_refused("cut.ply", ply.substr(0, ply.size() - 1), {"byte", "at most 2"});
}

TEST(Refusals, PlyMeshes) {
  const std::string head =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
      "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n";
  const std::string rows = "0 0 0\n1 0 0\n0 1 0\n";
  expect_mesh_refused("m.ply", head + rows + "3 0 1 3\n", {"m.ply:13:", "face 0", "index = 3", "0 to 2"});
  expect_mesh_refused("m.ply", head + rows + "3 0 1 -1\n", {"m.ply:13:", "index = -1"});
  expect_mesh_refused("m.ply", head + rows + "3 0 1 4294967298\n", {"m.ply:13:", "index = 4294967298"});
  expect_mesh_refused("m.ply", head + rows + "4294967299 0 1 2\n", {"m.ply:13:", "count = 4294967299", "at most 7"});
  expect_mesh_refused("m.ply", head + rows + "3.5 0 1 2\n", {"m.ply:13:", "count = 3.5", "integer"});
  expect_mesh_refused("m.ply", head + rows + "2 0 1    \n", {"m.ply:13:", "2 vertices", "at least 3"});
  expect_mesh_refused("m.ply", head + "0 0 0\n1 nan 0\n0 1 0\n3 0 1 2\n", {"m.ply:11:", "vertex 1", "finite"});
  expect_mesh_refused("m.ply", vertex_head + "end_header\n0 0 0\n1 1 1\n", {"no faces"});
}

TEST(Refusals, RangeGridsAndScans) {
  const auto file = [](const std::string& notes, const std::string& cells) {
    return "ply\nformat ascii 1.0\n" + notes +
           "element vertex 2\nproperty float x\nproperty float y\nproperty float z\nelement range_grid 4\n"
           "property list uchar int vertex_indices\nend_header\n0 0 0\n1 1 1\n" +
           cells;
  };
  const std::string grid = "obj_info num_cols 2\nobj_info num_rows 2\n";
  expect_points_refused("g.ply", file("obj_info num_cols 3\nobj_info num_rows 2\n", "0\n1 0\n1 1\n0\n"),
                        {"range_grid", "4 cells", "= 6"});
  expect_points_refused("g.ply", file(grid, "0\n1 0\n1 2\n0\n"), {"g.ply:16:", "range_grid 2", "index = 2", "0 to 1"});
  expect_points_refused("g.ply", file(grid, "0\n2 0 1\n0\n0\n"), {"g.ply:15:", "2 samples in a cell"});
  expect_points_refused("g.ply", file(grid, "0\r\n0 \r\n1 2\r\n0\r\n"), {"g.ply:16:", "range_grid 2", "index = 2"});
  expect_points_refused("g.ply", file(grid, "0\n0\n0x1\n0\n"), {"g.ply:16:", "'0x1'"});
  expect_points_refused("g.ply", file("obj_info scan_samples 3\n", "0\n0\n0\n0\n"), {"g.ply:3:", "= 3", "at most 2"});
  expect_points_refused("g.ply", file("obj_info scan_samples 1\n", "0\n0\n0\n0\n"), {"add up to 1", "2 samples"});
  expect_points_refused("g.ply", file("obj_info scan_samples x\n", "0\n0\n0\n0\n"), {"g.ply:3:", "'x'", "> 0"});
  expect_points_refused("g.ply",
                        file("obj_info scan_samples 1\n" + grid + "obj_info scan_samples 1\n", "0\n1 0\n1 1\n0\n"),
                        {"range_grid 2", "index = 1", "its scan"});
}

TEST(Refusals, Text) {
  expect_points_refused("t.xyz", "1 2 3\n4 5 x6\n", {"t.xyz:2:", "column 3", "'x6'", "number"});
  expect_points_refused("t.xyz", "1 2 3\n\n# c\n4 5\n", {"t.xyz:4:", "2 columns", "must be 3"});
  expect_points_refused("t.xyz", "# nothing\n\n", {"no samples"});
  expect_points_refused("t.xyz", "nan 0 0\n", {"none of its 1 samples"});
  expect_points_refused("t.pts", "3\n1 2 3\n4 5 6\n1\n7 8 9\n",
                        {"t.pts:4:", "2 samples", "must be 3 as the count in line 1"});
  expect_points_refused("t.pts", "1 2 3\n2\n", {"t.pts:2:", "must come first"});
  expect_points_refused("t.pts", "0.5\n1 2 3\n", {"t.pts:1:", "0.5"});
}

TEST(Refusals, ObjOffStl) {
  expect_mesh_refused("m.obj", "v 0 0 0\nv 1 0\n", {"m.obj:2:", "2 numbers"});
  expect_mesh_refused("m.obj", "v 0 0 0\nv 1 0 z\n", {"m.obj:2:", "'z'"});
  expect_mesh_refused("m.obj", "v 0 0 0\nv 1 0 0\nv 0 inf 0\n", {"m.obj:3:", "finite"});
  expect_mesh_refused("m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n", {"m.obj:4:", "vertex 4", "1 to 3"});
  expect_mesh_refused("m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 0\n", {"m.obj:4:", "index 0"});
  expect_mesh_refused("m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 -4\n", {"m.obj:4:", "index -4", "-3"});
  expect_mesh_refused("m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2\n", {"m.obj:4:", "2 vertices"});
  expect_mesh_refused("m.obj", "v 0 0 0\n", {"no faces"});
  expect_mesh_refused("m.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n", {"m.off:6:", "face 0", "'3'", "0 to 2"});
  expect_mesh_refused("m.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n", {"m.off:5:", "face 0", "truncated"});
  expect_mesh_refused("m.off", "OFF\n3 1 0\n0 0 0\n1 q 0\n0 1 0\n3 0 1 2\n", {"m.off:4:", "vertex 1", "'q'"});
  expect_mesh_refused("m.off", "4OFF\n3 1 0\n", {"m.off:1:", "'4OFF'"});
  expect_mesh_refused("m.off", "OFF BINARY\n", {"m.off:1:", "binary"});
  expect_mesh_refused("m.off", "hello\n", {"m.off:1:", "not an OFF"});
  expect_mesh_refused("m.stl", "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 z 0\n",
                      {"m.stl:5:", "'z'"});
  expect_mesh_refused("m.stl", "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\n",
                      {"m.stl:", "truncated"});
  expect_mesh_refused("m.stl", "solid a\nendsolid\n", {"no facets"});
  expect_mesh_refused("m.stl", "hello", {"m.stl:1:", "'hello'", "solid"});
}

TEST(Refusals, ScanSets) {
  expect_points_refused("s.conf", "camera 0 0 0\n", {"no bmesh line"});
  expect_points_refused("s.conf", "bmesh a.ply 0 0 0 0 0 1\n", {"s.conf:1:", "7 fields"});
  expect_points_refused("s.conf", "\nbmesh a.ply 0 0 z 0 0 0 1\n", {"s.conf:2:", "'z'"});
  expect_points_refused("s.conf", "bmesh a.ply 0 0 0 0 0 0 0\n", {"s.conf:1:", "length 0", "must be 1"});
  expect_points_refused("s.conf", "bmesh s.conf 0 0 0 0 0 0 1\n", {"s.conf", "not a scan set"});
  const TemporaryFolder folder;
  const std::string path = folder.write("s.conf", "bmesh none.ply 0 0 0 0 0 0 1\n");
  expect_refusal<InputError>([&] { read_points(path); }, {folder / "none.ply", "No such file"});
}

TEST(Refusals, MeshesAndCloudsThatDoNotFitTogether) {
  const TemporaryFolder folder;
  for (const char* name : {"m.ply", "m.obj", "m.stl"}) {
    Mesh mesh = torus_mesh(4, 1);
    mesh.triangles[3][1] = 16;
    expect_refusal<ParameterError>([&] { write_mesh(folder / name, mesh); }, {"triangle 3", "16"});
    mesh = torus_mesh(4, 1);
    mesh.normals.pop_back();
    expect_refusal<ParameterError>([&] { write_mesh(folder / name, mesh); }, {"15 normals", "16"});
    mesh = torus_mesh(4, 1);
    mesh.vertices[2].x = std::numeric_limits<double>::infinity();
    expect_refusal<ParameterError>([&] { write_mesh(folder / name, mesh); }, {"vertex 2", "finite"});
    expect_refusal<ParameterError>([&] { write_mesh(folder / name, Mesh{}); }, {"0 triangles"});
  }
  Mesh mesh = torus_mesh(4, 1);
  mesh.attributes[0].name = "two words";
  expect_refusal<ParameterError>([&] { write_mesh(folder / "m.ply", mesh); }, {"'two words'"});
  PointCloud cloud = rich_cloud(2, 3, 3, 1);
  cloud.scans[1].begin += 1;
  expect_refusal<ParameterError>([&] { write_points(folder / "c.ply", cloud); }, {"must begin at 6"});
  EXPECT_EQ(folder.file_count(), 0u);
}

}  // namespace TEST_FILE
}  // namespace soapfilm
