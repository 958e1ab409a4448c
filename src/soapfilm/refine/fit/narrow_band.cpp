#include "soapfilm/refine/fit/narrow_band.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <utility>

#include "soapfilm/core/bits.h"
#include "soapfilm/core/context_state.h"
#include "soapfilm/core/indices.h"
#include "soapfilm/core/parallel.h"
#include "soapfilm/kernels/kernels.h"

namespace soapfilm {

namespace {

/// Each bit of a byte as a separate byte, the lowest first in memory.
constexpr auto bytes_of_bits = [] {
  std::array<uint64_t, 256> table{};
  for (size_t bits = 0; bits < table.size(); ++bits) {
    std::array<uint8_t, brick_side> bytes{};
    for (size_t x = 0; x < brick_side; ++x) bytes[x] = bits >> x & 1;
    table[bits] = std::bit_cast<uint64_t>(bytes);
  }
  return table;
}();

}  // namespace

BandLayers::BandLayers(const BrickGrid& grid) {
  int next = 0;  // the z after those of the layers so far
  for (const BrickGrid::Slice& slice : grid.slices()) {
    if ((slice.z - next) % 2 != 0) {
      z_.push_back(next);
      begin_.push_back(slice.begin);
    }
    z_.push_back(slice.z);
    begin_.push_back(slice.end);
    next = slice.z + 1;
  }
}

NarrowBand::NarrowBand(BrickGrid grid, const std::vector<uint8_t>& vertices, const Context& context)
    : kernel_(kernels_of(context).rows),
      pages_(pages_of(context)),
      grid_(std::move(grid)),
      layers_(grid_),
      row_of_(vertices.size(), pages_of(context)),
      first_row_(grid_.size() + 1) {
  parallel_for(context, grid_.size(), 256, [&](size_t b) {
    const auto first = vertices.begin() + static_cast<std::ptrdiff_t>(b * brick_area);
    first_row_[b + 1] = static_cast<uint32_t>(brick_area - std::count(first, first + brick_area, uint8_t{0}));
  });
  uint64_t rows = 1;
  for (size_t b = 0; b < grid_.size(); ++b) rows += first_row_[b + 1];
  require_indices(rows, most_indices, "rows of the band around the surface");
  first_row_[0] = 1;
  for (size_t b = 0; b < grid_.size(); ++b) first_row_[b + 1] += first_row_[b];
  mask_.resize(size_t{first_row_.back()} + 1);
  place_.resize(mask_.size());
  parallel_for(context, grid_.size(), 256, [&](size_t b) {
    uint32_t row = first_row_[b];
    for (size_t k = b * brick_area; k < (b + 1) * brick_area; ++k)
      if (vertices[k] != 0) {
        row_of_.data()[k] = row;
        mask_[row] = vertices[k];
        place_[row++] = static_cast<uint8_t>(k % brick_area);
      }
  });
  neighbors_ = AlignedArray<std::array<uint32_t, 6>>(mask_.size() + rows_ahead, pages_);
  degree_ = AlignedArray<uint8_t>(slots(), pages_);
  count_neighbors(context);
}

void NarrowBand::count_neighbors(const Context& context) {
  parallel_for(context, grid_.size(), 64, [&](size_t b) {
    const auto& around = grid_.neighbors(b);
    const auto own = static_cast<int32_t>(b);
    for (uint32_t r = first_row_[b]; r < first_row_[b + 1]; ++r) {
      const int y = place_[r] & 7, z = place_[r] >> 3;
      auto& n = neighbors_.data()[r];
      n = {row(around[slot_down[0]], y, z),
           row(around[slot_up[0]], y, z),
           y > 0 ? row(own, y - 1, z) : row(around[slot_down[1]], 7, z),
           y < 7 ? row(own, y + 1, z) : row(around[slot_up[1]], 0, z),
           z > 0 ? row(own, y, z - 1) : row(around[slot_down[2]], y, 7),
           z < 7 ? row(own, y, z + 1) : row(around[slot_up[2]], y, 0)};
      const int m = mask_[r];
      const int below = (m << 1 | mask_[n[0]] >> 7) & 0xff, above = m >> 1 | (mask_[n[1]] & 1) << 7;
      const auto bytes = [](int bits) { return bytes_of_bits[static_cast<size_t>(bits)]; };
      const uint64_t sum = bytes(below) + bytes(above) + bytes(mask_[n[2]]) + bytes(mask_[n[3]]) + bytes(mask_[n[4]]) +
                           bytes(mask_[n[5]]);
      const uint64_t degree = 0xff * bytes(m) & sum;
      std::memcpy(degree_.data() + r * brick_side, &degree, brick_side);
    }
  });
}

LayerRange NarrowBand::layers_at_hand() const {
  if (!slabs_) return layers_.size();
  const Layers wide = slabs_->own().widened(layers_beside, layers_beside);
  return {layers_.from(wide.begin) & ~1, layers_.from(wide.end)};
}

size_t NarrowBand::count() const {
  size_t total = 0;
  for (const uint8_t mask : mask_) total += static_cast<size_t>(count_bits(mask));
  return total;
}

void bring_borders(const NarrowBand& band, RowArray& values) {
  if (!band.slabs()) return;
  constexpr int beside = NarrowBand::layers_beside;
  bring(band.slabs()->ranks(), band.slabs()->parts([&](Layers layers) { return rows_of(band, layers); }),
        band.slabs()->parts([&](Layers layers) { return rows_of(band, layers.widened(beside, beside)); }),
        {{values.data(), brick_side * sizeof(float)}});
}

void bring_all(const NarrowBand& band, RowArray& values) {
  if (!band.slabs()) return;
  bring_all(band.slabs()->ranks(), band.slabs()->parts([&](Layers layers) { return rows_of(band, layers); }),
            {{values.data(), brick_side * sizeof(float)}});
}

std::vector<std::array<float, brick_side>> values_in(const NarrowBand& band, const RowArray& values,
                                                     const std::vector<uint32_t>& rows) {
  std::vector<std::array<float, brick_side>> found(rows.size());
  const auto rows_in = [&](Layers layers) {
    const ItemRange all = rows_of(band, layers);
    const auto index = [&](size_t row) {
      return static_cast<size_t>(std::lower_bound(rows.begin(), rows.end(), row) - rows.begin());
    };
    return ItemRange{index(all.begin), index(all.end)};
  };
  const ItemRange own = band.slabs() ? rows_in(band.slabs()->own()) : ItemRange{0, rows.size()};
  for (size_t k = own.begin; k < own.end; ++k)
    std::copy_n(values.data() + size_t{rows[k]} * brick_side, brick_side, found[k].data());
  if (band.slabs())
    bring_all(band.slabs()->ranks(), band.slabs()->parts(rows_in), {{found.data(), brick_side * sizeof(float)}});
  return found;
}

double apply_laplacian(const NarrowBand& band, const RowArray& v, float weight_v, float weight_g, RowArray& out,
                       const Context& context) {
  const RowKernel& kernel = band.kernel();
  const LaplacianJob job{v.data(), weight_v, weight_g, out.data()};
  if (band.slabs()) {
    for_rows(rows_at_hand(band), context,
             [&](size_t begin, size_t end) { kernel.laplacian(band.view(), job, begin, end); });
    return 0;
  }
  return sum_over_rows(band, context,
                       [&](size_t begin, size_t end) { return kernel.laplacian(band.view(), job, begin, end); });
}

}  // namespace soapfilm
