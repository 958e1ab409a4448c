#include "soapfilm/refine/cell_samples.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace soapfilm {

namespace {

constexpr size_t cells_per_task = 1 << 12;

/// The rows and lanes of a cell's eight corners, x fastest.
struct Corners {
  std::array<size_t, 8> slot;
};

using CellRows = std::array<uint32_t, 4>;

/// The rows of a cell's corners, y fastest.
CellRows rows_of(const NarrowBand& band, uint32_t row) {
  return {row, band.neighbors(row)[3], band.neighbors(row)[5], band.neighbors(band.neighbors(row)[3])[5]};
}

Corners corners_of(const NarrowBand& band, const CellRows& rows, int x) {
  Corners corners;
  for (size_t k = 0; k < 4; ++k) {
    corners.slot[2 * k] = static_cast<size_t>(rows[k]) * brick_side + static_cast<size_t>(x);
    corners.slot[2 * k + 1] =
        x < 7 ? corners.slot[2 * k] + 1 : static_cast<size_t>(band.neighbors(rows[k])[1]) * brick_side;
  }
  return corners;
}

bool in_band(const NarrowBand& band, const Corners& corners) {
  return std::all_of(corners.slot.begin(), corners.slot.end(), [&](size_t slot) {
    return band.mask(static_cast<uint32_t>(slot / brick_side)) >> (slot % brick_side) & 1;
  });
}

/// Trilinear value and gradient.
Jet jet(const std::array<float, 8>& v, Vec3f f) {
  const auto mix = [](float a, float b, float t) { return a + t * (b - a); };
  const float x00 = mix(v[0], v[1], f.x), x10 = mix(v[2], v[3], f.x);
  const float x01 = mix(v[4], v[5], f.x), x11 = mix(v[6], v[7], f.x);
  const float y0 = mix(x00, x10, f.y), y1 = mix(x01, x11, f.y);
  const float dx = mix(mix(v[1] - v[0], v[3] - v[2], f.y), mix(v[5] - v[4], v[7] - v[6], f.y), f.z);
  return {mix(y0, y1, f.z), {dx, mix(x10 - x00, x11 - x01, f.z), y1 - y0}};
}

/// Trilinear weights of a cell's corners at a point, and their derivatives.
struct Trilinear {
  std::array<float, 8> value, x, y, z;

  explicit Trilinear(Vec3f f) {
    const float wx[2] = {1 - f.x, f.x}, wy[2] = {1 - f.y, f.y}, wz[2] = {1 - f.z, f.z};
    for (size_t k = 0; k < 8; ++k) {
      const float bx = wx[k & 1], by = wy[k >> 1 & 1], bz = wz[k >> 2];
      value[k] = bx * by * bz;
      x[k] = k & 1 ? by * bz : -(by * bz);
      y[k] = k & 2 ? bx * bz : -(bx * bz);
      z[k] = k & 4 ? bx * by : -(bx * by);
    }
  }
  /// Weights of the derivative along a vector.
  std::array<float, 8> along(Vec3f n) const {
    std::array<float, 8> d;
    for (size_t k = 0; k < 8; ++k) d[k] = n.x * x[k] + n.y * y[k] + n.z * z[k];
    return d;
  }
};

Vec3f fraction_of(Vec3f local) {
  const auto part = [](float q) { return q - static_cast<float>(std::min(static_cast<int>(q), 7)); };
  return {part(local.x), part(local.y), part(local.z)};
}

}  // namespace

