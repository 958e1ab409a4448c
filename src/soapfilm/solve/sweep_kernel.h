// What one brick's share of a sweep needs, as plain pointers: the contract between sweep.cpp and the kernels, which
// exist once per SIMD target and know nothing of grids or threads.
#pragma once

#include <cstdint>

#include "soapfilm/grid/layout.h"
#include "soapfilm/solve/low_face.h"
#include "soapfilm/solve/norm.h"

namespace soapfilm {

/// One bit per row of a brick: row (y, z) is bit y + 8 z.
using RowMask = uint64_t;

/// Halo of u_bar: rows are 16 floats apart, so that a row shifted by one can be loaded; vertex (x, y, z) of
/// [0, 9)^3 is at x + 16 y + 144 z.
struct UBar {
  static constexpr int row = 16;
  static constexpr int layer = 9 * row;
  alignas(64) float values[9 * layer];
};

struct PrimalJob {
  RowMask rows;                 ///< the others keep their u, and u_bar is left as it is
  float* u;                     ///< 512, in and out
  const float* p;               ///< 3 x 512
  const float* f;               ///< 512
  LowFace low_x, low_y, low_z;  ///< p below the brick
  Vec3i free_lo, free_hi;       ///< u stays 0 outside this local range [lo, hi)
  float tau;
  // What the next brick reads: on its way into the cache while this one is worked on. Its low_x is most often the p_x
  // of the brick after it, so that p_x is fetched a brick earlier than the rest.
  const float *next_u, *next_p, *next_f;
  LowFace next_low_y, next_low_z;
  const float* after_next_p;
};

struct DualJob {
  RowMask rows;      ///< the others keep their p
  float* p;          ///< 3 x 512, in and out
  bool fixed_up[3];  ///< the flux through the brick's upper face along an axis is fixed
  float sigma;
  float lambda;
};

/// The steps of one SIMD target for one norm; both return the rows where a value has changed.
struct SweepKernel {
  RowMask (*primal)(const PrimalJob& job, UBar& u_bar);
  RowMask (*dual)(const DualJob& job, const UBar& u_bar);
};

/// The kernel of the best target of this processor, or of the one that force_simd_target() named.
SweepKernel sweep_kernel(Norm norm);

}  // namespace soapfilm
