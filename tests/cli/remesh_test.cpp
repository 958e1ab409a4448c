// soapfilm remesh: what it writes, says and refuses.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "soapfilm/io.h"
#include "support/process.h"
#include "support/program.h"
#include "tools/mesh/self_intersection.h"
#include "tools/scanner/shape.h"

namespace soapfilm {
namespace TEST_FILE {

using namespace test;

TEST(RemeshCommand, WritesEvenTrianglesAndSaysHowNear) {
  const TemporaryFolder folder;
  const std::string truth = folder.file("truth.ply");
  write_mesh(truth, make_torus()->tessellate(1e-3));
  const std::string edge = fmt::format("{:.4g}", 0.05 * read_mesh(truth).box().longest());
  for (const std::string name : {"even.off", "even.ply"}) {
    const ProcessResult result = run({"remesh", truth, "-o", folder.file(name), "--edge", "5%"});
    ASSERT_EQ(result.exit_code, 0) << result.err;
    EXPECT_TRUE(contains(result.err, "each mesh proved within 0.00")) << result.err;
    EXPECT_TRUE(contains(result.err, "% of edges are 0.7 to 1.4 times " + edge + " long")) << result.err;
    const Mesh mesh = read_mesh(folder.file(name));
    EXPECT_TRUE(check_topology(mesh).watertight());
    EXPECT_EQ(check_topology(mesh).genus(), 1);
    EXPECT_EQ(count_self_intersections(mesh, Context(1)), 0u);
  }
  const ProcessResult coarse = run({"remesh", truth, "-o", folder.file("coarse.ply"), "--edge", "0.2"});
  ASSERT_EQ(coarse.exit_code, 0) << coarse.err;
  EXPECT_EQ(check_topology(read_mesh(folder.file("coarse.ply"))).genus(), 1);
}

TEST(RemeshCommand, RefusesWhatItCannotDoAndWritesNothing) {
  const TemporaryFolder folder;
  const std::string fan = folder.file("fan.obj"), out = folder.file("r.ply");
  std::ofstream(fan) << "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 0 -1 0\nf 1 2 3\nf 1 2 4\nf 2 1 5\n";
  expect_refused({"-q", "remesh", fan, "-o", out, "--edge", "0.1"},
                 "fan.obj: edge 0-1 is in 3 triangles, must be a 2-manifold");
  expect_refused({"-q", "remesh", fan, "-o", out, "--edge", "0"}, "edge = 0, must be > 0");
  expect_refused({"-q", "remesh", fan, "-o", out, "--edge", "x"}, "edge = x");
  expect_refused({"-q", "remesh", fan, "-o", out, "--edge", "0.1", "--tolerance", "-1"}, "tolerance = -1, must be > 0");
  expect_refused({"-q", "remesh", fan, "-o", out}, "--edge");
  expect_refused({"-q", "remesh", fan, "-o", fan, "--edge", "0.1"}, "fan.obj");
  EXPECT_FALSE(std::filesystem::exists(out));
}

}  // namespace TEST_FILE
}  // namespace soapfilm
