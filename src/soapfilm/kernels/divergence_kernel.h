// Data for one brick's part of the data term, as plain arrays: the interface between divergence.cpp and the kernels,
// which are compiled once per SIMD target and do not depend on grids or threads.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "soapfilm/grid/layout.h"

namespace soapfilm {

/// The vectors around a brick, from vertex (-4, -4, -4) to (11, 11, 11), from which its data term is computed. Samples
/// lie on surfaces, so most rows are zero and marked as zero.
struct SplatWindow {
  static constexpr int reach = 4;
  static constexpr int side = brick_side + 2 * reach;
  static constexpr int components = 3;
  using Rows = std::array<uint16_t, side>;

  /// Row (y, z) of a component, `side` values.
  float* row(int y, int z, int component) { return values.data() + ((z * side + y) * components + component) * side; }
  bool empty() const {
    unsigned any = 0;
    for (const uint16_t rows : occupied) any |= rows;
    return any == 0;
  }

  alignas(64) std::array<float, static_cast<size_t>(components) * side * side * side> values{};
  Rows occupied{};  ///< bit y of [z]: the row may have values other than zero
};

/// Writes div (k * v) at the brick's 512 vertices and clears the window. f must be zero before.
using DivergenceKernel = void (*)(SplatWindow& window, float* f);

/// Of Highway's SIMD targets among `bits`, and of the scalar version.
DivergenceKernel highway_divergence_kernel(int64_t bits);
DivergenceKernel scalar_divergence_kernel();

}  // namespace soapfilm
