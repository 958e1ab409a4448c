#include "soapfilm/core/hash.h"

#include <gtest/gtest.h>

#include <set>
#include <string>
#include <vector>

namespace soapfilm {
namespace TEST_FILE {

PointCloud some_cloud() {
  PointCloud cloud;
  cloud.positions = {{0, 0, 0}, {1, 2, 3}, {4, 5, 6}};
  cloud.normals = {{0, 0, 1}, {0, 1, 0}, {1, 0, 0}};
  cloud.scans = {{"a", 0, 3, {}, {}, {}}};
  return cloud;
}

TEST(Hash, OfACloudDependsOnAllThatTheSurfaceFollowsFrom) {
  std::set<uint64_t> found;
  const auto with = [&](auto&& change) {
    PointCloud cloud = some_cloud();
    change(cloud);
    found.insert(hash_of(cloud));
  };
  with([](PointCloud&) {});
  with([](PointCloud& c) { c.positions[2].z += 1e-16; });  // smaller than a double can tell
  EXPECT_EQ(found.size(), 1u);
  with([](PointCloud& c) { c.positions[2].z += 1e-14; });
  with([](PointCloud& c) { std::swap(c.positions[0], c.positions[1]); });
  with([](PointCloud& c) { c.normals[1].x = 1e-30f; });
  with([](PointCloud& c) { c.sensors.assign(3, Vec3d{}); });
  with([](PointCloud& c) { c.weights.assign(3, 1.0f); });
  with([](PointCloud& c) { c.is_survey = true; });
  with([](PointCloud& c) { c.scans[0].sensor = Vec3d{0, 0, 9}; });
  with([](PointCloud& c) { c.scans[0].view_direction = Vec3d{0, 0, 9}; });
  with([](PointCloud& c) { c.scans = {{"a", 0, 1, {}, {}, {}}, {"b", 1, 3, {}, {}, {}}}; });
  EXPECT_EQ(found.size(), 10u);
  with([](PointCloud& c) { c.colors.assign(3, Rgb8{1, 2, 3}); });
  with([](PointCloud& c) { c.scans[0].name = "b"; });
  EXPECT_EQ(found.size(), 10u);
}

TEST(Hash, TellsWhereOneTextEnds) {
  Hash a, b;
  a.add(std::string("ab"));
  a.add(std::string("c"));
  b.add(std::string("a"));
  b.add(std::string("bc"));
  EXPECT_NE(a.value(), b.value());
}

}  // namespace TEST_FILE
}  // namespace soapfilm
