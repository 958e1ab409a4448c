#include "soapfilm/solve/sweep.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <functional>

#include "soapfilm/core/context_state.h"
#include "soapfilm/core/parallel.h"
#include "soapfilm/kernels/kernels.h"
#include "soapfilm/solve/level_slabs.h"

namespace soapfilm {

namespace {

constexpr size_t faces_per_brick = 3 * brick_area;
constexpr RowMask all_rows = ~RowMask{0};
constexpr RowMask even_rows = 0x5555555555555555;
constexpr RowMask first_y = 0x0101010101010101;  // rows with y = 0
constexpr RowMask last_y = first_y << 7;
constexpr RowMask first_z = 0xFF;  // rows with z = 0

/// A tile's rows of bricks along y and z. Each of 8 sweeps works on 4 rows at a time, one row lower along y and z than
/// the sweep before. A row of a scan's band holds about ten bricks of 11 kB at 512 vertices, twenty at 1024: all of
/// them fit in part of the last-level cache.
constexpr int tile_y = 4;
constexpr int tile_z = 4;
/// Rows of tiles that a band has for each thread: enough of them on most diagonals to keep all threads busy.
constexpr int rows_per_thread = 2;

RowMask pairs_of(RowMask rows) { return (rows | rows >> 1) & even_rows; }
RowMask rows_of(RowMask pairs) { return pairs | pairs << 1; }

void copy_row(const float* from, float* to) { std::memcpy(to, from, brick_side * sizeof(float)); }

template <class Visit>
void for_each_row(RowMask rows, Visit&& visit) {
  for (; rows != 0; rows &= rows - 1) visit(std::countr_zero(rows));
}

/// u_bar of an upper neighbor's first layer along an axis; zero where there is none.
const float* above(const BrickGrid& grid, size_t brick, int axis, const float* faces) {
  static constexpr float zeros[brick_area] = {};
  const int32_t up = grid.neighbors(brick)[static_cast<size_t>(slot_up[axis])];
  return up < 0 ? zeros : faces + static_cast<size_t>(up) * faces_per_brick + axis * brick_area;
}

/// The brick visited after this one, in descending order; the last one returns itself.
size_t next_of(size_t brick) { return brick > 0 ? brick - 1 : 0; }

PrimalJob primal_job(Level& level, size_t brick, RowMask pairs, StepSizes steps, float* u_bar, float* faces) {
  const size_t next = next_of(brick), after_next = next_of(next);
  const FreeRange range = free_range(level.box, level.grid.coord(brick));
  return {pairs,
          level.u.brick(brick),
          level.p.brick(brick),
          level.data(brick),
          low_face(level, brick, 0),
          low_face(level, brick, 1),
          low_face(level, brick, 2),
          range.lo,
          range.hi,
          steps.tau,
          u_bar,
          faces,
          level.u.brick(next),
          level.data(next),
          low_face(level, next, 1),
          low_face(level, next, 2),
          level.p.brick(after_next)};
}

DualJob dual_job(Level& level, size_t brick, RowMask pairs, StepSizes steps, const float* u_bar, const float* faces) {
  DualJob job{pairs,
              level.p.brick(brick),
              u_bar,
              above(level.grid, brick, 0, faces),
              above(level.grid, brick, 1, faces),
              above(level.grid, brick, 2, faces),
              {},
              steps.sigma,
              dual_radius(level),
              level.p.brick(next_of(brick))};
  for (int axis = 0; axis < 3; ++axis)
    job.fixed_up[axis] = level.rests(level.grid.neighbors(brick)[static_cast<size_t>(slot_up[axis])]);
  const Vec3i coord = level.grid.coord(brick);
  if (level.box.open && at_border(level.box, coord)) {
    const FreeRange range = free_range(level.box, coord);
    job.at_open_border = true;
    job.free_lo = range.lo;
    job.free_hi = range.hi;
    for (int axis = 0; axis < 3; ++axis)
      job.last_up[axis] = std::clamp(level.box.free_hi[axis] - brick_side * coord[axis], 0, brick_side);
  }
  return job;
}

/// Prefetches the neighbors' indices of a brick that follows soon: all other addresses depend on them.
void fetch_neighbors(const BrickGrid& grid, size_t brick) {
  const auto* bytes = reinterpret_cast<const char*>(&grid.neighbors(brick));
  for (const size_t byte : {size_t{0}, size_t{64}, sizeof(BrickGrid::Neighbors) - 1}) __builtin_prefetch(bytes + byte);
}

/// The y of all rows, descending.
std::vector<int> rows_down(const BrickGrid& grid) {
  std::vector<int> ys;
  ys.reserve(grid.rows().size());
  for (const BrickGrid::Row& row : grid.rows()) ys.push_back(row.y);
  std::sort(ys.begin(), ys.end(), std::greater<>());
  ys.erase(std::unique(ys.begin(), ys.end()), ys.end());
  return ys;
}

/// The slices whose bricks this rank has.
std::span<const BrickGrid::Slice> slices_at_hand(const Level& level) {
  const std::span all(level.grid.slices());
  if (!level.slabs) return all;
  const Layers layers = level.slabs->own().widened(1, 1);
  const size_t first = level.grid.slice_from(layers.begin);
  return all.subspan(first, level.grid.slice_from(layers.end) - first);
}

}  // namespace

Sweeper::Sweeper(Level& level, const Context& context)
    : LevelSolver(level, context),
      kernel_(kernels_of(context).sweep(level.norm)),
      slices_(slices_at_hand(level)),
      y_down_(rows_down(level.grid)),
      faces_(level.grid.size() * faces_per_brick, pages_of(context)),
      u_moved_(level.grid.size()),
      p_moved_(level.grid.size()),
      u_bar_moved_(level.grid.size()) {}

void Sweeper::sweep(StepSizes steps, int times) {
  if (steps != last_steps_) {
    std::fill(u_moved_.begin(), u_moved_.end(), all_rows);
    std::fill(p_moved_.begin(), p_moved_.end(), all_rows);
    last_steps_ = steps;
  }
  const int parts = (times + tile_sweeps - 1) / tile_sweeps;
  for (int k = 0; k < parts; ++k) {
    const int sweeps = times * (k + 1) / parts - times * k / parts;
    if (level_.slabs && since_exchange_ + sweeps > sweeps_per_exchange) exchange();
    since_exchange_ += sweeps;
    sweep_tiles(steps, sweeps);
  }
}

void Sweeper::download() {
  if (level_.slabs && since_exchange_ > 0) exchange();
}

void Sweeper::exchange() {
  bring_borders(level_);
  since_exchange_ = 0;
  const ItemRange own = bricks_of(level_.grid, level_.slabs->own()), all = bricks_at_hand(level_);
  for (const ItemRange beside : {ItemRange{all.begin, own.begin}, ItemRange{own.end, all.end}})
    for (size_t b = beside.begin; b < beside.end; ++b) u_moved_[b] = p_moved_[b] = all_rows;
}

void Sweeper::sweep_tiles(StepSizes steps, int sweeps) {
  const auto tiles = [&](size_t bricks, int side) { return (static_cast<int>(bricks) + sweeps - 1 + side - 1) / side; };
  const int ny = tiles(y_down_.size(), tile_y), nz = tiles(slices_.size(), tile_z);
  const int height = context_.threads() == 1 ? 1 : rows_per_thread * context_.threads();  // of a band, in tiles
  for (int band = 0; band < nz; band += height) {
    const int rows = std::min(height, nz - band);
    fetch_slices(band * tile_z, (band + rows) * tile_z);
    for (int diagonal = 0; diagonal < ny + rows - 1; ++diagonal) {
      const int first = std::max(0, diagonal - ny + 1), end = std::min(rows, diagonal + 1);
      parallel_for(context_, static_cast<size_t>(end - first), 1, [&](size_t k) {
        const int row = first + static_cast<int>(k);
        sweep_tile({diagonal - row, band + row, sweeps}, steps);
      });
    }
  }
}

void Sweeper::fetch_slices(int first, int last) const {
  if (!level_.p.on_disk()) return;
  const int nz = static_cast<int>(slices_.size());
  const int top = nz - 1 - first, bottom = std::max(0, nz - last);
  if (top < bottom) return;
  const size_t begin = slices_[static_cast<size_t>(bottom)].begin;
  const size_t end = slices_[static_cast<size_t>(top)].end;
  level_.u.fetch(begin, end);
  level_.p.fetch(begin, end);
  faces_.fetch(begin * faces_per_brick, end * faces_per_brick);
  const auto [lowest, highest] = std::minmax_element(level_.f_brick.begin() + static_cast<std::ptrdiff_t>(begin),
                                                     level_.f_brick.begin() + static_cast<std::ptrdiff_t>(end));
  level_.f->fetch(static_cast<size_t>(std::max(0, *lowest)), static_cast<size_t>(*highest + 1));
}

void Sweeper::sweep_tile(Tile tile, StepSizes steps) {
  const BrickGrid& grid = level_.grid;
  const int ny = static_cast<int>(y_down_.size()), nz = static_cast<int>(slices_.size());
  for (int z = tile.z * tile_z; z < (tile.z + 1) * tile_z; ++z)
    for (int k = 0; k < tile.sweeps; ++k) {
      const int first = std::max(0, tile.y * tile_y - k), last = std::min(ny, (tile.y + 1) * tile_y - k) - 1;
      if (z < k || z - k >= nz || first > last) continue;
      const BrickGrid::Slice& slice = slices_[static_cast<size_t>(nz - 1 - (z - k))];
      const int top = y_down_[static_cast<size_t>(first)], bottom = y_down_[static_cast<size_t>(last)];
      for (size_t r = grid.row_from(slice, top + 1); r > slice.first_row && grid.rows()[r - 1].y >= bottom; --r)
        for (size_t brick = grid.rows()[r - 1].end; brick-- > grid.rows()[r - 1].begin;) sweep_brick(brick, steps);
    }
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

void Sweeper::sweep_brick(size_t brick, StepSizes steps) {
  constexpr size_t ahead = 4;
  fetch_neighbors(level_.grid, brick > ahead ? brick - ahead : 0);
  if (level_.is_held(static_cast<int32_t>(brick))) {
    u_bar_moved_[brick] = level_.rests(static_cast<int32_t>(brick)) ? 0 : u_moved_[brick];
    u_moved_[brick] = p_moved_[brick] = 0;
    return;
  }
  UBar bar;
  const float* u = level_.u.brick(brick);
  float* faces = faces_.data() + brick * faces_per_brick;
  const RowMask primal = pairs_of(primal_rows(brick)), stepped = rows_of(primal);
  const RowMask moved = primal == 0 ? 0 : kernel_.primal(primal_job(level_, brick, primal, steps, bar.values, faces));
  u_bar_moved_[brick] = u_moved_[brick] | moved;
  u_moved_[brick] = moved;
  // The first layers of u_bar are stored for the lower neighbors.
  for_each_row(stepped & first_y, [&](int row) { copy_row(bar.values + brick_side * row, faces + brick_area + row); });
  for_each_row(stepped & first_z,
               [&](int row) { copy_row(bar.values + brick_side * row, faces + 2 * brick_area + brick_side * row); });

  const RowMask dual = pairs_of(dual_rows(brick)), rows = rows_of(dual);
  if (dual == 0) {
    p_moved_[brick] = 0;
    return;
  }
  const RowMask read = rows | (rows << 1 & ~first_y) | rows << 8;
  for_each_row(read & ~stepped, [&](int row) { copy_row(u + brick_side * row, bar.values + brick_side * row); });
  p_moved_[brick] = kernel_.dual(dual_job(level_, brick, dual, steps, bar.values, faces_.data()));
}

}  // namespace soapfilm
