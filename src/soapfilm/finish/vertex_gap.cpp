#include "soapfilm/finish/vertex_gap.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "soapfilm/core/parallel.h"

namespace soapfilm {

namespace {

/// The vertices of the lattice under the tent around a place, along one axis.
struct Tent {
  static constexpr int width = 2 * static_cast<int>(gap_reach);
  int first;
  double weight[width];

  explicit Tent(double at) : first(static_cast<int>(std::floor(at)) - width / 2 + 1) {
    for (int i = 0; i < width; ++i) weight[i] = 1 - std::abs(first + i - at) / gap_reach;
  }
};

double gap_around(Vec3d at, const GapField& field) {
  const Tent x(at.x), y(at.y), z(at.z);
  double sum = 0;
  bool near = false;
  for (int k = 0; k < Tent::width; ++k)
    for (int j = 0; j < Tent::width; ++j)
      for (int i = 0; i < Tent::width; ++i) {
        const Vec3i v{x.first + i, y.first + j, z.first + k};
        const int32_t found = field.grid.find(brick_of(v));
        if (found < 0) continue;
        const auto brick = static_cast<size_t>(found);
        const double gap{field.gap.brick(brick)[brick_offset(v.x & 7, v.y & 7, v.z & 7)]};
        const double weight = x.weight[i] * y.weight[j] * z.weight[k];
        sum += weight * gap;
        near = near || (weight > 0 && field.beside[brick].test(v.x & 7, v.y & 7, v.z & 7));
      }
  return near ? std::max(0.0, sum) : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace

std::vector<float> vertex_gap(const Mesh& mesh, const GapField& field, const Lattice& lattice, const Context& context) {
  constexpr size_t vertices_at_once = 1024;
  constexpr double area = gap_reach * gap_reach;  // of a plane through the middle, across an axis
  std::vector<float> of_vertex(mesh.vertices.size());
  parallel_for(context, mesh.vertices.size(), vertices_at_once, [&](size_t v) {
    of_vertex[v] = static_cast<float>(gap_around(lattice.to_lattice(mesh.vertices[v]), field) / area);
  });
  return of_vertex;
}

}  // namespace soapfilm
