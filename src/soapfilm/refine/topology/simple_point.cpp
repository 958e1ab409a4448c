#include "soapfilm/refine/topology/simple_point.h"

#include <array>
#include <bit>
#include <cstdlib>

namespace soapfilm {

namespace {

struct Tables {
  std::array<uint32_t, 27> faces{};  ///< neighbors that share a face
  std::array<uint32_t, 27> all{};    ///< all 26 neighbors
  uint32_t near18 = 0;               ///< around the middle, without corners
};

constexpr int middle = 13;

constexpr Tables make_tables() {
  Tables t;
  for (int a = 0; a < 27; ++a) {
    for (int b = 0; b < 27; ++b) {
      const int d[3] = {a % 3 - b % 3, a / 3 % 3 - b / 3 % 3, a / 9 - b / 9};
      int steps = 0;
      bool near = true;
      for (const int k : d) {
        steps += k < 0 ? -k : k;
        near = near && k >= -1 && k <= 1;
      }
      if (a == b || !near) continue;
      t.all[static_cast<size_t>(a)] |= 1u << b;
      if (steps == 1) t.faces[static_cast<size_t>(a)] |= 1u << b;
      if (a == middle && steps < 3) t.near18 |= 1u << b;
    }
  }
  return t;
}

constexpr Tables tables = make_tables();

/// All of `allowed` that is connected to `seed`.
uint32_t flood(uint32_t seed, uint32_t allowed, const std::array<uint32_t, 27>& adjacent) {
  uint32_t reached = seed;
  for (uint32_t front = seed; front != 0;) {
    uint32_t next = 0;
    for (; front != 0; front &= front - 1) next |= adjacent[static_cast<size_t>(std::countr_zero(front))];
    front = next & allowed & ~reached;
    reached |= front;
  }
  return reached;
}

}  // namespace

bool is_simple(Neighborhood inside) {
  const uint32_t object = inside & tables.near18;
  const uint32_t touching = object & tables.faces[middle];
  const uint32_t background = ~inside & tables.all[middle];
  if (touching == 0 || background == 0) return false;
  if ((touching & ~flood(touching & (~touching + 1), object, tables.faces)) != 0) return false;
  return flood(background & (~background + 1), background, tables.all) == background;
}

bool is_alone(Neighborhood inside) {
  return inside >> middle & 1 ? (inside & tables.faces[middle]) == 0 : (~inside & tables.all[middle]) == 0;
}

}  // namespace soapfilm
