#include "soapfilm/surface/indicator.h"

#include <algorithm>
#include <array>
#include <bit>
#include <utility>
#include <vector>

#include "soapfilm/core/context_state.h"
#include "soapfilm/core/parallel.h"
#include "soapfilm/grid/ordered_sum.h"
#include "soapfilm/grid/smoothing.h"

namespace soapfilm {

namespace {

/// The smoothing radius, and one more for the cells that end in the next brick.
constexpr int surface_margin = smoothing_reach + 1;

/// The first and the last set bit of a byte that is not 0.
std::pair<int, int> ends_of(uint64_t byte) { return {std::countr_zero(byte), 63 - std::countl_zero(byte)}; }

/// The 27 neighbors (as bits by neighbor_slot()) within the surface's margin of an interface in a brick.
uint32_t bricks_near(const BrickBits& interface) {
  if (!interface.any()) return 0;
  uint64_t along_xy = 0, along_x = 0, along_y = 0, along_z = 0;
  for (size_t z = 0; z < brick_side; ++z) {
    along_xy |= interface.layer[z];
    along_z |= uint64_t{interface.layer[z] != 0} << z;
  }
  for (size_t y = 0; y < brick_side; ++y) {
    const uint64_t row = along_xy >> brick_side * y & 0xff;
    along_x |= row;
    along_y |= uint64_t{row != 0} << y;
  }
  const auto x = ends_of(along_x), y = ends_of(along_y), z = ends_of(along_z);
  const Vec3i lo{x.first, y.first, z.first}, hi{x.second, y.second, z.second};
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

/// The filter of section 4.1 has taps of whole 27ths: exact in integers.
constexpr std::array<int, 7> whole_taps = {1, 3, 6, 7, 6, 3, 1};

/// Filtered along x: four outputs from ten vertices, given as bits from 3 below the first output on.
constexpr auto filtered_x = [] {
  std::array<std::array<uint16_t, 4>, 1 << 10> table{};
  for (size_t bits = 0; bits < table.size(); ++bits)
    for (size_t x = 0; x < 4; ++x) {
      int sum = 0;
      for (size_t j = 0; j < 7; ++j) sum += (bits >> (x + j) & 1) ? whole_taps[j] : 0;
      table[bits][x] = static_cast<uint16_t>(sum);
    }
  return table;
}();

/// Smooths the indicator on a brick; around[slot] is that of the 27 bricks around it.
void smooth_brick(const std::array<const BrickBits*, 27>& around, float* out) {
  constexpr int reach = smoothing_reach, side = brick_side + 2 * reach;
  std::array<std::array<uint16_t, brick_side>, side * side> after_x;
  for (int z = -reach; z < brick_side + reach; ++z)
    for (int up = -1; up <= 1; ++up) {
      const BrickBits* const* along = &around[static_cast<size_t>(neighbor_slot(-1, up, z >> 3))];
      const auto layer = [&](int k) { return along[k]->layer[static_cast<size_t>(z & 7)]; };
      const uint64_t below = layer(0), own = layer(1), above = layer(2);
      for (int y = std::max(8 * up, -reach); y < std::min(8 * up + 8, brick_side + reach); ++y) {
        const auto row = [&](uint64_t bits) { return static_cast<size_t>(bits >> 8 * (y & 7) & 0xff); };
        const size_t bits = row(below) >> (brick_side - reach) | row(own) << reach | row(above) << (8 + reach);
        uint16_t* to = after_x[static_cast<size_t>((z + reach) * side + y + reach)].data();
        std::copy_n(filtered_x[bits & 0x3ff].data(), 4, to);
        std::copy_n(filtered_x[bits >> 4 & 0x3ff].data(), 4, to + 4);
      }
    }
  const auto filter = [](const std::array<uint16_t, brick_side>* in, int stride, uint16_t* to) {
    for (size_t x = 0; x < brick_side; ++x)
      to[x] = static_cast<uint16_t>(7 * in[3 * stride][x] + 6 * (in[2 * stride][x] + in[4 * stride][x]) +
                                    3 * (in[stride][x] + in[5 * stride][x]) + (in[0][x] + in[6 * stride][x]));
  };
  std::array<std::array<uint16_t, brick_side>, side * brick_side> after_y;
  for (int z = 0; z < side; ++z)
    for (int y = 0; y < brick_side; ++y)
      filter(&after_x[static_cast<size_t>(z * side + y)], 1, after_y[static_cast<size_t>(z * brick_side + y)].data());
  for (int row = 0; row < brick_area; ++row) {
    uint16_t sum[brick_side];
    filter(&after_y[static_cast<size_t>(row)], brick_side, sum);
    for (int x = 0; x < brick_side; ++x)
      out[row * brick_side + x] = static_cast<float>(sum[x]) * (1.0f / (27 * 27 * 27));
  }
}

/// Bricks of the labels that a grid lacks, which are constant, on the inside.
BrickMask inside_without(const BrickGrid& grid, const Labels& labels) {
  BrickMask inside(labels.box.bricks);
  for (size_t b = 0; b < labels.grid.size(); ++b)
    if (const Vec3i at = labels.grid.coord(b); grid.find(at) < 0 && labels.bits[b].test(0, 0, 0)) inside.set(at);
  return inside;
}

}  // namespace

BrickMask bricks_near_surface(const Labels& labels, const Context& context) {
  const LabelView view = labels.view();
  BrickMask mask(labels.box.bricks);
  parallel_for(context, labels.grid.size(), 64, [&](size_t b) {
    const uint32_t near = bricks_near(view.interface(b));
    for (int slot = 0; slot < 27; ++slot)
      if (const Vec3i brick = labels.grid.coord(b) + slot_offset(slot); near >> slot & 1u && mask.contains(brick))
        mask.set_shared(brick);
  });
  return mask;
}

IndicatorField smoothed_indicator(const Labels& labels, const Context& context) {
  return smoothed_indicator(labels, BrickGrid(bricks_near_surface(labels, context), context), context);
}

IndicatorField smoothed_indicator(const Labels& labels, BrickGrid bricks, const Context& context) {
  const ItemRange all{0, bricks.size()};
  return smoothed_indicator(labels, std::move(bricks), context, all);
}

IndicatorField smoothed_indicator(const Labels& labels, BrickGrid bricks, const Context& context, ItemRange wanted) {
  const LabelView view = labels.view();
  IndicatorField field;
  field.grid = std::move(bricks);
  field.inside = labels.inside.are_by_brick()
                     ? labels.inside.with(inside_without(field.grid, labels))
                     : GapSides(field.grid, bricks_with_free(labels.box), [&](Vec3i brick) {
                         return view.continued(labels.grid.find(brick), brick).test(0, 0, 0);  // constant: any vertex
                       });
  field.value = Field<float>(field.grid, pages_of(context));
  parallel_for(context, wanted.size(), 64, [&](size_t k) {
    const size_t b = wanted.begin + k;
    std::array<const BrickBits*, 27> around;
    std::array<BrickBits, 27> beyond;
    const Vec3i own = field.grid.coord(b);
    const int32_t here = labels.grid.find(own);
    for (int slot = 0; slot < 27; ++slot) {
      const Vec3i brick = own + slot_offset(slot);
      const auto at = static_cast<size_t>(slot);
      const int32_t n = slot == own_slot ? here
                        : here >= 0      ? labels.grid.neighbors(static_cast<size_t>(here))[at]
                                         : labels.grid.find(brick);
      around[at] = labels.box.open ? &(beyond[at] = view.continued(n, brick)) : &view.of(n, brick);
    }
    smooth_brick(around, field.value.brick(b));
  });
  return field;
}

IndicatorField binary_indicator(const Labels& labels, const Context& context) {
  return binary_indicator(labels, BrickGrid(bricks_near_surface(labels, context), context), context);
}

IndicatorField binary_indicator(const Labels& labels, BrickGrid bricks, const Context& context) {
  IndicatorField field = smoothed_indicator(labels, std::move(bricks), context);
  parallel_for(context, field.grid.size(), 64, [&](size_t b) {
    float* value = field.value.brick(b);
    std::fill_n(value, brick_volume, 0.0f);
    labels.of(field.grid.coord(b)).for_each([&](int i) { value[i] = 1; });
  });
  return field;
}

double mean_at_samples(const IndicatorField& field, const GridSamples& samples, const Context& context) {
  std::vector<double> sums(samples.bricks.size());
  parallel_for(context, sums.size(), 16, [&](size_t b) {
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
      const auto [x, y, z] = cell_in_brick(q);
      const double fx = q.x - static_cast<float>(x), fy = q.y - static_cast<float>(y), fz = q.z - static_cast<float>(z);
      for (int corner = 0; corner < 8; ++corner) {
        const int cx = corner & 1, cy = (corner >> 1) & 1, cz = corner >> 2;
        sum += (cx ? fx : 1 - fx) * (cy ? fy : 1 - fy) * (cz ? fz : 1 - fz) * at(x + cx, y + cy, z + cz);
      }
    }
    sums[b] = sum;
  });
  return ordered_sum(samples.bricks, sums) / static_cast<double>(samples.size());
}

}  // namespace soapfilm
