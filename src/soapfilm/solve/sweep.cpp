#include "soapfilm/solve/sweep.h"

#include <algorithm>

#include "soapfilm/solve/sweep_kernel.h"

namespace soapfilm {

namespace {

constexpr size_t faces_per_brick = 3 * brick_area;
constexpr int32_t not_deferred = -1;

/// One chunk on one thread has nothing to defer; several per thread keep the threads busy to the end; below some
/// hundred bricks (a fraction of a millisecond) waking a thread costs more than it brings.
size_t chunk_size(size_t bricks, int threads) {
  constexpr size_t chunks_per_thread = 6;
  constexpr size_t least_chunk = 256;
  if (threads == 1) return std::max<size_t>(bricks, 1);
  return std::max<size_t>(bricks / (chunks_per_thread * static_cast<size_t>(threads)), least_chunk);
}

/// Leaves the first layers of u_bar behind for the lower neighbours.
void store_faces(const UBar& bar, float* faces) {
  for (int b = 0; b < brick_side; ++b) {
    for (int a = 0; a < brick_side; ++a) {
      faces[a + brick_side * b] = bar.values[a * UBar::row + b * UBar::layer];
      faces[brick_area + a + brick_side * b] = bar.values[a + b * UBar::layer];
      faces[2 * brick_area + a + brick_side * b] = bar.values[a + b * UBar::row];
    }
  }
}

/// Puts the upper neighbours' first layers around u_bar; zero where there is none.
void load_halo(const BrickGrid& grid, size_t brick, const float* all_faces, UBar& bar) {
  static constexpr float zeros[brick_area] = {};
  const float* faces[3];
  for (int axis = 0; axis < 3; ++axis) {
    const int32_t up = grid.neighbors(brick)[static_cast<size_t>(slot_up[axis])];
    faces[axis] = up < 0 ? zeros : all_faces + static_cast<size_t>(up) * faces_per_brick + axis * brick_area;
  }
  for (int b = 0; b < brick_side; ++b) {
    for (int a = 0; a < brick_side; ++a) {
      bar.values[8 + a * UBar::row + b * UBar::layer] = faces[0][a + brick_side * b];
      bar.values[a + 8 * UBar::row + b * UBar::layer] = faces[1][a + brick_side * b];
      bar.values[a + b * UBar::row + 8 * UBar::layer] = faces[2][a + brick_side * b];
    }
  }
}

PrimalJob primal_job(Level& level, size_t brick, float tau) {
  const LowFace x = low_face(level, brick, 0), y = low_face(level, brick, 1), z = low_face(level, brick, 2);
  const FreeRange range = free_range(level.box, level.grid.coord(brick));
  return {level.u.brick(brick),
          level.p.brick(brick),
          level.data(brick),
          x.base,
          x.inner,
          x.outer,
          y.base,
          y.outer,
          z.base,
          range.lo,
          range.hi,
          tau};
}

DualJob dual_job(Level& level, size_t brick, float sigma) {
  DualJob job{level.p.brick(brick), {}, sigma, level.lambda};
  for (int axis = 0; axis < 3; ++axis)
    job.fixed_up[axis] = level.grid.neighbors(brick)[static_cast<size_t>(slot_up[axis])] == outside_band;
  return job;
}

}  // namespace

Sweeper::Sweeper(Level& level, const Parallel& parallel)
    : level_(level),
      parallel_(parallel),
      chunk_(chunk_size(level.grid.size(), parallel.threads())),
      faces_(level.grid.size() * faces_per_brick),
      deferred_slot_(level.grid.size(), not_deferred) {
  for (size_t brick = 0; brick < level.grid.size(); ++brick) {
    const size_t chunk_end = (brick / chunk_ + 1) * chunk_;
    const BrickGrid::Neighbors& n = level.grid.neighbors(brick);
    const auto beyond = [&](int slot) { return n[static_cast<size_t>(slot)] >= static_cast<int64_t>(chunk_end); };
    if (std::any_of(std::begin(slot_up), std::end(slot_up), beyond)) {
      deferred_slot_[brick] = static_cast<int32_t>(deferred_.size());
      deferred_.push_back(static_cast<uint32_t>(brick));
    }
  }
  deferred_u_bar_ = AlignedArray<float>(deferred_.size() * brick_volume);
}

void Sweeper::sweep(StepSizes steps) {
  parallel_.for_chunks(level_.grid.size(), chunk_, [&](size_t begin, size_t end) { sweep_chunk(begin, end, steps); });
  parallel_.for_each(deferred_.size(), 256, [&](size_t slot) { finish_brick(slot, steps); });
}

void Sweeper::sweep_chunk(size_t begin, size_t end, StepSizes steps) {
  const SweepKernel kernel = sweep_kernel(level_.norm);
  UBar bar;
  for (size_t brick = end; brick-- > begin;) {
    kernel.primal(primal_job(level_, brick, steps.tau), bar);
    store_faces(bar, faces_.data() + brick * faces_per_brick);
    if (const int32_t slot = deferred_slot_[brick]; slot != not_deferred) {
      float* kept = deferred_u_bar_.data() + static_cast<size_t>(slot) * brick_volume;
      for (int z = 0; z < brick_side; ++z)
        for (int y = 0; y < brick_side; ++y)
          std::copy_n(bar.values + y * UBar::row + z * UBar::layer, brick_side, kept + brick_offset(0, y, z));
      continue;
    }
    load_halo(level_.grid, brick, faces_.data(), bar);
    kernel.dual(dual_job(level_, brick, steps.sigma), bar);
  }
}

void Sweeper::finish_brick(size_t slot, StepSizes steps) {
  const size_t brick = deferred_[slot];
  UBar bar;
  const float* kept = deferred_u_bar_.data() + slot * brick_volume;
  for (int z = 0; z < brick_side; ++z)
    for (int y = 0; y < brick_side; ++y)
      std::copy_n(kept + brick_offset(0, y, z), brick_side, bar.values + y * UBar::row + z * UBar::layer);
  load_halo(level_.grid, brick, faces_.data(), bar);
  sweep_kernel(level_.norm).dual(dual_job(level_, brick, steps.sigma), bar);
}

}  // namespace soapfilm
