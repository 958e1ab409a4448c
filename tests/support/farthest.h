// How far two meshes are from each other, by samples: what proofs are compared with.
#pragma once

#include <algorithm>
#include <utility>
#include <vector>

#include "soapfilm/core/vec.h"
#include "tools/mesh/distance.h"
#include "tools/mesh/sample_mesh.h"

namespace soapfilm::test {

/// The largest distance of a corner, the middle of an edge or a sample of either mesh from the other one.
inline double farthest_between(const Mesh& a, const Mesh& b, const Context& context) {
  constexpr size_t samples = 40000;
  double farthest = 0;
  for (const auto& [from, to] : {std::pair{&a, &b}, std::pair{&b, &a}}) {
    std::vector<Vec3d> points;
    for (const MeshPoint& p : sample_mesh(*from, samples, 1, context)) points.push_back(p.position);
    for (const Triangle& t : from->triangles)
      for (size_t k = 0; k < 3; ++k) {
        points.push_back(from->vertices[t[k]]);
        points.push_back((from->vertices[t[k]] + from->vertices[t[(k + 1) % 3]]) * 0.5);
      }
    for (const double d : distances_to_mesh(points, *to, context)) farthest = std::max(farthest, d);
  }
  return farthest;
}

}  // namespace soapfilm::test
