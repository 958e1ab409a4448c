#include "soapfilm/field/divergence.h"

#include <algorithm>
#include <array>
#include <bit>
#include <memory>
#include <vector>

#include "soapfilm/core/context_state.h"
#include "soapfilm/core/parallel.h"
#include "soapfilm/core/share.h"
#include "soapfilm/device/device.h"
#include "soapfilm/grid/bring_bricks.h"
#include "soapfilm/kernels/divergence_kernel.h"
#include "soapfilm/kernels/kernels.h"

namespace soapfilm {

namespace {

constexpr int reach = SplatWindow::reach;
constexpr size_t bricks_per_task = 32;  // of a layer, which may have few

/// The vectors that a brick's own samples add to its vertices and to those one beyond. Samples lie on surfaces: most
/// rows stay zero, and are marked as zero.
struct Splat {
  static constexpr int side = brick_side + 1;

  std::array<float, static_cast<size_t>(SplatWindow::components) * side * side * side> values;
  std::array<uint16_t, side> occupied;  ///< bit y of [z]

  /// Row (y, z): `side` values of each component.
  float* row(int y, int z) { return values.data() + (z * side + y) * SplatWindow::components * side; }
  const float* row(int y, int z) const { return values.data() + (z * side + y) * SplatWindow::components * side; }
};

void splat_brick(const GridSamples& samples, size_t brick, Splat& out) {
  out = {};
  for (uint32_t s = samples.begin[brick]; s < samples.begin[brick + 1]; ++s) {
    const Vec3f q = samples.local[s];
    const Vec3f v = samples.direction[s];
    const auto [x, y, z] = cell_in_brick(q);
    const float fx = q.x - static_cast<float>(x), fy = q.y - static_cast<float>(y), fz = q.z - static_cast<float>(z);
    for (int cz = 0; cz < 2; ++cz) {
      out.occupied[static_cast<size_t>(z + cz)] |= static_cast<uint16_t>(3u << y);
      for (int cy = 0; cy < 2; ++cy) {
        float* at = out.row(y + cy, z + cz) + x;
        for (int cx = 0; cx < 2; ++cx) {
          const float w = (cx ? fx : 1 - fx) * (cy ? fy : 1 - fy) * (cz ? fz : 1 - fz);
          at[cx] += w * v.x;
          at[Splat::side + cx] += w * v.y;
          at[2 * Splat::side + cx] += w * v.z;
        }
      }
    }
  }
}

/// The common part, along one axis, of a window and of a neighbor's splat; in vertices of the window's brick. The splat
/// covers [8 d, 8 d + 8], the window [-4, 11].
struct Overlap {
  int first, last;
};
constexpr Overlap overlap(int d) {
  return {std::max(-reach, brick_side * d), std::min(brick_side + reach - 1, brick_side * d + brick_side)};
}

/// Adds the splat of the neighbor at offset d = (dx, ., .) to the part of the window that it covers.
template <int dx>
void add_splat(const Splat& splat, Vec3i d, SplatWindow& window) {
  constexpr Overlap ox = overlap(dx);
  constexpr int count = ox.last - ox.first + 1;
  const Overlap oy = overlap(d.y), oz = overlap(d.z);
  const int own_y = oy.first - brick_side * d.y;
  const unsigned rows_reached = (1u << (oy.last - oy.first + 1)) - 1;
  for (int z = oz.first; z <= oz.last; ++z) {
    const int own_z = z - brick_side * d.z;
    const unsigned rows = splat.occupied[static_cast<size_t>(own_z)] >> own_y & rows_reached;
    uint16_t& occupied = window.occupied[static_cast<size_t>(z + reach)];
    occupied = static_cast<uint16_t>(occupied | rows << (oy.first + reach));
    for (unsigned left = rows; left != 0; left &= left - 1) {
      const int y = std::countr_zero(left);
      const float* in = splat.row(own_y + y, own_z) + (ox.first - brick_side * dx);
      float* out = window.row(oy.first + reach + y, z + reach, 0) + (ox.first + reach);
      for (int c = 0; c < SplatWindow::components; ++c, in += Splat::side, out += SplatWindow::side)
        for (int i = 0; i < count; ++i) out[i] += in[i];
    }
  }
}

void add_splat(const Splat& splat, Vec3i d, SplatWindow& window) {
  if (d.x < 0) return add_splat<-1>(splat, d, window);
  if (d.x > 0) return add_splat<1>(splat, d, window);
  return add_splat<0>(splat, d, window);
}

/// The splats of the three layers of bricks that a layer of the field needs; no more are kept.
class SplatLayers {
 public:
  SplatLayers(const GridSamples& samples, const Context& context) : samples_(samples), context_(context) {
    for (const BrickGrid::Slice& slice : samples.bricks.slices()) widest_ = std::max(widest_, slice.end - slice.begin);
    // Not set to zero here: each layer is set to zero when it is splatted.
    splats_ = std::make_unique_for_overwrite<Splat[]>(held * widest_);
  }

