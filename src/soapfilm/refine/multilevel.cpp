#include "soapfilm/refine/multilevel.h"

#include <algorithm>
#include <cmath>

namespace soapfilm {

namespace {

constexpr size_t coarsest_rows = 64;
constexpr size_t most_levels = 8;
constexpr float least_extent = 1e-6f;
constexpr float coarse_diagonal = 2;  // levels overlap: their sum would count twice

const NarrowBand& band_of(const NarrowBand& fine, const std::vector<CoarseBand>& levels, size_t level) {
  return level == 0 ? fine : levels[level - 1].band();
}

/// Bits of the coarse vertices that a fine row's vertices interpolate from, from coarse vertex 4 (brick's x) on.
unsigned coarse_bits(unsigned fine_mask) {
  unsigned bits = 0;
  for (unsigned x = 0; x < brick_side; ++x)
    if (fine_mask >> x & 1) bits |= 1u << (x / 2) | 1u << ((x + 1) / 2);
  return bits;
}

/// Calls visit(coarse y relative to the parent brick, weight) for the one or two coarse rows of a fine coordinate.
template <class Visit>
void for_each_parent(int fine, Visit&& visit) {
  visit(fine >> 1, fine & 1 ? 0.5f : 1.0f);
  if (fine & 1) visit((fine >> 1) + 1, 0.5f);
}

}  // namespace

CoarseBand::CoarseBand(const NarrowBand& fine, const Parallel& parallel) {
  const BrickGrid& grid = fine.grid();
  const Vec3i box = grid.bricks();
  // A fine brick touches its parent and, where it is the upper half, the parent's upper neighbours.
  BrickMask mask({box.x / 2 + 2, box.y / 2 + 2, box.z / 2 + 2});
  for (size_t b = 0; b < grid.size(); ++b) {
    if (fine.first_row(b) == fine.first_row(b + 1)) continue;
    const Vec3i c = grid.coord(b);
    for (int k = 0; k < 8; ++k) {
      const Vec3i up{k & 1 & c.x, k >> 1 & 1 & c.y, k >> 2 & c.z};
      mask.set(Vec3i{c.x >> 1, c.y >> 1, c.z >> 1} + up);
    }
  }
  BrickGrid coarse(mask, parallel);
  parent_.resize(grid.size());
  parallel.for_each(grid.size(), 256, [&](size_t b) {
    const Vec3i c = grid.coord(b);
    parent_[b] = coarse.find({c.x >> 1, c.y >> 1, c.z >> 1});
  });
  std::vector<uint8_t> vertices(coarse.size() * brick_area);
  for (size_t b = 0; b < grid.size(); ++b) {
    const Vec3i half{4 * (grid.coord(b).x & 1), 4 * (grid.coord(b).y & 1), 4 * (grid.coord(b).z & 1)};
    for (uint32_t r = fine.first_row(b); r < fine.first_row(b + 1); ++r) {
      const unsigned bits = coarse_bits(fine.mask(r)) << half.x;
      const auto& around = coarse.neighbors(static_cast<size_t>(parent_[b]));
      for_each_parent(fine.place(r) >> 3, [&](int cz, float) {
        for_each_parent(fine.place(r) & 7, [&](int cy, float) {
          const int y = half.y + cy, z = half.z + cz;
          for (int up = 0; up < 2; ++up) {
            const unsigned part = bits >> (8 * up) & 0xff;
            const int32_t brick = around[static_cast<size_t>(neighbor_slot(up, y >> 3, z >> 3))];
            if (part != 0)
              vertices[static_cast<size_t>(brick) * brick_area + static_cast<size_t>((y & 7) + 8 * (z & 7))] |=
                  static_cast<uint8_t>(part);
          }
        });
      });
    }
  }
  band_ = NarrowBand(std::move(coarse), vertices, parallel);
  children_.resize(band_.grid().size());
  parallel.for_each(children_.size(), 64, [&](size_t b) {
    for (int slot = 0; slot < 27; ++slot)
      children_[b][static_cast<size_t>(slot)] = grid.find(band_.grid().coord(b) * 2 + slot_offset(slot));
  });
}

void CoarseBand::restrict_to(const NarrowBand& fine, const RowArray& from, RowArray& coarse,
                             const Parallel& parallel) const {
  const auto at = [&](uint32_t row) { return from.data() + static_cast<size_t>(row) * brick_side; };
  parallel.for_each(band_.grid().size(), 32, [&](size_t b) {
    const auto child = [&](int x, int y, int z) {
      return fine.row(children_[b][static_cast<size_t>(neighbor_slot(x, y >> 3, z >> 3))], y & 7, z & 7);
    };
    for (uint32_t r = band_.first_row(b); r < band_.first_row(b + 1); ++r) {
      const int y = band_.place(r) & 7, z = band_.place(r) >> 3;
      float sum[17] = {};  // fine x from -1 to 15
      for (int dz = -1; dz <= 1; ++dz)
        for (int dy = -1; dy <= 1; ++dy) {
          const float weight = (dy ? 0.5f : 1.0f) * (dz ? 0.5f : 1.0f);
          const int fy = 2 * y + dy, fz = 2 * z + dz;
          sum[0] += weight * at(child(-1, fy, fz))[7];
          for (int part = 0; part < 2; ++part) {
            const uint32_t row = child(part, fy, fz);
            if (row == 0) continue;
            const float* values = at(row);
            float* to = sum + 1 + 8 * part;
            for (int x = 0; x < brick_side; ++x) to[x] += weight * values[x];
          }
        }
      float* to = coarse.data() + static_cast<size_t>(r) * brick_side;
      for (int x = 0; x < brick_side; ++x) {
        const float value = sum[2 * x + 1] + 0.5f * (sum[2 * x] + sum[2 * x + 2]);
        to[x] = band_.mask(r) >> x & 1 ? value : 0.0f;
      }
    }
  });
}

void CoarseBand::prolong_add(const NarrowBand& fine, const RowArray& coarse, RowArray& to,
                             const Parallel& parallel) const {
  const auto at = [&](uint32_t row) { return coarse.data() + static_cast<size_t>(row) * brick_side; };
  parallel.for_each(fine.grid().size(), 64, [&](size_t b) {
    if (fine.first_row(b) == fine.first_row(b + 1)) return;
    const Vec3i c = fine.grid().coord(b);
    const Vec3i half{4 * (c.x & 1), 4 * (c.y & 1), 4 * (c.z & 1)};
    const auto& around = band_.grid().neighbors(static_cast<size_t>(parent_[b]));
    for (uint32_t r = fine.first_row(b); r < fine.first_row(b + 1); ++r) {
      float sum[5] = {};
      for_each_parent(fine.place(r) >> 3, [&](int cz, float wz) {
        for_each_parent(fine.place(r) & 7, [&](int cy, float wy) {
          const int y = half.y + cy, z = half.z + cz;
          const auto row = [&](int x) {
            return at(band_.row(around[static_cast<size_t>(neighbor_slot(x, y >> 3, z >> 3))], y & 7, z & 7));
          };
          const float* low = row(0) + half.x;
          for (int x = 0; x < 4; ++x) sum[x] += wy * wz * low[x];
          sum[4] += wy * wz * (half.x == 0 ? low[4] : row(1)[0]);
        });
      });
      float* out = to.data() + static_cast<size_t>(r) * brick_side;
      const unsigned mask = fine.mask(r);
      for (int x = 0; x < brick_side; ++x) {
        const float value = x & 1 ? 0.5f * (sum[x / 2] + sum[x / 2 + 1]) : sum[x / 2];
        out[x] += mask >> x & 1 ? value : 0.0f;
      }
    }
  });
}

Multilevel::Multilevel(const NarrowBand& fine, const Parallel& parallel) : fine_(fine) {
  inverse_.push_back(fine.make_array());
  while (band_of(fine, levels_, levels_.size()).rows() > coarsest_rows && levels_.size() < most_levels) {
    const NarrowBand& finer = band_of(fine, levels_, levels_.size());
    RowArray ones;
    if (levels_.empty()) {
      ones = finer.make_array();
      for (uint32_t r = 1; r <= finer.rows(); ++r)
        for (int x = 0; x < brick_side; ++x)
          ones.data()[static_cast<size_t>(r) * brick_side + static_cast<size_t>(x)] =
              static_cast<float>(finer.mask(r) >> x & 1);
    }
    CoarseBand coarse(finer, parallel);
    RowArray extent = coarse.band().make_array();
    coarse.restrict_to(finer, levels_.empty() ? ones : extent_.back(), extent, parallel);
    extent_.push_back(std::move(extent));
    inverse_.push_back(coarse.band().make_array());
    residual_.push_back(coarse.band().make_array());
    levels_.push_back(std::move(coarse));
  }
}

void Multilevel::set_operator(const RowArray& data_diagonal, float beta, float gamma, const Parallel& parallel) {
  const float root_gamma = std::sqrt(gamma), reaction = 0.5f * beta / root_gamma;
  std::vector<RowArray> diagonal(levels_.size());
  for (size_t l = 0; l <= levels_.size(); ++l) {
    const NarrowBand& band = band_of(fine_, levels_, l);
    if (l > 0) {
      diagonal[l - 1] = band.make_array();
      levels_[l - 1].restrict_to(band_of(fine_, levels_, l - 1), l == 1 ? data_diagonal : diagonal[l - 2],
                                 diagonal[l - 1], parallel);
    }
    const RowArray& data = l == 0 ? data_diagonal : diagonal[l - 1];
    const float diffusion = 6 * root_gamma / static_cast<float>(1 << (2 * l));
    parallel.for_chunks(band.rows(), rows_per_task, [&](size_t begin, size_t end) {
      for (size_t i = (begin + 1) * brick_side; i < (end + 1) * brick_side; ++i) {
        const float value = data.data()[i];
        float size = value + 6 * beta + 42 * gamma;
        if (l > 0) {
          const float extent = std::max(extent_[l - 1].data()[i], least_extent);
          size = coarse_diagonal * extent * (std::sqrt(value / extent) + reaction + diffusion);
        }
        const float scale = 1 / size;
        inverse_[l].data()[i] = band.mask(static_cast<uint32_t>(i / brick_side)) >> (i % brick_side) & 1 ? scale : 0.0f;
      }
    });
  }
}

namespace {

void multiply(const RowArray& a, const RowArray& b, RowArray& out, const Parallel& parallel) {
  parallel.for_chunks(a.size(), rows_per_task * brick_side, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) out.data()[i] = a.data()[i] * b.data()[i];
  });
}

}  // namespace

void Multilevel::apply(const RowArray& r, RowArray& z, const Parallel& parallel) {
  multiply(inverse_[0], r, z, parallel);
  if (levels_.empty()) return;
  levels_[0].restrict_to(fine_, r, residual_[0], parallel);
  apply_root(parallel);
  multiply(extent_[0], residual_[0], residual_[0], parallel);
  apply_root(parallel);
  levels_[0].prolong_add(fine_, residual_[0], z, parallel);
}

void Multilevel::apply_root(const Parallel& parallel) {
  for (size_t l = 1; l < levels_.size(); ++l)
    levels_[l].restrict_to(levels_[l - 1].band(), residual_[l - 1], residual_[l], parallel);
  for (size_t l = levels_.size(); l > 0; --l) {
    multiply(inverse_[l], residual_[l - 1], residual_[l - 1], parallel);
    if (l < levels_.size()) levels_[l].prolong_add(levels_[l - 1].band(), residual_[l], residual_[l - 1], parallel);
  }
}

}  // namespace soapfilm
