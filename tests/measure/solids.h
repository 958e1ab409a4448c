// Meshes whose volumes are known.
#pragma once

#include <cmath>
#include <functional>
#include <numbers>

#include "soapfilm/core/random.h"
#include "soapfilm/core/vec.h"
#include "soapfilm/mesh.h"
#include "support/flat_sheet.h"

namespace soapfilm::test {

inline Mesh box_mesh(Vec3d lo, Vec3d hi) {
  Mesh mesh;
  for (uint32_t k = 0; k < 8; ++k)
    mesh.vertices.push_back({k & 1 ? hi.x : lo.x, k & 2 ? hi.y : lo.y, k & 4 ? hi.z : lo.z});
  mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return mesh;
}

/// The square [0, side]^2 as n x n cells at height(x, y), looking up.
inline Mesh relief(uint32_t n, double side, const std::function<double(double, double)>& height) {
  Mesh mesh = flat_sheet(n, {}, side / n);
  for (Vec3d& v : mesh.vertices) v.z = height(v.x, v.y);
  return mesh;
}

struct Motion {
  Vec3d axis[3];
  Vec3d shift;

  Vec3d vector(Vec3d v) const { return axis[0] * v.x + axis[1] * v.y + axis[2] * v.z; }
  Vec3d point(Vec3d p) const { return vector(p) + shift; }
};

/// Turns and shifts at random.
inline Motion random_motion(Random& random, double shift) {
  const auto direction = [&] {
    return normalized(Vec3d{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)});
  };
  Motion m;
  m.axis[0] = direction();
  m.axis[1] = normalized(cross(m.axis[0], direction()));
  m.axis[2] = cross(m.axis[0], m.axis[1]);
  m.shift = direction() * shift;
  return m;
}

inline Mesh moved(Mesh mesh, const Motion& motion) {
  for (Vec3d& v : mesh.vertices) v = motion.point(v);
  return mesh;
}

inline Mesh flipped(Mesh mesh) {
  for (Triangle& t : mesh.triangles) std::swap(t[1], t[2]);
  return mesh;
}

}  // namespace soapfilm::test
