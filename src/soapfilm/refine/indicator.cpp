#include "soapfilm/refine/indicator.h"

#include <algorithm>
#include <array>
#include <vector>

#include "soapfilm/grid/smoothing.h"
#include "soapfilm/grid/window.h"

namespace soapfilm {

namespace {

/// The smoothing's reach and one more for the cells that end in the next brick.
constexpr int surface_margin = smoothing_reach + 1;

/// Fills a window with the binary indicator around a brick of the band.
template <int margin>
void indicator_window(const Level& level, size_t brick, float threshold, Window<float, margin>& window) {
  fill_window(
      level.grid, brick, [&](int, int32_t n) { return n >= 0 ? level.u.brick(static_cast<size_t>(n)) : nullptr; },
      [&](int slot, int32_t n) { return level.missing_u(n, level.grid.coord(brick) + slot_offset(slot)); }, window);
  for (float& value : window.values) value = value > threshold ? 1.0f : 0.0f;
}

/// The 27 neighbours (as bits by neighbor_slot()) within the surface's margin of an interface in the brick.
uint32_t bricks_near_interface(const Level& level, size_t brick, float threshold) {
  Window<float, 1> inside;
  indicator_window(level, brick, threshold, inside);
  const float first = inside.values[0];
  if (std::all_of(inside.values.begin(), inside.values.end(), [&](float v) { return v == first; })) return 0;

  Vec3i lo{brick_side, brick_side, brick_side}, hi{-1, -1, -1};
  for (int z = 0; z < brick_side; ++z)
    for (int y = 0; y < brick_side; ++y)
      for (int x = 0; x < brick_side; ++x) {
        const float here = inside.at(x, y, z);
        if (inside.at(x - 1, y, z) == here && inside.at(x + 1, y, z) == here && inside.at(x, y - 1, z) == here &&
            inside.at(x, y + 1, z) == here && inside.at(x, y, z - 1) == here && inside.at(x, y, z + 1) == here)
          continue;
        lo = {std::min(lo.x, x), std::min(lo.y, y), std::min(lo.z, z)};
        hi = {std::max(hi.x, x), std::max(hi.y, y), std::max(hi.z, z)};
      }
  if (hi.x < 0) return 0;
  uint32_t near = 0;
  for (int slot = 0; slot < 27; ++slot) {
    const Vec3i d = slot_offset(slot);
    bool reached = true;
    for (int axis = 0; axis < 3; ++axis)
      reached = reached &&
                (d[axis] == 0 || (d[axis] < 0 ? lo[axis] < surface_margin : hi[axis] >= brick_side - surface_margin));
    if (reached) near |= 1u << slot;
  }
  return near;
}

/// Whether the first vertex of each brick of the domain is inside: all that matters where a brick is constant.
BrickMask inside_bricks(const Level& level, float threshold) {
  BrickMask inside = level.inside;
  for (size_t b = 0; b < level.grid.size(); ++b) inside.set(level.grid.coord(b), level.u.brick(b)[0] > threshold);
  return inside;
}

void smooth_window(const Window<float, surface_margin>& in, float* out) {
  constexpr int side = Window<float, surface_margin>::side;
  std::array<float, static_cast<size_t>(side) * side * brick_side> after_x;
  for (int row = 0; row < side * side; ++row)
    filter_row(&in.values[static_cast<size_t>(row * side + surface_margin)], 1, smoothing_taps,
               &after_x[static_cast<size_t>(row * brick_side)]);
  std::array<float, static_cast<size_t>(side) * brick_area> after_y;
  for (int z = 0; z < side; ++z)
    for (int y = 0; y < brick_side; ++y)
      filter_row(&after_x[static_cast<size_t>((z * side + y + surface_margin) * brick_side)], brick_side,
                 smoothing_taps, &after_y[static_cast<size_t>(z * brick_area + y * brick_side)]);
  for (int row = 0; row < brick_area; ++row)
    filter_row(&after_y[static_cast<size_t>(surface_margin * brick_area + row * brick_side)], brick_area,
               smoothing_taps, out + row * brick_side);
}

}  // namespace

SurfaceField smoothed_indicator(const Level& level, float threshold, const Parallel& parallel) {
  std::vector<uint32_t> near(level.grid.size());
  parallel.for_each(near.size(), 64, [&](size_t b) { near[b] = bricks_near_interface(level, b, threshold); });
  BrickMask mask(level.box.bricks);
  for (size_t b = 0; b < near.size(); ++b)
    for (int slot = 0; slot < 27; ++slot)
      if (const Vec3i brick = level.grid.coord(b) + slot_offset(slot); near[b] >> slot & 1u && mask.contains(brick))
        mask.set(brick);

  SurfaceField field;
  field.inside = inside_bricks(level, threshold);
  field.grid = BrickGrid(mask, parallel);
  field.value = Field<float>(field.grid);
  parallel.for_chunks(field.grid.size(), 64, [&](size_t begin, size_t end) {
    Window<float, surface_margin> window;
    for (size_t b = begin; b < end; ++b) {
      const Vec3i coord = field.grid.coord(b);
      std::array<int32_t, 27> in_level;
      for (int slot = 0; slot < 27; ++slot)
        in_level[static_cast<size_t>(slot)] = level.grid.find(coord + slot_offset(slot));
      fill_window(
          field.grid, b,
          [&](int slot, int32_t) {
            const int32_t n = in_level[static_cast<size_t>(slot)];
            return n >= 0 ? level.u.brick(static_cast<size_t>(n)) : nullptr;
          },
          [&](int slot, int32_t) {
            return level.missing_u(in_level[static_cast<size_t>(slot)], coord + slot_offset(slot));
          },
          window);
      for (float& value : window.values) value = value > threshold ? 1.0f : 0.0f;
      smooth_window(window, field.value.brick(b));
    }
  });
  return field;
}

SurfaceField binary_indicator(const Level& level, float threshold, const Parallel& parallel) {
  SurfaceField field = smoothed_indicator(level, threshold, parallel);
  parallel.for_each(field.grid.size(), 64, [&](size_t b) {
    const Vec3i coord = field.grid.coord(b);
    const int32_t n = level.grid.find(coord);
    float* value = field.value.brick(b);
    for (int i = 0; i < brick_volume; ++i) {
      const float u = n >= 0 ? level.u.brick(static_cast<size_t>(n))[i] : level.missing_u(n, coord);
      value[i] = u > threshold ? 1.0f : 0.0f;
    }
  });
  return field;
}

double mean_at_samples(const SurfaceField& field, const GridSamples& samples, const Parallel& parallel) {
  std::vector<double> sums(samples.bricks.size());
  parallel.for_each(sums.size(), 16, [&](size_t b) {
    const Vec3i coord = samples.bricks.coord(b);
    // The sample's cell may end in the next brick along each axis.
    const float* values[8];
    float constant[8];
    for (int k = 0; k < 8; ++k) {
      const Vec3i brick = coord + Vec3i{k & 1, (k >> 1) & 1, k >> 2};
      const int32_t n = field.grid.find(brick);
      values[k] = n >= 0 ? field.value.brick(static_cast<size_t>(n)) : nullptr;
      constant[k] = values[k] ? 0.0f : field.missing_value(brick);
    }
    const auto at = [&](int x, int y, int z) -> double {
      const int k = (x >> 3) + 2 * (y >> 3) + 4 * (z >> 3);
      return values[k] ? values[k][brick_offset(x & 7, y & 7, z & 7)] : constant[k];
    };
    double sum = 0;
    for (uint32_t s = samples.begin[b]; s < samples.begin[b + 1]; ++s) {
      const Vec3f q = samples.local[s];
      const int x = std::min(static_cast<int>(q.x), 7), y = std::min(static_cast<int>(q.y), 7),
                z = std::min(static_cast<int>(q.z), 7);
      const double fx = q.x - static_cast<float>(x), fy = q.y - static_cast<float>(y), fz = q.z - static_cast<float>(z);
      for (int corner = 0; corner < 8; ++corner) {
        const int cx = corner & 1, cy = (corner >> 1) & 1, cz = corner >> 2;
        sum += (cx ? fx : 1 - fx) * (cy ? fy : 1 - fy) * (cz ? fz : 1 - fz) * at(x + cx, y + cy, z + cz);
      }
    }
    sums[b] = sum;
  });
  double total = 0;
  for (const double sum : sums) total += sum;
  return total / static_cast<double>(samples.size());
}

size_t count_inside(const Level& level, float threshold, const Parallel& parallel) {
  std::vector<size_t> counts(level.grid.size());
  parallel.for_each(counts.size(), 256, [&](size_t b) {
    const float* u = level.u.brick(b);
    counts[b] = static_cast<size_t>(std::count_if(u, u + brick_volume, [&](float v) { return v > threshold; }));
  });
  size_t total = 0;
  for (const size_t count : counts) total += count;
  level.inside.for_each([&](Vec3i b) {
    if (level.grid.find(b) >= 0) return;
    const FreeRange range = free_range(level.box, b);
    total += static_cast<size_t>(std::max(0, range.hi.x - range.lo.x)) *
             static_cast<size_t>(std::max(0, range.hi.y - range.lo.y)) *
             static_cast<size_t>(std::max(0, range.hi.z - range.lo.z));
  });
  return total;
}

}  // namespace soapfilm
