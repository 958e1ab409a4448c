// A small closed mesh whose triangles are about as long as a voxel.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

#include "soapfilm/core/vec.h"
#include "soapfilm/mesh.h"

namespace soapfilm::test {

/// A torus around the z axis, `around` times `across` quadrilaterals, each cut along a diagonal; normals look outwards.
inline Mesh grid_torus(Vec3d center, double large, double small, uint32_t around, uint32_t across) {
  Mesh mesh;
  for (uint32_t i = 0; i < around; ++i)
    for (uint32_t j = 0; j < across; ++j) {
      const double a = 2 * std::numbers::pi * i / around, b = 2 * std::numbers::pi * j / across;
      const double r = large + small * std::cos(b);
      mesh.vertices.push_back(center + Vec3d{r * std::cos(a), r * std::sin(a), small * std::sin(b)});
    }
  const auto at = [&](uint32_t i, uint32_t j) { return i % around * across + j % across; };
  for (uint32_t i = 0; i < around; ++i)
    for (uint32_t j = 0; j < across; ++j) {
      mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  return mesh;
}

}  // namespace soapfilm::test