BandSamples locate(const GridSamples& samples, const NarrowBand& band, const Parallel& parallel) {
  BandSamples where{std::vector<uint32_t>(samples.size()), std::vector<uint8_t>(samples.size())};
  parallel.for_each(samples.bricks.size(), 32, [&](size_t b) {
    const int32_t brick = band.grid().find(samples.bricks.coord(b));
    if (brick < 0) return;
    for (uint32_t s = samples.begin[b]; s < samples.begin[b + 1]; ++s) {
      const Vec3f q = samples.local[s];
      const int x = std::min(static_cast<int>(q.x), 7), y = std::min(static_cast<int>(q.y), 7),
                z = std::min(static_cast<int>(q.z), 7);
      const uint32_t row = band.row(brick, y, z);
      if (row == 0 || !in_band(band, corners_of(band, rows_of(band, row), x))) continue;
      where.cell_row[s] = row;
      where.cell_x[s] = static_cast<uint8_t>(x);
    }
  });
  return where;
}

CellSamples merge(const GridSamples& samples, const BandSamples& where, const NarrowBand& band,
                  std::span<const float> weight, std::span<const Vec3f> normal, DataWeights weights,
                  const Parallel& parallel) {
  struct Sums {
    Vec3f position, normal;
    float weight = 0;
  };
  struct Brick {
    std::vector<CellSample> cells;
    std::vector<std::pair<uint32_t, uint8_t>> place;
  };
  std::vector<Brick> bricks(samples.bricks.size());
  parallel.for_chunks(bricks.size(), 32, [&](size_t first, size_t last) {
    std::array<Sums, brick_volume> sums;
    for (size_t b = first; b < last; ++b) {
      sums.fill({});
      std::array<uint64_t, brick_side> touched{};
      for (uint32_t s = samples.begin[b]; s < samples.begin[b + 1]; ++s) {
        if (where.cell_row[s] == 0 || weight[s] <= 0) continue;
        const auto cell = static_cast<size_t>(where.cell_x[s] + brick_side * band.place(where.cell_row[s]));
        Sums& sum = sums[cell];
        sum.position += weight[s] * fraction_of(samples.local[s]);
        sum.normal += weight[s] * normal[s];
        sum.weight += weight[s];
        touched[cell / 64] |= uint64_t{1} << (cell % 64);
      }
      const int32_t brick = band.grid().find(samples.bricks.coord(b));
      for (size_t cell = 0; cell < brick_volume; ++cell) {
        if (!(touched[cell / 64] >> (cell % 64) & 1)) continue;
        const Sums& sum = sums[cell];
        bricks[b].cells.push_back({sum.position / sum.weight, sum.weight, sum.normal / sum.weight,
                                   weights.normal * sum.weight, weights.slope * sum.weight});
        bricks[b].place.emplace_back(band.row(brick, static_cast<int>(cell >> 3 & 7), static_cast<int>(cell >> 6)),
                                     cell & 7);
      }
    }
  });

  CellSamples merged;
  size_t total = 0;
  for (const Brick& brick : bricks) total += brick.cells.size();
  merged.cells.reserve(total);
  merged.x.reserve(total);
  merged.begin.assign(band.rows() + 2, 0);
  for (const Brick& brick : bricks) {
    merged.cells.insert(merged.cells.end(), brick.cells.begin(), brick.cells.end());
    for (const auto& [row, x] : brick.place) {
      merged.x.push_back(x);
      ++merged.begin[row + 1];
    }
  }
  merged.stencil.resize(total);
  parallel.for_each(total, cells_per_task, [&](size_t c) {
    const Trilinear t(merged.cells[c].fraction);
    merged.stencil[c] = {t.value, t.along(merged.cells[c].normal)};
  });
  for (size_t r = 0; r + 1 < merged.begin.size(); ++r) merged.begin[r + 1] += merged.begin[r];
  for (size_t b = 0; b < band.grid().size(); ++b) {
    const Vec3i c = band.grid().coord(b);
    if (merged.begin[band.first_row(b + 1)] > merged.begin[band.first_row(b)])
      merged.colors[static_cast<size_t>((c.x & 1) + 2 * (c.y & 1) + 4 * (c.z & 1))].push_back(static_cast<uint32_t>(b));
  }
  return merged;
}

