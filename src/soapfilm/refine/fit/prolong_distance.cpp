#include "soapfilm/refine/fit/prolong_distance.h"

#include <algorithm>
#include <array>

#include "soapfilm/core/parallel.h"

namespace soapfilm {

namespace {

/// The coarse vertices that a fine brick needs: four that lie in it, one below and two above along each axis. Those of
/// a row are contiguous along x.
constexpr int window_side = 7, below = 1;

using Taps = std::array<float, 4>;  // halfway between the second and the third
constexpr Taps cubic = {-0.0625f, 0.5625f, 0.5625f, -0.0625f}, linear = {0, 0.5f, 0.5f, 0};

using Row = std::array<float, brick_side>;
using Bits = unsigned;

/// Coarse distances around a fine brick, times two, and which of them exist.
struct Window {
  std::array<Row, window_side * window_side> row;  // y fastest
  std::array<Bits, window_side * window_side> there;
};

Window window_of(const NarrowBand& band, const RowArray& distance, Vec3i fine_brick) {
  Window window;
  const Vec3i parent = parent_of(fine_brick);
  const Vec3i first = octant_base(octant_in_parent(fine_brick)) - Vec3i{below, below, below};
  std::array<const uint32_t*, 27> rows;
  for (int slot = 0; slot < 27; ++slot)
    rows[static_cast<size_t>(slot)] = band.rows_of(band.grid().find(parent + slot_offset(slot)));
  for (int z = 0; z < window_side; ++z)
    for (int y = 0; y < window_side; ++y) {
      const int cy = first.y + y, cz = first.z + z;
      const auto k = static_cast<size_t>(y + window_side * z);
      window.there[k] = 0;
      for (int x = 0; x < window_side; ++x) {
        const int cx = first.x + x;
        const uint32_t row =
            rows[static_cast<size_t>(neighbor_slot(cx >> 3, cy >> 3, cz >> 3))][(cy & 7) + brick_side * (cz & 7)];
        window.row[k][static_cast<size_t>(x)] = 2 * distance.data()[size_t{row} * brick_side + (cx & 7)];
        window.there[k] |= (band.mask(row) >> (cx & 7) & 1u) << x;
      }
    }
  return window;
}

/// Fine vertices along x for which all coarse ones of their taps exist.
Bits spread_bits(Bits there, const Taps& taps) {
  Bits fine = 0;
  for (int x = 0; x < brick_side; ++x) {
    const int c = x / 2;  // taps c .. c + 3 of the window; on a coarse vertex only c + 1
    const Bits needed = (x & 1) == 0 ? 1u << (c + 1) : (taps[0] != 0 ? 0xfu : 0x6u) << c;
    fine |= static_cast<Bits>((there & needed) == needed) << x;
  }
  return fine;
}

/// A fine brick's values, and where they are complete.
struct Fine {
  std::array<Row, brick_area> row;  // y fastest
  std::array<Bits, brick_area> whole;
};

/// Interpolates along x, then y, then z.
Fine interpolated(const Window& window, const Taps& taps) {
  const auto between = [&taps](const Row& a, const Row& b, const Row& c, const Row& d, Row& out) {
    for (size_t x = 0; x < brick_side; ++x) out[x] = taps[0] * a[x] + taps[1] * b[x] + taps[2] * c[x] + taps[3] * d[x];
  };
  const bool wide = taps[0] != 0;
  const auto common = [wide](Bits a, Bits b, Bits c, Bits d) { return wide ? a & b & c & d : b & c; };
  std::array<Row, window_side * window_side> along_x;
  std::array<Bits, window_side * window_side> whole_x;
  for (size_t k = 0; k < along_x.size(); ++k) {
    const Row& in = window.row[k];
    for (size_t c = 0; c < half_brick; ++c) {
      along_x[k][2 * c] = in[c + 1];
      along_x[k][2 * c + 1] = taps[0] * in[c] + taps[1] * in[c + 1] + taps[2] * in[c + 2] + taps[3] * in[c + 3];
    }
    whole_x[k] = spread_bits(window.there[k], taps);
  }
  std::array<Row, brick_side * window_side> along_y;
  std::array<Bits, brick_side * window_side> whole_y;
  for (size_t z = 0; z < window_side; ++z)
    for (size_t c = 0; c < half_brick; ++c) {
      const Row* in = &along_x[window_side * z + c];
      const Bits* bits = &whole_x[window_side * z + c];
      const size_t k = brick_side * z + 2 * c;
      along_y[k] = in[1];
      whole_y[k] = bits[1];
      between(in[0], in[1], in[2], in[3], along_y[k + 1]);
      whole_y[k + 1] = common(bits[0], bits[1], bits[2], bits[3]);
    }
  Fine fine;
  for (size_t c = 0; c < half_brick; ++c)
    for (size_t y = 0; y < brick_side; ++y) {
      const auto in = [&](size_t tap) -> const Row& { return along_y[brick_side * (c + tap) + y]; };
      const auto bits = [&](size_t tap) { return whole_y[brick_side * (c + tap) + y]; };
      const size_t k = 2 * brick_side * c + y;
      fine.row[k] = in(1);
      fine.whole[k] = bits(1);
      between(in(0), in(1), in(2), in(3), fine.row[k + brick_side]);
      fine.whole[k + brick_side] = common(bits(0), bits(1), bits(2), bits(3));
    }
  return fine;
}

}  // namespace

RowArray prolong_distance(const NarrowBand& coarse_band, const RowArray& coarse, const NarrowBand& fine_band,
                          const RowArray& otherwise, const Context& context) {
  RowArray fine = fine_band.make_array();
  parallel_for(context, fine_band.grid().size(), 32, [&](size_t b) {
    if (fine_band.first_row(b) == fine_band.first_row(b + 1)) return;
    const Window window = window_of(coarse_band, coarse, fine_band.grid().coord(b));
    const Fine smooth = interpolated(window, cubic), plain = interpolated(window, linear);
    for (uint32_t r = fine_band.first_row(b); r < fine_band.first_row(b + 1); ++r) {
      const auto k = static_cast<size_t>(fine_band.place(r));
      const size_t first = size_t{r} * brick_side;
      for (size_t x = 0; x < brick_side; ++x)
        if (fine_band.mask(r) >> x & 1)
          fine.data()[first + x] = smooth.whole[k] >> x & 1  ? smooth.row[k][x]
                                   : plain.whole[k] >> x & 1 ? plain.row[k][x]
                                                             : otherwise.data()[first + x];
    }
  });
  return fine;
}

}  // namespace soapfilm
