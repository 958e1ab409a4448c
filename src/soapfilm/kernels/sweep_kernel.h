// Data for one brick's part of a sweep, as plain pointers: the interface between sweep.cpp and the kernels, which are
// compiled once per SIMD target and do not depend on grids or threads.
#pragma once

#include <cstdint>

#include "soapfilm/grid/layout.h"
#include "soapfilm/kernels/low_face.h"
#include "soapfilm/kernels/norm.h"

namespace soapfilm {

/// One bit per row of a brick: row (y, z) is bit y + 8 z. Rows 2 i and 2 i + 1 are in one cache line.
using RowMask = uint64_t;

/// u_bar of one brick; the values after the last row may be read.
struct UBar {
  alignas(64) float values[brick_volume + brick_side];
};

struct PrimalJob {
  RowMask pairs;                ///< bit 2 i: rows 2 i and 2 i + 1 are stepped; the others keep their u and u_bar
  float* u;                     ///< 512, in and out
  const float* p;               ///< 3 x 512
  const float* f;               ///< 512
  LowFace low_x, low_y, low_z;  ///< p below the brick
  Vec3i free_lo, free_hi;       ///< u stays 0 outside this local range [lo, hi)
  float tau;
  float* u_bar;   ///< 512, out
  float* face_x;  ///< 64, out: u_bar at x = 0 of each stepped row
  // Data of the next brick, prefetched while this one is processed. Its low_x is mostly the p_x of the brick after it,
  // so that p_x is prefetched one brick earlier than the rest.
  const float *next_u, *next_f;
  LowFace next_low_y, next_low_z;
  const float* after_next_p;
};

struct DualJob {
  RowMask pairs;                             ///< as above; the others keep their p
  float* p;                                  ///< 3 x 512, in and out
  const float* u_bar;                        ///< 512
  const float *above_x, *above_y, *above_z;  ///< u_bar of the upper neighbors' first layers: 64 values each
  bool fixed_up[3];                          ///< the flux through the brick's upper face along an axis is fixed
  float sigma;
  float lambda;
  const float* next_p;  ///< the next brick's: its p_y and p_z are prefetched here, so both steps load about half each
  bool at_open_border = false;            ///< faces to, from or between fixed vertices have no flux:
  Vec3i free_lo{}, free_hi{}, last_up{};  ///< p_k changes in [free_lo, free_hi), along axis k in [free_lo, last_up)
};

/// The steps of one SIMD target for one norm; both return the rows where a value has changed.
struct SweepKernel {
  RowMask (*primal)(const PrimalJob& job);
  RowMask (*dual)(const DualJob& job);
};

/// Of Highway's SIMD targets among `bits`, and of the scalar version.
SweepKernel highway_sweep_kernel(int64_t bits, Norm norm);
SweepKernel scalar_sweep_kernel(Norm norm);

}  // namespace soapfilm
