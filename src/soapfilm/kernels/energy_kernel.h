// One brick's contribution to the energies, as plain pointers: the interface between energy.cpp and its kernel, which
// is compiled once per SIMD target and does not depend on grids or threads.
#pragma once

#include <cstdint>

#include "soapfilm/grid/layout.h"
#include "soapfilm/kernels/low_face.h"
#include "soapfilm/kernels/norm.h"

namespace soapfilm {

/// u of a brick and of the next vertices above it: (x, y, z) in [0, 9)^3, without the far edges. Rows are 16 floats
/// apart, so that a row shifted by one can be loaded.
struct UpperWindow {
  static constexpr int row = 16;
  static constexpr int layer = (brick_side + 1) * row;
  alignas(64) float values[(brick_side + 1) * layer];
  float& at(int x, int y, int z) { return values[x + row * y + layer * z]; }
  float at(int x, int y, int z) const { return values[x + row * y + layer * z]; }
};

struct EnergyJob {
  const float* p;               ///< 3 x 512
  const float* f;               ///< 512
  LowFace low_x, low_y, low_z;  ///< p below the brick
  Vec3i free_lo, free_hi;       ///< local range [lo, hi) of the vertices that count in data and dual
  double lambda;
  double p_scale;  ///< factor of p
  bool open;       ///< fixed vertices add nothing to the variation; `u` has no steps from free to fixed vertices above
  float* gap = nullptr;  ///< 512 zeros, or null: each vertex's part of the gap is written here
};

/// Summed lane by lane, the 8 lanes in a fixed tree: the same bits on every target.
struct EnergyTerms {
  double variation = 0;  ///< sum of |grad u|
  double data = 0;       ///< sum of f u
  double dual = 0;       ///< sum of min(0, r), r = grad^T p - f
  double gap = 0;        ///< sum of lambda |grad u| - p . grad u, and of r u - min(0, r)
  double max_norm_squared = 0;

  void operator+=(const EnergyTerms& t) {
    variation += t.variation;
    data += t.data;
    dual += t.dual;
    gap += t.gap;
    max_norm_squared = max_norm_squared < t.max_norm_squared ? t.max_norm_squared : max_norm_squared;
  }
};

using EnergyKernel = EnergyTerms (*)(const EnergyJob& job, const UpperWindow& u);

/// Of Highway's SIMD targets among `bits`, and of the scalar version.
EnergyKernel highway_energy_kernel(int64_t bits, Norm norm);
EnergyKernel scalar_energy_kernel(Norm norm);

}  // namespace soapfilm
