#include "tools/mesh/sample_mesh.h"

#include <algorithm>
#include <cmath>

#include "soapfilm/core/parallel.h"
#include "soapfilm/core/random.h"
#include "soapfilm/core/vec.h"
#include "soapfilm/error.h"

namespace soapfilm {

namespace {

constexpr size_t samples_per_task = 4096;

}  // namespace

TrianglesByArea::TrianglesByArea(const Mesh& mesh) {
  up_to_.reserve(mesh.triangles.size());
  double area = 0.0;
  for (const Triangle& t : mesh.triangles) {
    const Vec3d a = mesh.vertices[t[0]];
    area += 0.5 * norm(cross(mesh.vertices[t[1]] - a, mesh.vertices[t[2]] - a));
    up_to_.push_back(area);
  }
}

uint32_t TrianglesByArea::at(double area) const {
  auto found = std::upper_bound(up_to_.begin(), up_to_.end(), area);
  // At the very end: the last that has an area.
  if (found == up_to_.end()) found = std::lower_bound(up_to_.begin(), up_to_.end(), up_to_.back());
  return static_cast<uint32_t>(found - up_to_.begin());
}

std::vector<MeshPoint> sample_mesh(const Mesh& mesh, size_t count, uint64_t seed, const Context& context) {
  const TrianglesByArea row(mesh);
  const double area = row.total();
  if (!(area > 0.0) || !std::isfinite(area)) throw ParameterError("the mesh has no area, it must have some");

  std::vector<MeshPoint> points(count);
  const uint64_t first_stream = Random(seed).next();
  parallel_for(context, count, samples_per_task, [&](size_t i) {
    Random random(Random(first_stream + i).next());
    const double at = (static_cast<double>(i) + random.uniform()) / static_cast<double>(count) * area;
    const uint32_t index = row.at(at);
    const Triangle& t = mesh.triangles[index];
    // Uniform in a triangle: sqrt of one number, the other unchanged (Turk 1990).
    const double r = std::sqrt(random.uniform());
    const double s = random.uniform();
    const Vec3d a = mesh.vertices[t[0]];
    const Vec3d b = mesh.vertices[t[1]] - a, c = mesh.vertices[t[2]] - a;
    points[i] = {a + b * (r * (1.0 - s)) + c * (r * s), index};
  });
  return points;
}

}  // namespace soapfilm
