#include "soapfilm/scanner/sample_surface.h"

#include <algorithm>
#include <cmath>

#include "soapfilm/core/random.h"

namespace soapfilm {

PointCloud sample_surface(const Surface& surface, size_t count, uint64_t seed) {
  const Mesh mesh = surface.tessellate(1e-4 * surface.box().longest());
  std::vector<double> area_up_to;
  double area = 0.0;
  for (const Triangle& t : mesh.triangles) {
    const Vec3d a = mesh.vertices[t[0]];
    area += 0.5 * norm(cross(mesh.vertices[t[1]] - a, mesh.vertices[t[2]] - a));
    area_up_to.push_back(area);
  }

  PointCloud cloud;
  cloud.positions.reserve(count);
  cloud.normals.reserve(count);
  Random random(seed);
  for (size_t i = 0; i < count; ++i) {
    const auto found = std::upper_bound(area_up_to.begin(), area_up_to.end(), random.uniform() * area);
    const size_t index = std::min(static_cast<size_t>(found - area_up_to.begin()), mesh.triangles.size() - 1);
    const Triangle& t = mesh.triangles[index];
    // Uniform in a triangle: sqrt of one number, the other as it is (Turk 1990).
    const double r = std::sqrt(random.uniform());
    const double s = random.uniform();
    const Vec3d p =
        mesh.vertices[t[0]] * (1.0 - r) + mesh.vertices[t[1]] * (r * (1.0 - s)) + mesh.vertices[t[2]] * (r * s);
    const SurfacePoint on_surface = surface.closest(p);
    cloud.positions.push_back(on_surface.position);
    cloud.normals.push_back(static_cast<Vec3f>(on_surface.normal));
  }
  cloud.scans.push_back({"samples", 0, count, {}, {}, {}});
  return cloud;
}

}  // namespace soapfilm
