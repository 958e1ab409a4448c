#include "soapfilm/refine/topology/topology.h"

#include <algorithm>
#include <bit>
#include <cstdlib>

#include "soapfilm/core/bits.h"
#include "soapfilm/refine/topology/simple_point.h"

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
        return inside_->test(*grid_, n, coord) ? 0xffu : 0u;
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

bool SignBits::test(Vec3i vertex) const {
  const Vec3i coord{vertex.x >> 3, vertex.y >> 3, vertex.z >> 3};
  const int32_t brick = grid_->find(coord);
  return brick < 0 ? inside_->test(*grid_, brick, coord)
                   : test(static_cast<size_t>(brick), vertex.x & 7, vertex.y & 7, vertex.z & 7);
}

void SignBits::set(size_t brick, const BrickBits& bits) {
  for (int z = 0; z < brick_side; ++z)
    for (int y = 0; y < brick_side; ++y) row(brick, y, z) = bits.row(y, z);
}

BrickBits SignBits::bits(size_t brick) const {
  BrickBits bits;
  for (int z = 0; z < brick_side; ++z)
    for (int y = 0; y < brick_side; ++y)
      bits.layer[static_cast<size_t>(z)] |= uint64_t{row(brick, y, z)} << brick_side * y;
  return bits;
}

size_t SignBits::count() const {
  size_t found = 0;
  for (const uint8_t row : rows_) found += static_cast<size_t>(count_bits(row));
  return found + inside_->count(*grid_);
}

namespace {

struct Change {
  uint32_t brick;
  uint32_t row;
  uint8_t x;
};

/// Whether the component (6-connected) or cavity (26-connected) of a vertex has at most so many vertices.
bool is_small_component(const SignBits& signs, Vec3i vertex, size_t most) {
  const bool object = signs.test(vertex);
  std::vector<Vec3i> part{vertex};
  for (size_t k = 0; k < part.size() && part.size() <= most; ++k)
    for (int dz = -1; dz <= 1; ++dz)
      for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx) {
          if (object && std::abs(dx) + std::abs(dy) + std::abs(dz) != 1) continue;
          const Vec3i next = part[k] + Vec3i{dx, dy, dz};
          if (signs.test(next) == object && std::find(part.begin(), part.end(), next) == part.end())
            part.push_back(next);
        }
  return part.size() <= most;
}

}  // namespace

FlipCount follow(RowArray& phi, const NarrowBand& band, SignBits& signs, float held, size_t speck) {
  const SignBits before = signs;
  std::vector<Change> changes;
  for (size_t b = 0; b < band.grid().size(); ++b)
    for (uint32_t r = band.first_row(b); r < band.first_row(b + 1); ++r) {
      const float* values = phi.data() + static_cast<size_t>(r) * brick_side;
      unsigned positive = 0;
      for (unsigned x = 0; x < brick_side; ++x) positive |= static_cast<unsigned>(values[x] > 0) << x;
      unsigned wanted = (positive ^ signs.row(b, band.place(r) & 7, band.place(r) >> 3)) & band.mask(r);
      for (; wanted != 0; wanted &= wanted - 1)
        changes.push_back({static_cast<uint32_t>(b), r, static_cast<uint8_t>(std::countr_zero(wanted))});
    }
  FlipCount count;
  count.wanted = changes.size();
  // Changes the labels that may change; returns how many did.
  const auto flip_where = [&](auto&& may) {
    const size_t all = changes.size();
    size_t left = 0;
    for (const Change& w : changes) {
      const int y = band.place(w.row) & 7, z = band.place(w.row) >> 3;
      if (may(w, signs.neighborhood(w.brick, w.x, y, z)))
        signs.flip(w.brick, w.x, y, z);
      else
        changes[left++] = w;
    }
    changes.resize(left);
    return all - left;
  };
  const auto flip_simple = [&] {
    return flip_where([](const Change&, Neighborhood around) { return is_simple(around); });
  };
  const auto flip_alone = [&] {
    size_t left = signs.count();
    return flip_where([&](const Change& w, Neighborhood around) {
      if (!is_alone(around)) return false;
      const Vec3i vertex =
          brick_side * band.grid().coord(w.brick) + Vec3i{w.x, band.place(w.row) & 7, band.place(w.row) >> 3};
      if (!is_small_component(before, vertex, speck)) return false;
      return !(signs.test(vertex) && --left == 0);
    });
  };
  // A vertex may become simple once its neighbors have changed: repeat until nothing changes. A vertex that is a
  // component by itself then cannot move elsewhere, and once it is removed others that it separated may change.
  for (size_t gone = 1; gone > 0; count.vanished += gone) {
    while (flip_simple() > 0) continue;
    gone = speck > 0 ? flip_alone() : 0;
  }
  count.refused = changes.size();
  for (const Change& w : changes) {
    const bool inside = signs.test(w.brick, w.x, band.place(w.row) & 7, band.place(w.row) >> 3);
    phi.data()[static_cast<size_t>(w.row) * brick_side + w.x] = inside ? held : -held;
  }
  return count;
}

}  // namespace soapfilm
