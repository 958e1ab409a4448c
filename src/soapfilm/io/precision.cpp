#include "soapfilm/io/precision.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "soapfilm/core/farthest.h"
#include "soapfilm/core/has_area.h"
#include "soapfilm/core/vec.h"
#include "soapfilm/error.h"

namespace soapfilm::io {

double float_rounding_error(const std::vector<Vec3d>& points, Vec3d origin) {
  double largest = 0;
  for (const Vec3d& point : points) {
    const Vec3d p = point - origin;
    const Vec3d moved = p - static_cast<Vec3d>(static_cast<Vec3f>(p));
    largest = std::max({largest, std::abs(moved.x), std::abs(moved.y), std::abs(moved.z)});
  }
  return largest;
}

double mean_edge(const Mesh& mesh) {
  double sum = 0;
  for (const Triangle& t : mesh.triangles)
    for (size_t i = 0; i < 3; ++i) sum += norm(mesh.vertices[t[(i + 1) % 3]] - mesh.vertices[t[i]]);
  return mesh.triangles.empty() ? 0.0 : sum / (3.0 * static_cast<double>(mesh.triangles.size()));
}

double mesh_precision(const Mesh& mesh, double wanted) { return wanted > 0 ? wanted : 1e-3 * mean_edge(mesh); }

size_t collapsed_by_float(const Mesh& mesh, Vec3d origin) {
  const auto rounded = [&](uint32_t v) { return static_cast<Vec3d>(static_cast<Vec3f>(mesh.vertices[v] - origin)); };
  size_t count = 0;
  for (const Triangle& t : mesh.triangles) {
    const Vec3d a = rounded(t[0]);
    if (has_area(rounded(t[1]) - a, rounded(t[2]) - a)) continue;
    const Vec3d& exact = mesh.vertices[t[0]];
    count += has_area(mesh.vertices[t[1]] - exact, mesh.vertices[t[2]] - exact);
  }
  return count;
}

bool needs_double(const Mesh& mesh, double wanted) {
  return float_rounding_error(mesh.vertices) > mesh_precision(mesh, wanted) || collapsed_by_float(mesh) > 0;
}

void check_float_range(const std::string& path, const char* format, const Mesh& mesh, Vec3d origin) {
  // Below the first, coordinates lose digits or become zero; above the second, they become infinite.
  constexpr double smallest = 1e-30, largest = 1e38;
  const Box3d box = mesh.box();
  const double farthest = farthest_coordinate({box.lo - origin, box.hi - origin});
  if (farthest < smallest || farthest > largest)
    throw OutputError(
        fmt::format("{}: the mesh's largest coordinate = {:g}, {} holds {:g} to {:g}: write PLY or OBJ, "
                    "or change the unit",
                    path, farthest, format, smallest, largest));
}

void check_mesh(const Mesh& mesh) {
  const size_t n = mesh.vertices.size();
  const auto check_column = [n](const std::string& name, size_t size) {
    if (size != 0 && size != n)
      throw ParameterError(fmt::format("mesh: {} {}, must be none or one per vertex ({})", size, name, n));
  };
  check_column("normals", mesh.normals.size());
  check_column("colors", mesh.colors.size());
  for (const Column& attribute : mesh.attributes)
    if (attribute.values.size() != n) check_column("values of " + attribute.name, attribute.values.size());
  for (size_t i = 0; i < n; ++i)
    if (!is_finite(mesh.vertices[i])) throw ParameterError(fmt::format("mesh: vertex {} is not finite", i));
  if (mesh.triangles.empty()) throw ParameterError("mesh: 0 triangles, must be > 0");
  for (size_t i = 0; i < mesh.triangles.size(); ++i)
    for (const uint32_t v : mesh.triangles[i])
      if (v >= n) throw ParameterError(fmt::format("mesh: triangle {}: vertex {}, must be below {}", i, v, n));
}

}  // namespace soapfilm::io
