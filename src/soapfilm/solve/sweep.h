// One primal-dual sweep over a band, fused: each brick is read and written once.
//
// Chambolle and Pock 2011, algorithm 1, with the primal step first:
//   u_new = clip(u - tau (grad^T p - f), 0, 1),   u_bar = 2 u_new - u,   p <- proj_{|.| <= lambda}(p + sigma grad
//   u_bar)
//
// where the anisotropic norm projects each component of p onto [-lambda, lambda].
//
// Bricks are visited in descending order. A brick's primal step reads the old p of itself and of its lower neighbours
// (not visited yet); its dual step reads u_bar of itself (still in registers and L1) and of the first layers of its
// upper neighbours (just visited: they left those layers behind). So u_bar is never stored whole, and the sweep is the
// exact Jacobi-like iteration whatever the order. Chunks of bricks run in parallel; a brick with an upper neighbour in
// the next chunk keeps its u_bar aside and takes its dual step after all chunks are done.
#pragma once

#include "soapfilm/core/parallel.h"
#include "soapfilm/grid/field.h"
#include "soapfilm/solve/level.h"

namespace soapfilm {

/// Step sizes; tau sigma 12 <= 1 (12 bounds the squared norm of the gradient).
struct StepSizes {
  float sigma = 0;
  float tau = 0;
};

/// Owns what the sweeps of one level keep between bricks.
class Sweeper {
 public:
  Sweeper(Level& level, const Parallel& parallel);

  /// One iteration of the whole band. The result does not depend on threads or SIMD target.
  void sweep(StepSizes steps);

  /// Bytes that a sweep reads and writes per vertex, for the roofline: u, p in and out, f in.
  static constexpr double bytes_per_vertex = 4 * (2 + 6 + 1);

 private:
  void sweep_chunk(size_t begin, size_t end, StepSizes steps);
  void finish_brick(size_t slot, StepSizes steps);

  Level& level_;
  const Parallel& parallel_;
  size_t chunk_;
  AlignedArray<float> faces_;           ///< u_bar of each brick's first layers: 3 x 64
  std::vector<uint32_t> deferred_;      ///< bricks whose dual step waits for the next chunk
  std::vector<int32_t> deferred_slot_;  ///< per brick: position in deferred_, -1 for none
  AlignedArray<float> deferred_u_bar_;  ///< 512 values each
};

}  // namespace soapfilm
