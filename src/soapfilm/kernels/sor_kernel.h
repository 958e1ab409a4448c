// What one row's share of an SOR iteration needs, as plain pointers: the contract between sor_pass.cpp and the kernels,
// which exist once per SIMD target and know nothing of grids or threads.
//
// A row is a line of values along x in a whole-box array; its neighbors along y and z sit at constant distances. It is
// cut into runs of 8 values from its first one; only the runs marked active are touched.
#pragma once

#include <cstddef>
#include <cstdint>

namespace soapfilm {

inline constexpr int sor_run = 8;      ///< values in a run
inline constexpr int sor_rows = 8;     ///< rows that the lexicographic kernel takes at once
inline constexpr int slope_sums = 32;  ///< so many that a sum need not wait for the one before

/// What the values of a run have in common.
enum class RunKind : uint8_t { zero, one, mixed };

inline RunKind run_kind(const float* u, int count) {
  bool zero = true, one = true;
  for (int i = 0; i < count; ++i) {
    zero &= u[i] == 0.0f;
    one &= u[i] == 1.0f;
  }
  return zero ? RunKind::zero : one ? RunKind::one : RunKind::mixed;
}

/// The slope of u along a row: by forward differences for the total variation, by the paper's for the diffusivity.
struct SlopeJob {
  const float* u;
  const float *front, *above;  ///< the next rows along y and z
  const float *back, *below;   ///< where g's differences begin: the rows before, or the row itself (forward)
  ptrdiff_t left;              ///< the same along x: -1 or 0
  float per_step;              ///< one over the distance that g's differences span: 1/2 or 1
  float epsilon_squared;
  float* g;           ///< receives 1 / sqrt(|grad u|^2 + epsilon^2); null: not wanted
  double* variation;  ///< partial sums of |grad u|: value x goes to number x mod slope_sums
};

struct SorRow {
  float* u;        ///< in and out
  RunKind* kinds;  ///< of the row's runs, renewed where they are touched; null: not kept
  const float* g;
  const float* g_below;  ///< the same row of the layers below and above
  const float* g_above;
  const float* f;  ///< 2 f / lambda
};

struct RelaxJob {
  int size;              ///< values in a row; the first and the last are fixed to 0
  ptrdiff_t row, layer;  ///< distances to the neighbors along y and z
  float omega;
  float low, high;  ///< u < low becomes 0, u > high becomes 1
};

/// The steps of one SIMD target.
struct SorKernel {
  /// For the values [begin, end) of a row; begin a multiple of 8.
  void (*slope)(const SlopeJob& job, int begin, int end);
  /// Equation (8) along up to sor_rows rows that do not depend on one another, each from its first to its last value.
  /// A run that is not active must be constant with all its neighbors equal and f = 0: (8) leaves such a run alone,
  /// unless the run before it has just changed, which the kernel sees.
  void (*relax)(const RelaxJob& job, const SorRow* rows, int count, const uint8_t* active);
  /// Equation (8) for the values of a row with x mod 2 = parity, all from the values of the other color.
  void (*relax_color)(const RelaxJob& job, const SorRow& row, int parity, const uint8_t* active);
};

/// Of Highway's SIMD targets among `bits`, and the scalar twin.
SorKernel highway_sor_kernel(int64_t bits);
SorKernel scalar_sor_kernel();

}  // namespace soapfilm
