// Scans as they come: each moved by its pose, and the surface of those that are there.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

#include "soapfilm/error.h"
#include "soapfilm/reconstruct.h"
#include "support/hash.h"
#include "support/problem.h"
#include "support/sanitized.h"

namespace soapfilm {
namespace TEST_FILE {

using namespace test;

using Matrix = std::array<double, 16>;

constexpr int resolution = sanitized ? 24 : 48;
constexpr Matrix identity{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
/// A quarter turn about z and a shift by whole numbers: nothing is rounded.
constexpr Matrix turn{0, -1, 0, 2, 1, 0, 0, -4, 0, 0, 1, 8, 0, 0, 0, 1};
constexpr Matrix turn_back{0, 1, 0, 4, -1, 0, 0, 2, 0, 0, 1, -8, 0, 0, 0, 1};

/// A sphere's samples at multiples of 2^-20, so that whole shifts are exact.
PointCloud part(int seed) {
  PointCloud cloud = sampled("sphere", resolution, 0.5, static_cast<uint64_t>(seed));
  for (Vec3d& p : cloud.positions)
    for (int axis = 0; axis < 3; ++axis) p[axis] = std::round(std::ldexp(p[axis], 20)) * std::ldexp(1, -20);
  return cloud;
}

ReconstructParams coarse() {
  ReconstructParams params;
  params.place.resolution = resolution;
  return params;
}

uint64_t hash_of(const PointCloud& cloud) { return hash_mesh(reconstruct(cloud, coarse(), Context(2)).mesh); }

TEST(Reconstructor, GivesAtAnyTimeTheBytesOfAllScansAtOnce) {
  Reconstructor scans;
  PointCloud all;
  for (const int seed : {1, 2, 3}) {
    scans.add(part(seed));
    all.append(part(seed));
    EXPECT_EQ(hash_mesh(scans.reconstruct(coarse(), Context(1)).mesh), hash_of(all)) << seed << " scans";
    EXPECT_EQ(scans.cloud().scans.size(), static_cast<size_t>(seed));
  }
}

TEST(Reconstructor, APoseTakesAScanToTheCommonFrame) {
  const auto there = [](Vec3d p) { return Vec3d{p.y + 4, 2 - p.x, p.z - 8}; };  // turn_back
  Reconstructor scans;
  scans.add(part(1));
  PointCloud local = part(2);
  for (Vec3d& p : local.positions) p = there(p);
  for (Vec3f& n : local.normals) n = {n.y, -n.x, n.z};
  scans.add(local, &turn);
  PointCloud all = part(1);
  all.append(part(2));
  EXPECT_EQ(scans.cloud().positions, all.positions);
  EXPECT_EQ(scans.cloud().normals, all.normals);
  EXPECT_EQ(hash_mesh(scans.reconstruct(coarse(), Context(2)).mesh), hash_of(all));
  scans.add(PointCloud(scans.cloud()), &turn_back);
  EXPECT_EQ(scans.cloud().positions.back(), there(all.positions.back()));
}

TEST(Reconstructor, AScannerOfUnknownPositionStandsAtThePosesOrigin) {
  Reconstructor scans;
  scans.add(part(1), &turn);
  EXPECT_EQ(scans.cloud().scans[0].sensor, (Vec3d{2, -4, 8}));
  PointCloud known = part(2);
  known.scans[0].sensor = Vec3d{1, 2, 3};
  scans.add(known, &turn);
  EXPECT_EQ(scans.cloud().scans[1].sensor, (Vec3d{0, -3, 11}));
  scans.add(part(3));
  EXPECT_EQ(scans.cloud().scans[2].sensor, std::nullopt);
  PointCloud each = part(4);
  each.sensors.assign(each.size(), Vec3d{1, 2, 3});
  scans.add(each, &turn);
  EXPECT_EQ(scans.cloud().scans[3].sensor, std::nullopt);
  EXPECT_EQ(scans.cloud().sensors.back(), (Vec3d{0, -3, 11}));
}

TEST(Reconstructor, ACloudWithoutScansIsOne) {
  PointCloud cloud = part(1);
  cloud.scans.clear();
  Reconstructor scans;
  scans.add(cloud);
  ASSERT_EQ(scans.cloud().scans.size(), 1u);
  EXPECT_EQ(scans.cloud().scans[0].size(), cloud.size());
}

TEST(Reconstructor, WhatIsRefusedIsNotAdded) {
  Reconstructor scans;
  scans.add(part(1));
  const size_t size = scans.cloud().size();
  Matrix stretched = identity, mirrored = identity, perspective = identity, broken = identity;
  stretched[0] = 2;
  mirrored[0] = -1;
  perspective[12] = 1;
  broken[3] = std::numeric_limits<double>::quiet_NaN();
  for (const Matrix& pose : {stretched, mirrored, perspective, broken})
    EXPECT_THROW(scans.add(part(2), &pose), ParameterError);
  PointCloud uneven = part(2);
  uneven.normals.pop_back();
  EXPECT_THROW(scans.add(uneven), ParameterError);
  EXPECT_THROW(scans.add(PointCloud()), ParameterError);
  EXPECT_EQ(scans.cloud().size(), size);
  EXPECT_THROW(Reconstructor().reconstruct(coarse(), Context(1)), SamplesError);
}

}  // namespace TEST_FILE
}  // namespace soapfilm
