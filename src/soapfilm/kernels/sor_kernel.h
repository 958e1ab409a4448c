// Data for one row's part of an SOR iteration, as plain pointers: the interface between sor_pass.cpp and the kernels,
// which are compiled once per SIMD target and do not depend on grids or threads.
//
// A row is a line of values along x in a whole-box array; its neighbors along y and z are at constant distances. It is
// cut into runs of 8 values from its first one; only the runs marked active are processed.
#pragma once

#include <cstddef>
#include <cstdint>

namespace soapfilm {

inline constexpr int sor_run = 8;      ///< values in a run
inline constexpr int sor_rows = 8;     ///< rows that the lexicographic kernel processes at once
inline constexpr int slope_sums = 32;  ///< so many that a sum does not wait for the previous one

/// The common value of a run.
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
  const float *back, *below;   ///< where g's differences start: the rows before, or the row itself (forward)
  ptrdiff_t left;              ///< the same along x: -1 or 0
  float per_step;              ///< 1 / length of g's differences: 1/2 or 1
  float epsilon_squared;
  float* g;           ///< output 1 / sqrt(|grad u|^2 + epsilon^2); null: none
  double* variation;  ///< partial sums of |grad u|: value x is added to number x mod slope_sums
};

struct SorRow {
  float* u;        ///< in and out
  RunKind* kinds;  ///< of the row's runs, updated where they are relaxed; null: not stored
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
  /// Equation (8) along up to sor_rows rows that do not depend on one another, each from its first to its last value. A
  /// run that is not active must be constant with all its neighbors equal and f = 0: (8) does not change such a run,
  /// unless the previous run has just changed, which the kernel detects.
  void (*relax)(const RelaxJob& job, const SorRow* rows, int count, const uint8_t* active);
  /// Equation (8) for the values of a row with x mod 2 = parity, all from the values of the other color.
  void (*relax_color)(const RelaxJob& job, const SorRow& row, int parity, const uint8_t* active);
};

/// Of Highway's SIMD targets among `bits`, and of the scalar version.
SorKernel highway_sor_kernel(int64_t bits);
SorKernel scalar_sor_kernel();

}  // namespace soapfilm
