#include "soapfilm/solve/sweep.h"

#include <algorithm>
#include <bit>
#include <cstring>

namespace soapfilm {

namespace {

constexpr size_t faces_per_brick = 3 * brick_area;
constexpr int32_t not_deferred = -1;
constexpr RowMask all_rows = ~RowMask{0};
constexpr RowMask first_y = 0x0101010101010101;  // rows with y = 0
constexpr RowMask last_y = first_y << 7;
constexpr RowMask first_z = 0xFF;  // rows with z = 0

/// One chunk on one thread has nothing to defer; several per thread keep the threads busy to the end; below some
/// hundred bricks (a fraction of a millisecond) waking a thread costs more than it brings.
size_t chunk_size(size_t bricks, int threads) {
  constexpr size_t chunks_per_thread = 6;
  constexpr size_t least_chunk = 256;
  if (threads == 1) return std::max<size_t>(bricks, 1);
  return std::max<size_t>(bricks / (chunks_per_thread * static_cast<size_t>(threads)), least_chunk);
}

void copy_row(const float* from, float* to) { std::memcpy(to, from, brick_side * sizeof(float)); }

template <class Visit>
void for_each_row(RowMask rows, Visit&& visit) {
  for (; rows != 0; rows &= rows - 1) visit(std::countr_zero(rows));
}

float* bar_row(UBar& bar, int y, int z) { return bar.values + y * UBar::row + z * UBar::layer; }
float* bar_row(UBar& bar, int row) { return bar_row(bar, row % brick_side, row / brick_side); }

/// Leaves the first layers of u_bar in `rows` behind for the lower neighbours.
void store_faces(UBar& bar, RowMask rows, float* faces) {
  for_each_row(rows, [&](int row) { faces[row] = *bar_row(bar, row); });
  for_each_row(rows & first_y, [&](int row) { copy_row(bar_row(bar, row), faces + brick_area + row); });
  for_each_row(rows & first_z,
               [&](int row) { copy_row(bar_row(bar, row), faces + 2 * brick_area + brick_side * row); });
}

/// Puts the upper neighbours' first layers around u_bar where `rows` touch them; zero where there is none.
void load_halo(const BrickGrid& grid, size_t brick, RowMask rows, const float* all_faces, UBar& bar) {
  static constexpr float zeros[brick_area] = {};
  const auto faces = [&](int axis) {
    const int32_t up = grid.neighbors(brick)[static_cast<size_t>(slot_up[axis])];
    return up < 0 ? zeros : all_faces + static_cast<size_t>(up) * faces_per_brick + axis * brick_area;
  };
  const float *x = faces(0), *y = faces(1), *z = faces(2);
  for_each_row(rows, [&](int row) { bar_row(bar, row)[brick_side] = x[row]; });
  for_each_row(rows & last_y, [&](int row) {
    const int at = row / brick_side;
    copy_row(y + brick_side * at, bar_row(bar, brick_side, at));
  });
  for_each_row(rows >> 56, [&](int row) { copy_row(z + brick_side * row, bar_row(bar, row, brick_side)); });
}

/// u_bar = u in the rows that have not been stepped.
void load_rested(const float* u, RowMask rows, UBar& bar) {
  for_each_row(rows, [&](int row) { copy_row(u + brick_side * row, bar_row(bar, row)); });
}

PrimalJob primal_job(Level& level, size_t brick, RowMask rows, StepSizes steps) {
  const size_t next = brick > 0 ? brick - 1 : 0, after_next = next > 0 ? next - 1 : 0;  // visited in descending order
  const FreeRange range = free_range(level.box, level.grid.coord(brick));
  return {rows,
          level.u.brick(brick),
          level.p.brick(brick),
          level.data(brick),
          low_face(level, brick, 0),
          low_face(level, brick, 1),
          low_face(level, brick, 2),
          range.lo,
          range.hi,
          steps.tau,
          level.u.brick(next),
          level.p.brick(next),
          level.data(next),
          low_face(level, next, 1),
          low_face(level, next, 2),
          level.p.brick(after_next)};
}

/// Rounding moves a projected p by at most 3.5e-7 of lambda: projected onto a ball this much smaller it stays feasible
/// to the last bit, and the certificate needs no rescaling.
constexpr float within_ball = 1 - 0x1p-21f;

DualJob dual_job(Level& level, size_t brick, RowMask rows, StepSizes steps) {
  DualJob job{rows, level.p.brick(brick), {}, steps.sigma, level.lambda * within_ball};
  for (int axis = 0; axis < 3; ++axis)
    job.fixed_up[axis] = level.grid.neighbors(brick)[static_cast<size_t>(slot_up[axis])] == outside_band;
  return job;
}

}  // namespace

Sweeper::Sweeper(Level& level, const Parallel& parallel)
    : level_(level),
      parallel_(parallel),
      kernel_(sweep_kernel(level.norm)),
      chunk_(chunk_size(level.grid.size(), parallel.threads())),
      faces_(level.grid.size() * faces_per_brick),
      u_moved_(level.grid.size(), all_rows),
      p_moved_(level.grid.size(), all_rows),
      u_bar_moved_(level.grid.size()),
      deferred_slot_(level.grid.size(), not_deferred) {
  for (size_t brick = 0; brick < level.grid.size(); ++brick) {
    const size_t chunk_end = (brick / chunk_ + 1) * chunk_;
    const BrickGrid::Neighbors& n = level.grid.neighbors(brick);
    const auto beyond = [&](int slot) { return n[static_cast<size_t>(slot)] >= static_cast<int64_t>(chunk_end); };
    if (std::any_of(std::begin(slot_up), std::end(slot_up), beyond)) {
      deferred_slot_[brick] = static_cast<int32_t>(deferred_.size());
      deferred_.push_back({static_cast<uint32_t>(brick), 0});
    }
  }
  deferred_u_bar_ = AlignedArray<float>(deferred_.size() * brick_volume);
}

void Sweeper::sweep(StepSizes steps) {
  parallel_.for_chunks(level_.grid.size(), chunk_, [&](size_t begin, size_t end) { sweep_chunk(begin, end, steps); });
  parallel_.for_each(deferred_.size(), 256, [&](size_t slot) { finish_deferred(slot, steps); });
}

RowMask Sweeper::primal_rows(size_t brick) const {
  const BrickGrid::Neighbors& n = level_.grid.neighbors(brick);
  const auto below = [&](int axis) {
    const int32_t k = n[static_cast<size_t>(slot_down[axis])];
    return k < 0 ? RowMask{0} : p_moved_[static_cast<size_t>(k)];
  };
  const RowMask p = p_moved_[brick];
  return u_moved_[brick] | p | below(0) | (p << 1 & ~first_y) | (below(1) >> 7 & first_y) | p << 8 | below(2) >> 56;
}

RowMask Sweeper::dual_rows(size_t brick) const {
  const BrickGrid::Neighbors& n = level_.grid.neighbors(brick);
  const auto above = [&](int axis) {
    const int32_t k = n[static_cast<size_t>(slot_up[axis])];
    return k < 0 ? RowMask{0} : u_bar_moved_[static_cast<size_t>(k)];
  };
  const RowMask u = u_bar_moved_[brick];
  return p_moved_[brick] | u | above(0) | (u >> 1 & ~last_y) | (above(1) << 7 & last_y) | u >> 8 | above(2) << 56;
}

void Sweeper::sweep_chunk(size_t begin, size_t end, StepSizes steps) {
  UBar bar;
  for (size_t brick = end; brick-- > begin;) {
    const RowMask rows = primal_rows(brick);
    const RowMask moved = rows == 0 ? 0 : kernel_.primal(primal_job(level_, brick, rows, steps), bar);
    u_bar_moved_[brick] = u_moved_[brick] | moved;
    u_moved_[brick] = moved;
    store_faces(bar, u_bar_moved_[brick], faces_.data() + brick * faces_per_brick);
    if (const int32_t slot = deferred_slot_[brick]; slot != not_deferred) {
      deferred_[static_cast<size_t>(slot)].stepped = rows;
      float* kept = deferred_u_bar_.data() + static_cast<size_t>(slot) * brick_volume;
      for_each_row(rows, [&](int row) { copy_row(bar_row(bar, row), kept + brick_side * row); });
    } else {
      dual_step(brick, rows, steps, bar);
    }
  }
}

void Sweeper::finish_deferred(size_t slot, StepSizes steps) {
  const Deferred& deferred = deferred_[slot];
  UBar bar;
  load_rested(deferred_u_bar_.data() + slot * brick_volume, deferred.stepped, bar);
  dual_step(deferred.brick, deferred.stepped, steps, bar);
}

void Sweeper::dual_step(size_t brick, RowMask stepped, StepSizes steps, UBar& bar) {
  const RowMask rows = dual_rows(brick);
  if (rows != 0) {
    const RowMask read = rows | (rows << 1 & ~first_y) | rows << 8;
    load_rested(level_.u.brick(brick), read & ~stepped, bar);
    load_halo(level_.grid, brick, rows, faces_.data(), bar);
    p_moved_[brick] = kernel_.dual(dual_job(level_, brick, rows, steps), bar);
  } else {
    p_moved_[brick] = 0;
  }
}

}  // namespace soapfilm
