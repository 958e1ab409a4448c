// A hash of results that must be the same bytes.
#pragma once

#include <cstdint>
#include <cstring>
#include <span>

#include "soapfilm/mesh.h"

namespace soapfilm::test {

/// FNV-1a, 64 bits, over the bytes of plain values without padding.
template <class T>
uint64_t hash_bytes(std::span<const T> values, uint64_t seed = 0xCBF29CE484222325ull) {
  const auto* bytes = reinterpret_cast<const unsigned char*>(values.data());
  for (size_t i = 0; i < values.size_bytes(); ++i) seed = (seed ^ bytes[i]) * 0x100000001B3ull;
  return seed;
}

inline uint64_t hash_mesh(const Mesh& mesh) {
  return hash_bytes(std::span<const Triangle>(mesh.triangles), hash_bytes(std::span<const Vec3d>(mesh.vertices)));
}

}  // namespace soapfilm::test
