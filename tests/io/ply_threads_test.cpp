// PLY files of many rows, which several threads read and make.
#include <fmt/format.h>

#include <tuple>

#include "files.h"
#include "samples.h"
#include "soapfilm/io.h"
#include "support/sanitized.h"

namespace soapfilm {
namespace TEST_FILE {

/// Text is read by many threads as far as its lines are rows: what they make of any other, and what is wrong with it,
/// is what one thread says.
TEST(PlyThreads, TextIsReadTheSameOnAnyNumberOfThreads) {
  const TemporaryFolder folder;
  constexpr size_t count = test::sanitized ? 20000 : 70000;  // several rounds of all threads' chunks
  std::vector<std::string> rows;
  Random random(1);
  for (size_t i = 0; i < count; ++i)
    rows.push_back(fmt::format("{} {:.4f} {:e} {}", random.uniform(), random.normal(), random.normal(), i % 7));
  const auto outcome = [&](const std::string& text, int threads) {
    const std::string file = folder.write("rows.ply", text);
    try {
      const PointCloud cloud = read_points(file, nullptr, Context(threads));
      return std::tuple(cloud.positions, cloud.weights, std::string());
    } catch (const InputError& error) {
      return std::tuple(std::vector<Vec3d>(), std::vector<float>(), std::string(error.what()));
    }
  };
  const auto expect_same = [&](const std::vector<std::string>& lines, const std::string& line_end,
                               const std::string& after, const std::string& complaint) {
    std::string text = fmt::format(
        "ply\nformat ascii 1.0\nelement vertex {}\nproperty float x\nproperty double y\nproperty double z\n"
        "property float weight\nelement other 3\nproperty int a\nproperty int b\nproperty int c\nproperty int d\n"
        "end_header\n",
        count);
    for (const std::string& line : lines) text += line + line_end;
    text += after;
    const auto expected = outcome(text, 1);
    const std::string& error = std::get<std::string>(expected);
    EXPECT_EQ(error.empty(), complaint.empty()) << error;
    EXPECT_NE(error.find(complaint), std::string::npos) << error;
    for (const int threads : {2, 3, 8}) EXPECT_TRUE(outcome(text, threads) == expected) << threads << ": " << complaint;
  };
  const std::string others = "1 2 3 4\n5 6 7 8\n9 10 11 12\n";
  expect_same(rows, "\n", others, "");
  expect_same(rows, " \r\n", others, "");
  expect_same(rows, "\n", "1 2 3 4\n5 6 7 8\n9 10 11", "truncated");
  expect_same(rows, "\n", others + "13", "'13' after the last element");
  expect_same({rows.begin(), rows.end() - 5}, "\n", others, "truncated");
  const auto changed = [&](size_t row, const std::string& line) {
    std::vector<std::string> lines = rows;
    lines[row] = line;
    return lines;
  };
  for (const char* line : {"+1 2 1.#IND 4", "nan 1 2 3", "1 2\n3 4", "\n\n1 2 3 4", "1 2 3 4 "})
    expect_same(changed(11111, line), "\n", others, "");
  constexpr size_t first_line = 14;
  for (const size_t row : {size_t{0}, size_t{11111}, count - 1}) {
    const std::string place = fmt::format("rows.ply:{}: ", first_line + row);
    expect_same(changed(row, "1 2 x 4"), "\n", others, place + "z = 'x', must be a number");
    expect_same(changed(row, "1 2 3 -4"), "\n", others, place + fmt::format("vertex {}: weight = -4", row));
  }
  expect_same(changed(500, "1 2 3 4 5"), "\n", others, "vertex 501: weight = -");
}

/// The mesh has more rows than two and three threads make at once; numbers are as long as text of them gets.
TEST(PlyThreads, ManyRowsAreTheSameBytesOnAnyNumberOfThreads) {
  const TemporaryFolder folder;
  Mesh mesh = torus_mesh(190, 1.0);
  constexpr double longest = -2.2250738585072014e-308;
  mesh.vertices[100] = {longest, longest, longest};
  mesh.attributes.push_back({"quality", std::vector<float>(mesh.vertices.size(), -1.17549435e-38f)});
  const PointCloud cloud = rich_cloud(2, 200, 120, 3);
  ASSERT_GT(mesh.triangles.size(), 50000u);
  for (const bool ascii : {false, true}) {
    WriteOptions mesh_options;
    mesh_options.ascii = ascii;
    mesh_options.coordinate_precision = 1e-320;  // doubles
    WriteOptions point_options;
    point_options.ascii = ascii;
    write_mesh(folder / "one.ply", mesh, mesh_options);
    write_points(folder / "points.ply", cloud, point_options);
    EXPECT_EQ(read_mesh(folder / "one.ply").triangles, mesh.triangles);
    expect_same_cloud(read_points(folder / "points.ply"), cloud);
    for (const int threads : {2, 3, 8}) {
      write_mesh(folder / "many.ply", mesh, mesh_options, Context(threads));
      EXPECT_TRUE(folder.read("many.ply") == folder.read("one.ply")) << threads << " threads";
      write_points(folder / "many.ply", cloud, point_options, Context(threads));
      EXPECT_TRUE(folder.read("many.ply") == folder.read("points.ply")) << threads << " threads";
    }
  }
}

}  // namespace TEST_FILE
}  // namespace soapfilm
