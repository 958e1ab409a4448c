#include "soapfilm/run/order_samples.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>
#include <vector>

#include "soapfilm/core/random.h"
#include "soapfilm/core/vec.h"

namespace soapfilm {
namespace TEST_FILE {

/// Columns that follow from the positions; three scans, the second one a range image.
PointCloud cloud_of(size_t count) {
  Random random(9);
  PointCloud cloud;
  cloud.columns.push_back({"value", {}, false});
  for (size_t i = 0; i < 3 * count; ++i) {
    const Vec3d p{random.uniform(), random.uniform(), 0.1 * random.uniform()};
    cloud.positions.push_back(p);
    cloud.normals.push_back(Vec3f(p));
    cloud.sensors.push_back(p + Vec3d{1, 2, 3});
    cloud.weights.push_back(static_cast<float>(p.x));
    cloud.colors.push_back({static_cast<uint8_t>(255 * p.x), 0, 0});
    cloud.columns[0].values.push_back(static_cast<float>(p.y));
  }
  for (size_t k = 0; k < 3; ++k) cloud.scans.push_back({"scan", k * count, (k + 1) * count, {}, {}, {}});
  RangeGrid grid{static_cast<int>(count), 1, {}};
  for (size_t i = 0; i < count; ++i) grid.sample.push_back(static_cast<int32_t>(i));
  cloud.scans[1].range_grid = grid;
  return cloud;
}

double way_along(const PointCloud& cloud, const Scan& scan) {
  double way = 0;
  for (size_t i = scan.begin + 1; i < scan.end; ++i) way += norm(cloud.positions[i] - cloud.positions[i - 1]);
  return way;
}

TEST(OrderSamples, RowsStayWholeAndInTheirScans) {
  const PointCloud before = cloud_of(3000);
  PointCloud after = before;
  order_scans_by_place(after);
  for (size_t i = 0; i < after.size(); ++i) {
    const Vec3d p = after.positions[i];
    ASSERT_EQ(after.normals[i], Vec3f(p));
    ASSERT_EQ(after.sensors[i], (p + Vec3d{1, 2, 3}));
    ASSERT_EQ(after.weights[i], static_cast<float>(p.x));
    ASSERT_EQ(after.colors[i][0], static_cast<uint8_t>(255 * p.x));
    ASSERT_EQ(after.columns[0].values[i], static_cast<float>(p.y));
  }
  for (const Scan& scan : before.scans) {
    const auto sorted = [&](const PointCloud& cloud) {
      std::vector<std::tuple<double, double, double>> places;
      for (size_t i = scan.begin; i < scan.end; ++i)
        places.emplace_back(cloud.positions[i].x, cloud.positions[i].y, cloud.positions[i].z);
      std::sort(places.begin(), places.end());
      return places;
    };
    EXPECT_EQ(sorted(after), sorted(before));
  }
  EXPECT_LT(way_along(after, after.scans[0]), 0.1 * way_along(before, before.scans[0]));
  EXPECT_EQ(way_along(after, after.scans[1]), way_along(before, before.scans[1])) << "a range image";
  EXPECT_LT(way_along(after, after.scans[2]), 0.1 * way_along(before, before.scans[2]));
}

TEST(OrderSamples, WhatWillBeRefusedStaysAsItIs) {
  const auto stays = [](const PointCloud& cloud) {
    PointCloud after = cloud;
    order_scans_by_place(after);
    return std::equal(after.normals.begin(), after.normals.end(), cloud.normals.begin());
  };
  PointCloud cloud = cloud_of(100);
  EXPECT_FALSE(stays(cloud));
  cloud.positions[50].x = std::numeric_limits<double>::infinity();
  EXPECT_TRUE(stays(cloud));
  cloud = cloud_of(100);
  cloud.weights[5] = -1;
  EXPECT_TRUE(stays(cloud));
  cloud = cloud_of(100);
  cloud.scans[2].end += 1;
  EXPECT_TRUE(stays(cloud));
}

TEST(OrderSamples, OnlyWhereArraysGoToDisk) {
  const PointCloud cloud = cloud_of(1000);
  const auto ordered = [&](const char* folder, size_t limit) {
    Context context(1);
    context.set_scratch_folder(folder);
    context.limit_memory(limit);
    PointCloud after = cloud;
    order_samples(after, context);
    return !std::equal(after.normals.begin(), after.normals.end(), cloud.normals.begin());
  };
  EXPECT_TRUE(ordered("/tmp", size_t{1} << 20));
  EXPECT_FALSE(ordered("/tmp", size_t{1} << 30));
  EXPECT_FALSE(ordered("", size_t{1} << 20));
}

}  // namespace TEST_FILE
}  // namespace soapfilm
