#include "soapfilm/refine/topology.h"

#include <bit>
#include <cmath>

#include "soapfilm/refine/simple_point.h"

namespace soapfilm {

uint32_t SignBits::neighborhood(size_t brick, int x, int y, int z) const {
  const auto& around = grid_->neighbors(brick);
  uint32_t bits = 0;
  for (int dz = -1; dz <= 1; ++dz)
    for (int dy = -1; dy <= 1; ++dy) {
      const int ny = y + dy, nz = z + dz;
      const auto row_at = [&](int step) -> unsigned {
        const int slot = neighbor_slot(step, ny >> 3, nz >> 3);
        const int32_t n = slot == own_slot ? static_cast<int32_t>(brick) : around[static_cast<size_t>(slot)];
        if (n >= 0) return row(static_cast<size_t>(n), ny & 7, nz & 7);
        const Vec3i coord = grid_->coord(brick) + slot_offset(slot);
        return n == outside_band && inside_->test(coord) ? 0xffu : 0u;
      };
      unsigned three = 0;
      if (x == 0)
        three = row_at(-1) >> 7 | (row_at(0) & 3) << 1;
      else if (x == 7)
        three = row_at(0) >> 6 | (row_at(1) & 1) << 2;
      else
        three = row_at(0) >> (x - 1) & 7;
      bits |= three << (3 * (dy + 1) + 9 * (dz + 1));
    }
  return bits;
}

bool SignBits::holds_more_than(size_t count) const {
  size_t found = brick_volume * inside_->count();
  for (size_t k = 0; k < rows_.size() && found <= count; ++k) found += static_cast<size_t>(std::popcount(rows_[k]));
  return found > count;
}

namespace {

struct Wish {
  uint32_t brick;
  uint32_t row;
  uint8_t x;
};

}  // namespace

FlipCount follow(RowArray& phi, const NarrowBand& band, SignBits& signs, float held) {
  std::vector<Wish> wishes;
  for (size_t b = 0; b < band.grid().size(); ++b)
    for (uint32_t r = band.first_row(b); r < band.first_row(b + 1); ++r) {
      const float* values = phi.data() + static_cast<size_t>(r) * brick_side;
      unsigned positive = 0;
      for (unsigned x = 0; x < brick_side; ++x) positive |= static_cast<unsigned>(values[x] > 0) << x;
      unsigned wanted = (positive ^ signs.row(b, band.place(r) & 7, band.place(r) >> 3)) & band.mask(r);
      for (; wanted != 0; wanted &= wanted - 1)
        wishes.push_back({static_cast<uint32_t>(b), r, static_cast<uint8_t>(__builtin_ctz(wanted))});
    }
  FlipCount count{wishes.size(), 0};
  // A vertex may become simple once its neighbours have turned: go on until nothing moves.
  for (bool moved = true; moved && !wishes.empty();) {
    moved = false;
    size_t left = 0;
    for (const Wish& w : wishes) {
      const int y = band.place(w.row) & 7, z = band.place(w.row) >> 3;
      if (is_simple(signs.neighborhood(w.brick, w.x, y, z))) {
        signs.flip(w.brick, w.x, y, z);
        moved = true;
      } else {
        wishes[left++] = w;
      }
    }
    wishes.resize(left);
  }
  count.refused = wishes.size();
  for (const Wish& w : wishes) {
    const bool inside = signs.test(w.brick, w.x, band.place(w.row) & 7, band.place(w.row) >> 3);
    phi.data()[static_cast<size_t>(w.row) * brick_side + w.x] = inside ? held : -held;
  }
  return count;
}

size_t drop_vanished(RowArray& phi, const NarrowBand& band, SignBits& signs, float held) {
  std::vector<Wish> alone;
  size_t objects = 0;
  for (size_t b = 0; b < band.grid().size(); ++b)
    for (uint32_t r = band.first_row(b); r < band.first_row(b + 1); ++r)
      for (int x = 0; x < brick_side; ++x) {
        if (std::abs(phi.data()[size_t{r} * brick_side + static_cast<size_t>(x)]) != held) continue;
        const int y = band.place(r) & 7, z = band.place(r) >> 3;
        if (!is_alone(signs.neighborhood(b, x, y, z))) continue;
        alone.push_back({static_cast<uint32_t>(b), r, static_cast<uint8_t>(x)});
        objects += signs.test(b, x, y, z);
      }
  if (objects > 0 && !signs.holds_more_than(objects)) return 0;
  for (const Wish& w : alone) {
    signs.flip(w.brick, w.x, band.place(w.row) & 7, band.place(w.row) >> 3);
    float& value = phi.data()[size_t{w.row} * brick_side + w.x];
    value = -value;
  }
  return alone.size();
}

}  // namespace soapfilm
