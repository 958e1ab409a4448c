#include "soapfilm/field/divergence.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "soapfilm/grid/smoothing.h"
#include "soapfilm/grid/window.h"

namespace soapfilm {

namespace {

// The smoothing kernel k (box filter, n = 3) and its central difference k'(j) = (k(j + 1) - k(j - 1)) / 2 as the taps
// of one pass: divergence after smoothing is one 9-tap pass along the component's own axis and k along the other two.
constexpr int reach = 4;
constexpr int taps = 2 * reach + 1;
using Taps = std::array<float, taps>;
constexpr Taps difference_of_smoothing() {
  // Output x takes sum_j in(x + j) * (k(j - 1) - k(j + 1)) / 2: k is even.
  constexpr int k[] = {0, 0, 1, 3, 6, 7, 6, 3, 1, 0, 0};
  Taps d{};
  for (int j = 0; j < taps; ++j) d[static_cast<size_t>(j)] = static_cast<float>(k[j] - k[j + 2]) / 54.0f;
  return d;
}
constexpr Taps difference = difference_of_smoothing();

/// The vectors that a brick's own samples give to its vertices and to those one beyond: 3 components of 9^3 values.
constexpr int splat_side = brick_side + 1;
constexpr size_t splat_component = static_cast<size_t>(splat_side) * splat_side * splat_side;
constexpr size_t splat_volume = 3 * splat_component;

void splat_brick(const GridSamples& samples, size_t brick, float* out) {
  for (uint32_t s = samples.begin[brick]; s < samples.begin[brick + 1]; ++s) {
    const Vec3f q = samples.local[s];
    const Vec3f v = samples.direction[s];
    const int x = std::min(static_cast<int>(q.x), brick_side - 1);
    const int y = std::min(static_cast<int>(q.y), brick_side - 1);
    const int z = std::min(static_cast<int>(q.z), brick_side - 1);
    const float fx = q.x - static_cast<float>(x), fy = q.y - static_cast<float>(y), fz = q.z - static_cast<float>(z);
    for (int corner = 0; corner < 8; ++corner) {
      const int cx = corner & 1, cy = (corner >> 1) & 1, cz = corner >> 2;
      const float w = (cx ? fx : 1 - fx) * (cy ? fy : 1 - fy) * (cz ? fz : 1 - fz);
      float* at = out + (x + cx) + splat_side * ((y + cy) + splat_side * (z + cz));
      at[0] += w * v.x;
      at[splat_component] += w * v.y;
      at[2 * splat_component] += w * v.z;
    }
  }
}

using VectorWindow = std::array<Window<float, reach>, 3>;
constexpr int side = Window<float, reach>::side;

/// Adds what the neighbour at offset (dx, dy, dz) splatted into the part of the window it reaches.
void add_splat(const float* splat, Vec3i d, VectorWindow& window) {
  // The splat covers [8 d, 8 d + 8] along an axis, the window [-4, 11].
  Vec3i lo, hi;
  for (int axis = 0; axis < 3; ++axis) {
    lo[axis] = std::max(-reach, brick_side * d[axis]);
    hi[axis] = std::min(brick_side + reach - 1, brick_side * d[axis] + brick_side);
  }
  const Vec3i base = d * brick_side;
  for (int c = 0; c < 3; ++c)
    for (int z = lo.z; z <= hi.z; ++z)
      for (int y = lo.y; y <= hi.y; ++y) {
        const float* in = splat + static_cast<size_t>(c) * splat_component + (lo.x - base.x) +
                          splat_side * ((y - base.y) + splat_side * (z - base.z));
        float* out = &window[static_cast<size_t>(c)].at(lo.x, y, z);
        for (int i = 0; i <= hi.x - lo.x; ++i) out[i] += in[i];
      }
}

/// div (k * v) on the brick, from the window of splatted vectors; separable: x, then y, then z.
void divergence_of_window(const VectorWindow& v, float* f) {
  static_assert(side == 16);
  std::array<float, 3 * side * side * brick_side> after_x;
  for (int c = 0; c < 3; ++c)
    for (int row = 0; row < side * side; ++row) {
      const float* in = &v[static_cast<size_t>(c)].values[static_cast<size_t>(row * side + reach)];
      float* out = &after_x[static_cast<size_t>((c * side * side + row) * brick_side)];
      c == 0 ? filter_row(in, 1, difference, out) : filter_row(in, 1, smoothing_taps, out);
    }

  // After y the components x and y want the same last pass: added here. Layers z of 64 values.
  std::array<float, side * brick_area> xy, only_z;
  std::array<float, brick_side> other;
  const auto at = [&](int c, int y, int z) {
    return &after_x[static_cast<size_t>(((c * side + z) * side + y) * brick_side)];
  };
  for (int z = 0; z < side; ++z)
    for (int y = 0; y < brick_side; ++y) {
      float* sum = &xy[static_cast<size_t>(z * brick_area + y * brick_side)];
      filter_row(at(0, y + reach, z), brick_side, smoothing_taps, sum);
      filter_row(at(1, y + reach, z), brick_side, difference, other.data());
      for (int x = 0; x < brick_side; ++x) sum[x] += other[static_cast<size_t>(x)];
      filter_row(at(2, y + reach, z), brick_side, smoothing_taps,
                 &only_z[static_cast<size_t>(z * brick_area + y * brick_side)]);
    }

  for (int row = 0; row < brick_area; ++row) {
    const size_t in = static_cast<size_t>(reach * brick_area + row * brick_side);
    filter_row(&xy[in], brick_area, smoothing_taps, f + row * brick_side);
    filter_row(&only_z[in], brick_area, difference, other.data());
    for (int x = 0; x < brick_side; ++x) f[row * brick_side + x] += other[static_cast<size_t>(x)];
  }
}

}  // namespace

BrickMask support_mask(const GridSamples& samples, const LevelBox& box, const Parallel& parallel) {
  // Which of a brick's 27 neighbours its samples reach, as bits by neighbor_slot().
  std::vector<uint32_t> reached(samples.bricks.size(), 0);
  parallel.for_each(samples.bricks.size(), 64, [&](size_t b) {
    for (uint32_t s = samples.begin[b]; s < samples.begin[b + 1]; ++s) {
      int lo[3], hi[3];
      for (int axis = 0; axis < 3; ++axis) {
        const int cell = static_cast<int>(samples.local[s][axis]);
        lo[axis] = cell - reach < 0 ? -1 : 0;
        hi[axis] = cell + 1 + reach >= brick_side ? 1 : 0;
      }
      for (int dz = lo[2]; dz <= hi[2]; ++dz)
        for (int dy = lo[1]; dy <= hi[1]; ++dy)
          for (int dx = lo[0]; dx <= hi[0]; ++dx) reached[b] |= 1u << neighbor_slot(dx, dy, dz);
    }
  });
  BrickMask mask(box.bricks);
  for (size_t b = 0; b < reached.size(); ++b)
    for (int slot = 0; slot < 27; ++slot)
      if (reached[b] >> slot & 1u) {
        const Vec3i brick = samples.bricks.coord(b) + slot_offset(slot);
        if (mask.contains(brick)) mask.set(brick);
      }
  return mask;
}

SupportField divergence_field(const GridSamples& samples, const LevelBox& box, const Parallel& parallel) {
  std::vector<float> splats(samples.bricks.size() * splat_volume, 0.0f);
  parallel.for_each(samples.bricks.size(), 64,
                    [&](size_t b) { splat_brick(samples, b, splats.data() + b * splat_volume); });

  SupportField field;
  field.grid = BrickGrid(support_mask(samples, box, parallel), parallel);
  field.f = Field<float>(field.grid);
  parallel.for_chunks(field.grid.size(), 64, [&](size_t begin, size_t end) {
    VectorWindow window;
    for (size_t b = begin; b < end; ++b) {
      for (auto& component : window) component.values.fill(0.0f);
      const Vec3i coord = field.grid.coord(b);
      for (int dz = -1; dz <= 1; ++dz)
        for (int dy = -1; dy <= 1; ++dy)
          for (int dx = -1; dx <= 1; ++dx) {
            const int32_t from = samples.bricks.find(coord + Vec3i{dx, dy, dz});
            if (from >= 0) add_splat(splats.data() + static_cast<size_t>(from) * splat_volume, {dx, dy, dz}, window);
          }
      divergence_of_window(window, field.f.brick(b));
    }
  });
  return field;
}

}  // namespace soapfilm
