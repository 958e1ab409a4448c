// One primal-dual sweep over a band, fused: each brick is read and written once.
//
// Chambolle and Pock 2011, algorithm 1, with the primal step first:
//   u_new = clip(u - tau (grad^T p - f), 0, 1),   u_bar = 2 u_new - u,   p <- proj_{|.| <= lambda}(p + sigma grad
//   u_bar)
//
// where the anisotropic norm projects each component of p onto [-lambda, lambda].
//
// Bricks are visited in descending order. A brick's primal step reads the old p of itself and of its lower neighbors
// (not visited yet); its dual step reads u_bar of itself (still in L1) and of the first layers of its upper neighbors
// (just visited: they stored those layers). So u_bar is never stored completely, and the sweep is the exact Jacobi-like
// iteration for any order.
//
// Several sweeps at once: sweep k + 1 may step a brick as soon as sweep k has stepped it and its lower neighbors. With
// rows of bricks along x numbered from the upper end of y and z, and sweep k's rows shifted by k along both, every row
// depends only on rows before it, so the shifted rows are cut into rectangular tiles: all sweeps of a tile are done
// while its bricks are in the cache. The tiles of a row follow each other along y, and the next row finds what both
// read still in the cache; with several threads the tiles on a diagonal of a band of such rows run in parallel.
//
// Rows are skipped: a step with the same inputs as in the last sweep has the same result, so a row is stepped only when
// a value that it reads has changed. That is exact: the bits are those of sweeps that step every row. On scans half of
// the band soon stops changing, since u stays clipped and p constant away from the surface.
//
// Of a level in slabs (LevelState::slabs) a rank sweeps its own and the layers of bricks next to it. There what beyond
// is not known makes values wrong, from the far side on, by one vertex per sweep: after as many sweeps as a brick has
// vertices the slab's own values are still right, and the layers come anew from the ranks that own them.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "soapfilm/context.h"
#include "soapfilm/grid/field.h"
#include "soapfilm/kernels/sweep_kernel.h"
#include "soapfilm/solve/level.h"
#include "soapfilm/solve/level_solver.h"

namespace soapfilm {

/// The iteration on the CPU. Holds the data that one level's sweeps keep between bricks.
class Sweeper final : public LevelSolver {
 public:
  Sweeper(Level& level, const Context& context);

  /// Largest number of sweeps done while a tile is in the cache.
  static constexpr int tile_sweeps = sweeps_at_once;

  /// `times` iterations of the whole band. The result does not depend on threads or SIMD target. Between the sweeps of
  /// one Sweeper the level must not change: skipped rows rely on that. After a change of step sizes every row is
  /// stepped.
  void sweep(StepSizes steps, int times = 1) override;
  /// Brings the layers next to the slab up to date.
  void download() override;

  /// Bytes read and written per vertex by a sweep, for the roofline: u, p in and out, f in. With several sweeps at once
  /// most come from the cache.
  static constexpr double bytes_per_vertex = 4 * (2 + 6 + 1);

  /// u_bar at the first layers of a brick along x, y and z, 64 values each, the lower of the two remaining coordinates
  /// fastest. Those of a brick that follows another level's are written here, and the fluxes at its last layers into
  /// the level's p, before each sweep, of one iteration at a time.
  float* faces(size_t brick) { return faces_.data() + brick * 3 * brick_area; }
  /// Says which rows of a brick that follows another level's have another u_bar or p than in the last sweep.
  void follow(size_t brick, RowMask u_bar, RowMask p) {
    u_moved_[brick] |= u_bar;
    p_moved_[brick] |= p;
  }

  /// In slabs: sweeps until the layers next to the slab come anew. For a test: more than a brick's side is too many.
  int sweeps_per_exchange = brick_side;

 private:
  /// Some shifted rows of bricks, for `sweeps` sweeps. Rows and slices without bricks are not counted.
  struct Tile {
    int y, z;
    int sweeps;
  };

  RowMask primal_rows(size_t brick) const;
  RowMask dual_rows(size_t brick) const;
  void sweep_tiles(StepSizes steps, int sweeps);
  void exchange();
  /// On disk: what the slices [first, last), counted from the upper end of z, hold is read before they are swept.
  void fetch_slices(int first, int last) const;
  void sweep_tile(Tile tile, StepSizes steps);
  void sweep_brick(size_t brick, StepSizes steps);

  SweepKernel kernel_;
  std::optional<StepSizes> last_steps_;
  std::span<const BrickGrid::Slice> slices_;  ///< that are swept
  int since_exchange_ = 0;                    ///< sweeps
  std::vector<int> y_down_;                   ///< y of all rows of bricks, descending
  AlignedArray<float> faces_;                 ///< u_bar of each brick's first layers: 3 x 64
  std::vector<RowMask> u_moved_;              ///< per brick: rows changed by the last primal step
  std::vector<RowMask> p_moved_;              ///< and by the last dual step
  std::vector<RowMask> u_bar_moved_;          ///< rows whose u_bar differs from that of the last sweep
};

}  // namespace soapfilm
