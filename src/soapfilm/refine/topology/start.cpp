#include "soapfilm/refine/topology/start.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "soapfilm/core/context_state.h"
#include "soapfilm/core/parallel.h"
#include "soapfilm/core/share.h"
#include "soapfilm/grid/brick_bits.h"

namespace soapfilm {

namespace {

constexpr size_t bricks_of_a_task = 64;

/// Quantile function of the standard normal distribution in [0.016, 0.984] (rational approximation of Acklam 2003).
float normal_quantile(float p) {
  const float q = p - 0.5f, r = q * q;
  const float num =
      ((((-39.6968303f * r + 220.946098f) * r - 275.928510f) * r + 138.357752f) * r - 30.6647981f) * r + 2.50662828f;
  const float den =
      ((((-54.4760988f * r + 161.585837f) * r - 155.698980f) * r + 66.8013119f) * r - 13.2806816f) * r + 1;
  return q * num / den;
}

/// The filter of section 4.1 has variance 2 along every direction, so that a plane's smoothed indicator is nearly the
/// normal distribution's.
float distance_of(float smoothed) { return 1.41421356f * normal_quantile(smoothed); }

NarrowBand make_band(const IndicatorField& field, const LevelBox& box, double reach, const BrickMask* where,
                     const Context& context) {
  const auto limit = static_cast<float>(0.5 * std::erfc(reach / 2));
  const float last = std::nextafter(1 - limit, 0.0f);  // below 1 - limit
  std::vector<uint8_t> vertices(field.grid.size() * brick_area);
  const auto first_of = [](size_t b) { return b * brick_area; };
  share_items(field.grid.size(), vertices, bricks_of_a_task, context, first_of, [&](size_t b) {
    if (where && !where->test(field.grid.coord(b))) return;
    const float* v = field.value.brick(b);
    const BrickBits near = BrickBits::above(v, limit) & ~BrickBits::above(v, last);
    const FreeRange range = free_range(box, field.grid.coord(b));
    const unsigned free_x = range.lo.x < range.hi.x ? (1u << range.hi.x) - (1u << range.lo.x) : 0;
    for (int z = range.lo.z; z < range.hi.z; ++z)
      for (int y = range.lo.y; y < range.hi.y; ++y)
        vertices[b * brick_area + static_cast<size_t>(y + 8 * z)] = static_cast<uint8_t>(near.row(y, z) & free_x);
  });
  return NarrowBand(field.grid, vertices, context);
}

RowArray distance_on(const NarrowBand& band, const IndicatorField& field, const Context& context) {
  RowArray distance = band.make_array();
  const size_t bricks = band.grid().size();
  const ItemRange own = own_part(even_parts(bricks, context), context);
  parallel_for(context, own.size(), bricks_of_a_task, [&](size_t k) {
    const size_t b = own.begin + k;
    for (uint32_t r = band.first_row(b); r < band.first_row(b + 1); ++r) {
      const float* smoothed = field.value.brick(b) + band.place(r) * brick_side;
      float* out = distance.data() + static_cast<size_t>(r) * brick_side;
      for (int x = 0; x < brick_side; ++x)
        if (band.mask(r) >> x & 1) out[x] = distance_of(smoothed[x]);
    }
  });
  bring_items(bricks, {distance.data(), brick_side * sizeof(float)}, context,
              [&](size_t b) { return size_t{band.first_row(b)}; });
  return distance;
}

/// Vertices of the half-resolution grid: the last at or before a fine vertex, and the first at or after it.
Vec3i half_of(Vec3i v) { return {v.x >> 1, v.y >> 1, v.z >> 1}; }
Vec3i half_up(Vec3i v) { return half_of(v + Vec3i{1, 1, 1}); }

/// The bricks of the half-resolution grid that hold vertices of `fine` ones.
BrickGrid every_second_vertex(const BrickGrid& fine, const Context& context) {
  return BrickGrid(parents_of(fine, half_up(fine.bricks()), context), context);
}

}  // namespace

Start start_from(const Labels& labels, double reach, const Context& context, const BrickMask* where) {
  // The smoothed indicator gives the approximate distance of each vertex from the surface; ranks share the bricks.
  BrickGrid bricks = where ? labels.grid : BrickGrid(bricks_near_surface(labels, context), context);
  const ItemRange own = own_part(even_parts(bricks.size(), context), context);
  IndicatorField field = smoothed_indicator(labels, std::move(bricks), context, own);
  NarrowBand band = make_band(field, labels.box, reach, where, context);
  RowArray phi0 = distance_on(band, field, context);
  return {labels.box, std::move(field.grid), std::move(field.inside), std::move(band), std::move(phi0)};
}

SignBits signs_of(const Labels& labels, const Start& start, const Context& context) {
  SignBits signs(start.grid, start.inside);
  parallel_for(context, start.grid.size(), bricks_of_a_task,
               [&](size_t b) { signs.set(b, labels.of(start.grid.coord(b))); });
  return signs;
}

Labels every_second_vertex(const Labels& fine, const Context& context, const BrickMask* where) {
  Labels coarse;
  coarse.box = {fine.box.level + 1, half_up(fine.box.free_lo), half_of(fine.box.free_hi), half_up(fine.box.bricks),
                fine.box.open};
  coarse.grid = where ? BrickGrid(*where, context) : every_second_vertex(fine.grid, context);
  coarse.inside = GapSides(coarse.grid, bricks_with_free(coarse.box),
                           [&](Vec3i b) { return fine.test(nearest_free(fine.box, child_of(b, 0) * brick_side)); });
  coarse.bits.resize(coarse.grid.size());
  parallel_for(context, coarse.grid.size(), bricks_of_a_task, [&](size_t b) {
    for (int k = 0; k < 8; ++k) {
      const BrickBits& child = fine.of(child_of(coarse.grid.coord(b), k));
      const Vec3i base = octant_base(octant_of(k));
      for (int z = 0; z < half_brick; ++z)
        for (int y = 0; y < half_brick; ++y)
          for (int x = 0; x < half_brick; ++x)
            if (child.test(2 * x, 2 * y, 2 * z)) coarse.bits[b].set(brick_offset(base.x + x, base.y + y, base.z + z));
    }
  });
  return coarse;
}

GridSamples on_every_second_vertex(const GridSamples& samples, const Context& context, const BrickMask* where) {
  BrickGrid bricks = where ? BrickGrid(*where, context) : every_second_vertex(samples.bricks, context);
  std::vector<uint32_t> first{0}, taken;
  std::vector<Vec3f> base;  // of the fine brick of each taken one, in its coarse one
  for (size_t b = 0; b < bricks.size(); ++b) {
    for (int k = 0; k < 8; ++k) {
      const int32_t n = samples.bricks.find(child_of(bricks.coord(b), k));
      if (n < 0) continue;
      for (uint32_t s = samples.begin[static_cast<size_t>(n)]; s < samples.begin[static_cast<size_t>(n) + 1]; ++s)
        taken.push_back(s);
      base.resize(taken.size(), Vec3f(octant_base(octant_of(k))));
    }
    first.push_back(static_cast<uint32_t>(taken.size()));
  }
  GridSamples coarse = samples.select(std::move(bricks), std::move(first), taken, context);
  // Rounding must not move a sample into the next brick.
  const float last = std::nextafter(static_cast<float>(brick_side), 0.0f);
  parallel_chunks(context, taken.size(), size_t{1} << 14, [&](size_t begin, size_t end) {
    for (size_t k = begin; k < end; ++k) {
      const Vec3f local = samples.local[taken[k]] * 0.5f + base[k];
      coarse.local[k] = {std::min(local.x, last), std::min(local.y, last), std::min(local.z, last)};
    }
  });
  return coarse;
}

}  // namespace soapfilm
