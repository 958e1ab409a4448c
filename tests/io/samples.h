// Clouds and meshes that the tests write and read back.
#pragma once

#include <cmath>
#include <cstring>
#include <limits>

#include "soapfilm/cloud.h"
#include "soapfilm/core/random.h"
#include "soapfilm/core/vec.h"
#include "soapfilm/mesh.h"

namespace soapfilm {

/// `scans` scans of `rows` x `columns` range images with every third cell empty, with all columns a cloud can have.
inline PointCloud rich_cloud(int scans, int columns, int rows, uint64_t seed, Vec3d offset = {}) {
  Random random(seed);
  PointCloud cloud;
  cloud.columns = {{"intensity", {}, false}, {"classification", {}, true}};
  for (int s = 0; s < scans; ++s) {
    Scan scan;
    scan.name = "scan number " + std::to_string(s);
    scan.begin = cloud.size();
    RangeGrid grid{columns, rows, {}};
    for (int cell = 0; cell < columns * rows; ++cell) {
      grid.sample.push_back(cell % 3 == 2 ? -1 : static_cast<int32_t>(cloud.size() - scan.begin));
      if (cell % 3 == 2) continue;
      cloud.positions.push_back(offset + Vec3d{random.uniform(), random.uniform(), random.uniform()});
      cloud.normals.push_back(
          {static_cast<float>(random.normal()), static_cast<float>(random.normal()), static_cast<float>(cell)});
      cloud.sensors.push_back(offset + Vec3d{random.normal(), 3.5, random.normal()});
      cloud.weights.push_back(static_cast<float>(random.uniform(0, 4)));
      cloud.colors.push_back({static_cast<uint8_t>(cell), static_cast<uint8_t>(s), 255});
      cloud.columns[0].values.push_back(static_cast<float>(random.normal()));
      cloud.columns[1].values.push_back(static_cast<float>(cell % 5));
    }
    scan.end = cloud.size();
    scan.range_grid = grid;
    if (s % 2 == 0) scan.sensor = offset + Vec3d{0.1 * s, 1.0 / 3.0, -2};
    if (s % 2 == 1) scan.view_direction = normalized(Vec3d{1, 2.0 * s, -0.3});
    cloud.scans.push_back(scan);
  }
  return cloud;
}

/// Names, samples, scanners and grids.
inline void expect_same_scans(const PointCloud& a, const PointCloud& b) {
  ASSERT_EQ(a.scans.size(), b.scans.size());
  for (size_t s = 0; s < a.scans.size(); ++s) {
    EXPECT_EQ(a.scans[s].name, b.scans[s].name);
    EXPECT_EQ(a.scans[s].begin, b.scans[s].begin);
    EXPECT_EQ(a.scans[s].end, b.scans[s].end);
    EXPECT_EQ(a.scans[s].sensor, b.scans[s].sensor);
    ASSERT_EQ(a.scans[s].view_direction.has_value(), b.scans[s].view_direction.has_value());
    ASSERT_EQ(a.scans[s].range_grid.has_value(), b.scans[s].range_grid.has_value());
    if (!a.scans[s].range_grid) continue;
    EXPECT_EQ(a.scans[s].range_grid->columns, b.scans[s].range_grid->columns);
    EXPECT_EQ(a.scans[s].range_grid->rows, b.scans[s].range_grid->rows);
    EXPECT_EQ(a.scans[s].range_grid->sample, b.scans[s].range_grid->sample);
  }
}

inline void expect_same_cloud(const PointCloud& a, const PointCloud& b) {
  EXPECT_EQ(a.positions, b.positions);
  EXPECT_EQ(a.normals, b.normals);
  EXPECT_EQ(a.sensors, b.sensors);
  EXPECT_EQ(a.weights, b.weights);
  EXPECT_EQ(a.colors, b.colors);
  ASSERT_EQ(a.columns.size(), b.columns.size());
  for (size_t c = 0; c < a.columns.size(); ++c) {
    EXPECT_EQ(a.columns[c].name, b.columns[c].name);
    EXPECT_EQ(a.columns[c].values, b.columns[c].values);
    EXPECT_EQ(a.columns[c].is_label, b.columns[c].is_label);
  }
  ASSERT_NO_FATAL_FAILURE(expect_same_scans(a, b));
  for (size_t s = 0; s < a.scans.size(); ++s)
    if (a.scans[s].view_direction) {
      EXPECT_LT(norm(*a.scans[s].view_direction - *b.scans[s].view_direction), 1e-15);
    }
}

/// A closed torus of edge length about 2 pi size / n, with normals, colors and two attributes.
inline Mesh torus_mesh(uint32_t n, double size, Vec3d offset = {}) {
  Mesh mesh;
  constexpr double two_pi = 6.283185307179586;
  Column height{"height", {}};
  Column column{"column", {}};
  for (uint32_t i = 0; i < n; ++i)
    for (uint32_t j = 0; j < n; ++j) {
      const double a = two_pi * i / n;
      const double b = two_pi * j / n;
      const Vec3d normal{std::cos(a) * std::cos(b), std::sin(a) * std::cos(b), std::sin(b)};
      const Vec3d center{std::cos(a), std::sin(a), 0};
      mesh.vertices.push_back(offset + size * (center + 0.4 * normal));
      mesh.normals.push_back(static_cast<Vec3f>(normal));
      mesh.colors.push_back({static_cast<uint8_t>(i), static_cast<uint8_t>(j), 77});
      height.values.push_back(static_cast<float>(size * normal.z));
      column.values.push_back(static_cast<float>(i));
    }
  for (uint32_t i = 0; i < n; ++i)
    for (uint32_t j = 0; j < n; ++j) {
      const auto v = [n](uint32_t p, uint32_t q) { return p % n * n + q % n; };
      mesh.triangles.push_back({v(i, j), v(i + 1, j), v(i + 1, j + 1)});
      mesh.triangles.push_back({v(i, j), v(i + 1, j + 1), v(i, j + 1)});
    }
  mesh.attributes = {height, column};
  return mesh;
}

/// Largest distance of corresponding vertices.
inline double largest_move(const Mesh& a, const Mesh& b) {
  double largest = a.vertices.size() == b.vertices.size() ? 0 : std::numeric_limits<double>::infinity();
  for (size_t i = 0; i < std::min(a.vertices.size(), b.vertices.size()); ++i)
    largest = std::max(largest, norm(a.vertices[i] - b.vertices[i]));
  return largest;
}

}  // namespace soapfilm
