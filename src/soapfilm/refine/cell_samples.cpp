#include "soapfilm/refine/cell_samples.h"

#include <algorithm>
#include <array>
#include <bit>
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

namespace {

/// Adds a brick's samples to the rows of cells that hold them; `first` is the brick's first.
void merge_brick(const GridSamples& samples, const BandSamples& where, const NarrowBand& band, size_t brick,
                 std::span<const float> weight, std::span<const Vec3f> normal,
                 const std::array<uint8_t, brick_area>& at, CellRow* first) {
  for (uint32_t s = samples.begin[brick]; s < samples.begin[brick + 1]; ++s) {
    if (where.cell_row[s] == 0 || weight[s] <= 0) continue;
    CellRow& cells = first[at[static_cast<size_t>(band.place(where.cell_row[s]))]];
    const size_t x = where.cell_x[s];
    const Vec3f fraction = fraction_of(samples.local[s]);
    for (int axis = 0; axis < 3; ++axis) {
      cells.fraction[axis][x] += weight[s] * fraction[axis];
      cells.normal[axis][x] += weight[s] * normal[s][axis];
    }
    cells.weight[x] += weight[s];
  }
}

/// From sums to means.
size_t divide_by_weight(CellRow& cells) {
  size_t count = 0;
  for (size_t x = 0; x < brick_side; ++x) {
    if (cells.weight[x] <= 0) continue;
    ++count;
    for (int axis = 0; axis < 3; ++axis) {
      cells.fraction[axis][x] /= cells.weight[x];
      cells.normal[axis][x] /= cells.weight[x];
    }
  }
  return count;
}

}  // namespace

CellSamples merge(const GridSamples& samples, const BandSamples& where, const NarrowBand& band,
                  std::span<const float> weight, std::span<const Vec3f> normal, DataWeights weights,
                  const Parallel& parallel, CellSamples merged) {
  const size_t bricks = samples.bricks.size();
  std::vector<uint64_t> touched(bricks);  // rows of each brick that hold a sample
  parallel.for_each(bricks, 32, [&](size_t b) {
    for (uint32_t s = samples.begin[b]; s < samples.begin[b + 1]; ++s)
      if (where.cell_row[s] != 0 && weight[s] > 0) touched[b] |= uint64_t{1} << band.place(where.cell_row[s]);
  });
  merged.weights = weights;
  merged.count = 0;
  merged.row.clear();
  merged.layer.assign(static_cast<size_t>(band.grid().bricks().z) + 1, 0);
  std::vector<size_t> first(bricks + 1);
  for (size_t b = 0; b < bricks; ++b) {
    const int32_t brick = band.grid().find(samples.bricks.coord(b));
    for (uint64_t bits = touched[b]; bits != 0; bits &= bits - 1) {
      const int place = std::countr_zero(bits);
      merged.row.push_back(band.row(brick, place & 7, place >> 3));
    }
    first[b + 1] = merged.row.size();
    merged.layer[static_cast<size_t>(samples.bricks.coord(b).z) + 1] = merged.row.size();
  }
  for (size_t z = 1; z < merged.layer.size(); ++z) merged.layer[z] = std::max(merged.layer[z], merged.layer[z - 1]);

  // Where it has to grow the old memory goes first: both at once would be the refinement's peak.
  if (merged.rows.capacity() < merged.row.size()) merged.rows = std::vector<CellRow>();
  merged.rows.assign(merged.row.size(), {});
  std::vector<size_t> counts(bricks);
  parallel.for_each(bricks, 32, [&](size_t b) {
    std::array<uint8_t, brick_area> at{};
    uint8_t next = 0;
    for (uint64_t bits = touched[b]; bits != 0; bits &= bits - 1)
      at[static_cast<size_t>(std::countr_zero(bits))] = next++;
    merge_brick(samples, where, band, b, weight, normal, at, merged.rows.data() + first[b]);
    for (size_t k = first[b]; k < first[b + 1]; ++k) counts[b] += divide_by_weight(merged.rows[k]);
  });
  for (const size_t count : counts) merged.count += count;
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
    jets[s] = trilinear(v, fraction_of(samples.local[s]));
  });
  return jets;
}

namespace {

/// All rows of cells, layer of bricks by layer; those of a layer in order. Every second layer touches no common vertex:
/// they may add to their corners at the same time, and the order of the sums is fixed.
double add(const NarrowBand& band, const CellSamples& data, const DataJob& job, const Parallel& parallel) {
  const RowKernel kernel = row_kernel();
  std::vector<double> sums(data.layer.size() - 1);
  for (size_t parity = 0; parity < 2; ++parity)
    parallel.for_each((sums.size() + 1 - parity) / 2, 1, [&](size_t i) {
      const size_t layer = 2 * i + parity;
      sums[layer] = kernel.data_term(band.view(), job, data.layer[layer], data.layer[layer + 1]);
    });
  double total = 0;
  for (const double sum : sums) total += sum;
  return total;
}

}  // namespace

double add_data_term(const NarrowBand& band, const CellSamples& data, const RowArray& v, bool affine, float scale,
                     RowArray& out, const Parallel& parallel) {
  const auto [normal, slope] = data.weights;
  return add(band, data, {data.rows.data(), data.row.data(), normal, slope, affine, scale, v.data(), out.data()},
             parallel);
}

void add_position_weights(const NarrowBand& band, const CellSamples& data, RowArray& out, const Parallel& parallel) {
  add(band, data, {data.rows.data(), data.row.data(), 0, 0, false, 1, nullptr, out.data()}, parallel);
}

}  // namespace soapfilm