std::vector<Jet> jets_at_samples(const RowArray& phi, const GridSamples& samples, const BandSamples& where,
                                 const NarrowBand& band, const Parallel& parallel) {
  std::vector<Jet> jets(samples.size());
  parallel.for_each(samples.size(), cells_per_task, [&](size_t s) {
    if (where.cell_row[s] == 0) return;
    const Corners corners = corners_of(band, rows_of(band, where.cell_row[s]), where.cell_x[s]);
    std::array<float, 8> v;
    for (size_t k = 0; k < 8; ++k) v[k] = phi.data()[corners.slot[k]];
    jets[s] = jet(v, fraction_of(samples.local[s]));
  });
  return jets;
}

namespace {

float product(const std::array<float, 8>& a, const std::array<float, 8>& b) {
  return ((a[0] * b[0] + a[1] * b[1]) + (a[2] * b[2] + a[3] * b[3])) +
         ((a[4] * b[4] + a[5] * b[5]) + (a[6] * b[6] + a[7] * b[7]));
}

/// Calls visit(cell, its stencil, its corners) for all cells. Bricks of one colour (the parity of their coordinates)
/// touch no common vertex: they may add to their corners at the same time, and the order of the sums is fixed.
template <class Visit>
void for_each_cell(const NarrowBand& band, const CellSamples& data, const Parallel& parallel, Visit&& visit) {
  for (const std::vector<uint32_t>& bricks : data.colors)
    parallel.for_each(bricks.size(), 16, [&](size_t i) {
      for (uint32_t r = band.first_row(bricks[i]); r < band.first_row(bricks[i] + 1); ++r)
        if (data.begin[r] < data.begin[r + 1]) {
          const CellRows rows = rows_of(band, r);
          for (uint32_t c = data.begin[r]; c < data.begin[r + 1]; ++c)
            visit(data.cells[c], data.stencil[c], corners_of(band, rows, data.x[c]));
        }
    });
}

}  // namespace

void add_data_term(const NarrowBand& band, const CellSamples& data, const RowArray& v, bool affine, RowArray& out,
                   const Parallel& parallel) {
  for_each_cell(
      band, data, parallel, [&](const CellSample& cell, const CellSamples::Stencil& stencil, const Corners& corners) {
        std::array<float, 8> values;
        for (size_t k = 0; k < 8; ++k) values[k] = v.data()[corners.slot[k]];
        const float value = cell.weight * product(stencil.value, values);
        const float slope = (cell.slope_weight - cell.normal_weight) *
                            (product(stencil.along, values) + (affine ? dot(cell.normal, cell.normal) : 0.0f));
        std::array<float, 8> sum;
        for (size_t k = 0; k < 8; ++k) sum[k] = value * stencil.value[k] + slope * stencil.along[k];
        if (cell.normal_weight > 0) {
          const Trilinear t(cell.fraction);
          Vec3f g{product(t.x, values), product(t.y, values), product(t.z, values)};
          if (affine) g += cell.normal;
          g = cell.normal_weight * g;
          for (size_t k = 0; k < 8; ++k) sum[k] += g.x * t.x[k] + g.y * t.y[k] + g.z * t.z[k];
        }
        for (size_t k = 0; k < 8; ++k) out.data()[corners.slot[k]] += sum[k];
      });
}

void add_data_diagonal(const NarrowBand& band, const CellSamples& data, RowArray& out, const Parallel& parallel) {
  for_each_cell(
      band, data, parallel, [&](const CellSample& cell, const CellSamples::Stencil& stencil, const Corners& corners) {
        const Trilinear t(cell.fraction);
        const float gradient = 2 * std::max(cell.normal_weight, cell.slope_weight);
        for (size_t k = 0; k < 8; ++k)  // |d_x b| sums to 2 over the corners, and so for y and z
          out.data()[corners.slot[k]] +=
              cell.weight * stencil.value[k] + gradient * (std::abs(t.x[k]) + std::abs(t.y[k]) + std::abs(t.z[k]));
      });
}

}  // namespace soapfilm
