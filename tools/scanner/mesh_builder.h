// Triangles by position: vertices that agree in every bit are one vertex.
#pragma once

#include <cstring>
#include <unordered_map>

#include "soapfilm/core/vec.h"
#include "soapfilm/mesh.h"

namespace soapfilm {

class MeshBuilder {
 public:
  uint32_t vertex(Vec3d p) {
    p = p + Vec3d{};  // -0 becomes 0
    const auto [entry, is_new] = index_.try_emplace(p, static_cast<uint32_t>(mesh_.vertices.size()));
    if (is_new) mesh_.vertices.push_back(p);
    return entry->second;
  }
  void triangle(uint32_t a, uint32_t b, uint32_t c) {
    if (a != b && b != c && c != a) mesh_.triangles.push_back({a, b, c});
  }
  /// Corners counter-clockwise seen from outside.
  void quad(uint32_t a, uint32_t b, uint32_t c, uint32_t d) {
    triangle(a, b, c);
    triangle(a, c, d);
  }
  Mesh take() { return std::move(mesh_); }

 private:
  struct Hash {
    size_t operator()(const Vec3d& p) const {
      uint64_t h = 0;
      for (const double c : {p.x, p.y, p.z}) {
        uint64_t bits;
        std::memcpy(&bits, &c, sizeof bits);
        h = (h ^ bits ^ (h >> 29)) * 0x9E3779B97F4A7C15ull;
      }
      return static_cast<size_t>(h ^ (h >> 32));
    }
  };

  Mesh mesh_;
  std::unordered_map<Vec3d, uint32_t, Hash> index_;
};

}  // namespace soapfilm
