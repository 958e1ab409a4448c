// What holds of everything that a reader accepts. Without gtest: fuzz/ uses it, too.
#pragma once

#include <cmath>
#include <cstdint>
#include <set>
#include <string>

#include "soapfilm/core/vec.h"
#include "soapfilm/mesh.h"

namespace soapfilm::test {

inline bool is_empty_or(size_t size, size_t count) { return size == 0 || size == count; }

/// What is wrong with the columns of a cloud; empty: nothing.
inline std::string broken_column_law(const PointCloud& cloud) {
  for (const Vec3d& p : cloud.positions)
    if (!is_finite(p)) return "a position is not finite";
  for (const Vec3f& n : cloud.normals)
    if (!is_finite(static_cast<Vec3d>(n))) return "a normal is not finite";
  for (const float w : cloud.weights)
    if (!(w >= 0 && std::isfinite(w))) return "a weight is negative or not finite";
  for (const size_t size : {cloud.normals.size(), cloud.sensors.size(), cloud.weights.size(), cloud.colors.size()})
    if (!is_empty_or(size, cloud.size())) return "a column is not as long as the positions";
  std::set<std::string> names;
  for (const Column& column : cloud.columns) {
    if (column.values.size() != cloud.size()) return "column " + column.name + " is not as long as the positions";
    if (!names.insert(column.name).second) return "two columns are called " + column.name;
  }
  return "";
}

inline std::string broken_scan_law(const Scan& scan) {
  if (scan.sensor && !is_finite(*scan.sensor)) return "a scanner's position is not finite";
  if (scan.view_direction && !(std::abs(norm(*scan.view_direction) - 1) < 1e-6)) return "a view direction is not unit";
  if (!scan.range_grid) return "";
  const RangeGrid& grid = *scan.range_grid;
  if (grid.columns < 1 || grid.rows < 1) return "a range grid is empty";
  if (grid.sample.size() != static_cast<size_t>(grid.columns) * static_cast<size_t>(grid.rows))
    return "a range grid has not columns x rows cells";
  for (const int32_t s : grid.sample)
    if (s < -1 || s >= static_cast<int64_t>(scan.size())) return "a cell of a range grid names no sample";
  return "";
}

/// What is wrong with a cloud that was read; empty: nothing.
inline std::string broken_law(const PointCloud& cloud) {
  if (cloud.size() == 0) return "no samples";
  size_t covered = 0;
  for (const Scan& scan : cloud.scans) {
    if (scan.begin != covered || scan.end < scan.begin) return "scans leave gaps";
    covered = scan.end;
    if (std::string broken = broken_scan_law(scan); !broken.empty()) return broken;
  }
  if (covered != cloud.size()) return "scans do not cover the cloud";
  return broken_column_law(cloud);
}

/// The same of a mesh.
inline std::string broken_law(const Mesh& mesh) {
  const size_t count = mesh.vertices.size();
  if (mesh.triangles.empty()) return "no triangles";
  for (const Triangle& t : mesh.triangles)
    for (const uint32_t v : t)
      if (v >= count) return "a triangle names no vertex";
  for (const Vec3d& p : mesh.vertices)
    if (!is_finite(p)) return "a vertex is not finite";
  if (!is_empty_or(mesh.normals.size(), count) || !is_empty_or(mesh.colors.size(), count))
    return "normals or colors are not as many as vertices";
  for (const Column& attribute : mesh.attributes)
    if (attribute.values.size() != count) return "attribute " + attribute.name + " is not as long as the vertices";
  return "";
}

}  // namespace soapfilm::test
