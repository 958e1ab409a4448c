// A mesh whose distances are known.
#pragma once

#include <cstdint>

#include "soapfilm/core/vec.h"
#include "soapfilm/mesh.h"

namespace soapfilm::test {

/// n x n squares of side `step`, two triangles each, in the plane z = at.z that look along +z; corner at `at`.
inline Mesh flat_sheet(uint32_t n, Vec3d at, double step) {
  Mesh mesh;
  for (uint32_t i = 0; i <= n; ++i)
    for (uint32_t j = 0; j <= n; ++j) mesh.vertices.push_back(at + Vec3d{i * step, j * step, 0});
  for (uint32_t i = 0; i < n; ++i) {
    for (uint32_t j = 0; j < n; ++j) {
      const uint32_t a = i * (n + 1) + j;
      mesh.triangles.push_back({a, a + n + 1, a + n + 2});
      mesh.triangles.push_back({a, a + n + 2, a + 1});
    }
  }
  return mesh;
}

}  // namespace soapfilm::test
