// soapfilm reconstruct --up: from where bare positions were seen.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "cli/reconstruct_runs.h"
#include "soapfilm/core/random.h"
#include "soapfilm/core/vec.h"
#include "soapfilm/io.h"

namespace soapfilm::test {
namespace TEST_FILE {

using nlohmann::json;

class Up : public ReconstructRuns {
 protected:
  /// A valley as bare positions, 60 x 60.
  std::string valley() const {
    PointCloud cloud;
    Random random(2);
    for (int i = 0; i < 4000; ++i) {
      const double x = random.uniform(-30, 30), y = random.uniform(-30, 30);
      cloud.positions.push_back({x, y, 0.005 * x * x});
    }
    const std::string file = folder.file("valley.ply");
    write_points(file, cloud);
    return file;
  }
  /// Mean height of the faces' normals: 1 where all look up.
  double faces_up() const {
    const Mesh found = read_mesh(mesh);
    Vec3d sum;
    for (const Triangle& t : found.triangles) {
      const Vec3d a = found.vertices[t[0]];
      sum += cross(found.vertices[t[1]] - a, found.vertices[t[2]] - a) / 2.0;
    }
    return sum.z / found.area();
  }
};

TEST_F(Up, BarePositionsOfTerrainFaceUpAndTheReportSaysWhy) {
  const json report = reported({valley()});
  EXPECT_GT(faces_up(), 0.9);
  EXPECT_EQ(report["border"]["outside"], "open");
  EXPECT_EQ(report["border"]["ends"], true);
  EXPECT_NE(report["input"]["directions"]["assumed"].get<std::string>().find("--up"), std::string::npos);
  EXPECT_TRUE(report["warnings"].empty()) << report["warnings"];
  EXPECT_TRUE(report["parameters"]["orient"]["up"].is_null());
}

TEST_F(Up, TheOppositeAxisTurnsTheFacesHoweverItIsWritten) {
  const std::string cloud = valley();
  for (const std::vector<std::string>& written : {std::vector<std::string>{"--up=-z"}, {"--up", "-z"}}) {
    std::vector<std::string> arguments{cloud};
    arguments.insert(arguments.end(), written.begin(), written.end());
    EXPECT_EQ(reported(arguments)["parameters"]["orient"]["up"], "-z");
    EXPECT_LT(faces_up(), -0.9);
  }
}

TEST_F(Up, AnotherWordIsRefused) { refused({valley(), "--up", "w"}, "--up = w, must be one of x, y, z, -x, -y, -z"); }

}  // namespace TEST_FILE
}  // namespace soapfilm::test