  /// Splats the layers from z - 1 to z + 1 that are not there yet; z must not descend.
  void go_to(int z) {
    for (next_ = std::max(next_, z - 1); next_ <= z + 1; ++next_) {
      const size_t begin = first_[slot(next_)] = samples_.bricks.bricks_below(next_);
      parallel_for(context_, samples_.bricks.bricks_below(next_ + 1) - begin, bricks_per_task,
                   [&](size_t i) { splat_brick(samples_, begin + i, splats_[slot(next_) * widest_ + i]); });
    }
  }

  const Splat& of(int32_t brick, int z) const {
    return splats_[slot(z) * widest_ + (static_cast<size_t>(brick) - first_[slot(z)])];
  }

 private:
  static constexpr size_t held = 3;
  static size_t slot(int z) { return static_cast<size_t>(z + 1) % held; }

  const GridSamples& samples_;
  const Context& context_;
  int next_ = -1;                     ///< the layer to be splatted next
  std::array<size_t, held> first_{};  ///< brick of each layer that is held
  size_t widest_ = 0;
  std::unique_ptr<Splat[]> splats_;
};

/// Which of a brick's 27 neighbors a sample reaches, as bits by neighbor_slot(), is the product of three factors, one
/// for each axis, by the sample's cell along it: no two terms of the product have a bit in common.
constexpr auto reached_along = [] {
  std::array<std::array<uint32_t, brick_side + 1>, 3> factors{};  // a position may round up to the brick's end
  for (int cell = 0; cell <= brick_side; ++cell) {
    const uint32_t below = cell < reach ? 1 : 0, above = cell + 1 + reach >= brick_side ? 1 : 0;
    for (size_t axis = 0, step = 1; axis < 3; ++axis, step *= 3)
      factors[axis][static_cast<size_t>(cell)] = below | 1u << step | above << 2 * step;
  }
  return factors;
}();

}  // namespace

BrickMask support_mask(const GridSamples& samples, const LevelBox& box, const Context& context) {
  BrickMask mask(box.bricks);
  parallel_for(context, samples.bricks.size(), 64, [&](size_t b) {
    uint32_t reached = 0;  // which of the brick's 27 neighbors, as bits by neighbor_slot()
    for (uint32_t s = samples.begin[b]; s < samples.begin[b + 1]; ++s) {
      const Vec3f q = samples.local[s];
      const auto factor = [&](size_t axis, float along) {
        return reached_along[axis][static_cast<size_t>(static_cast<int>(along))];
      };
      reached |= factor(0, q.x) * factor(1, q.y) * factor(2, q.z);
    }
    for (int slot = 0; slot < 27; ++slot)
      if (const Vec3i brick = samples.bricks.coord(b) + slot_offset(slot); reached >> slot & 1u && mask.contains(brick))
        mask.set_shared(brick);
  });
  return mask;
}

SupportField divergence_field(const GridSamples& samples, const LevelBox& box, const Context& context) {
  SupportField field;
  field.grid = BrickGrid(support_mask(samples, box, context), context);
  field.f = Field<float>(field.grid, pages_of(context));
  if (const Device* device = device_of(context); device && device->divergence(samples, field, context)) return field;

  constexpr int32_t none = -1;
  std::vector<int32_t> samples_of(field.grid.size(), none);  // for each brick of the field, its index in `samples`
  parallel_for(context, samples.bricks.size(), 1024, [&](size_t b) {
    samples_of[static_cast<size_t>(field.grid.find(samples.bricks.coord(b)))] = static_cast<int32_t>(b);
  });

  SplatLayers splats(samples, context);
  const DivergenceKernel divergence = kernels_of(context).divergence;
  const ItemRange own = own_part(even_parts(field.grid.size(), context), context);
  for (const BrickGrid::Slice& slice : field.grid.slices()) {
    const ItemRange bricks = own.common({slice.begin, slice.end});
    if (bricks.size() == 0) continue;
    splats.go_to(slice.z);
    context.progress().advance(static_cast<double>(bricks.begin - own.begin) / static_cast<double>(own.size()), {});
    parallel_chunks(context, bricks.size(), bricks_per_task, [&](size_t from, size_t to) {
      SplatWindow window;
      for (size_t b = bricks.begin + from; b < bricks.begin + to; ++b) {
        const BrickGrid::Neighbors& neighbors = field.grid.neighbors(b);
        for (int k = 0; k < 27; ++k) {
          const int32_t holder = neighbors[static_cast<size_t>(k)];
          const int32_t brick = holder < 0 ? none : samples_of[static_cast<size_t>(holder)];
          const Vec3i d = slot_offset(k);
          if (brick != none) add_splat(splats.of(brick, slice.z + d.z), d, window);
        }
        if (!window.empty()) divergence(window, field.f.brick(b));
      }
    });
  }
  bring_bricks(field.f, context);
  return field;
}

}  // namespace soapfilm
