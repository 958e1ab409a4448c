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

CellSamples cells_of(const GridSamples& samples, const BandSamples& where, const NarrowBand& band,
                     const Parallel& parallel) {
  const size_t bricks = samples.bricks.size();
  std::vector<uint64_t> touched(bricks);  // rows of each brick that hold a sample
  parallel.for_each(bricks, 32, [&](size_t b) {
    for (uint32_t s = samples.begin[b]; s < samples.begin[b + 1]; ++s)
      if (where.cell_row[s] != 0) touched[b] |= uint64_t{1} << band.place(where.cell_row[s]);
  });
  CellSamples cells;
  cells.layer.assign(static_cast<size_t>(band.grid().bricks().z) + 1, 0);
  cells.first.assign(1, 0);
  for (size_t b = 0; b < bricks; ++b) {
    const int32_t brick = band.grid().find(samples.bricks.coord(b));
    for (uint64_t bits = touched[b]; bits != 0; bits &= bits - 1) {
      const int place = std::countr_zero(bits);
      cells.row.push_back(band.row(brick, place & 7, place >> 3));
    }
    cells.first.push_back(static_cast<uint32_t>(cells.row.size()));
    cells.layer[static_cast<size_t>(samples.bricks.coord(b).z) + 1] = cells.row.size();
  }
  for (size_t z = 1; z < cells.layer.size(); ++z) cells.layer[z] = std::max(cells.layer[z], cells.layer[z - 1]);
  cells.rows.resize(cells.row.size());
  return cells;
}

namespace {

void add_sample(Vec3f fraction, size_t x, const WeighedSample& sample, CellRow& cells) {
  for (int axis = 0; axis < 3; ++axis) {
    cells.fraction[axis][x] += sample.weight * fraction[axis];
    cells.normal[axis][x] += sample.weight * sample.normal[axis];
  }
  cells.weight[x] += sample.weight;
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

void merge(const GridSamples& samples, const BandSamples& where, const NarrowBand& band,
           const std::function<WeighedSample(size_t)>& weigh, DataWeights weights, const Parallel& parallel,
           CellSamples& cells) {
  constexpr float doubt = 0.25f;
  struct Counts {
    size_t cells = 0, doubted = 0;
  };
  std::vector<Counts> counts(samples.bricks.size());
  parallel.for_each(counts.size(), 32, [&](size_t b) {
    CellRow* rows = cells.rows.data() + cells.first[b];
    const size_t count = cells.first[b + 1] - cells.first[b];
    std::array<uint8_t, brick_area> at{};  // which of the brick's rows of cells is at a place
    for (size_t k = 0; k < count; ++k) {
      rows[k] = {};
      at[static_cast<size_t>(band.place(cells.row[cells.first[b] + k]))] = static_cast<uint8_t>(k);
    }
    for (uint32_t s = samples.begin[b]; s < samples.begin[b + 1]; ++s) {
      const uint32_t row = where.cell_row[s];
      const WeighedSample sample = row != 0 ? weigh(s) : WeighedSample{};
      if (sample.weight < doubt) ++counts[b].doubted;
      if (sample.weight > 0)
        add_sample(fraction_of(samples.local[s]), where.cell_x[s], sample,
                   rows[at[static_cast<size_t>(band.place(row))]]);
    }
    for (size_t k = 0; k < count; ++k) counts[b].cells += divide_by_weight(rows[k]);
  });
  cells.weights = weights;
  cells.count = cells.doubted = 0;
  for (const Counts& brick : counts) {
    cells.count += brick.cells;
    cells.doubted += brick.doubted;
  }
}

Jet jet_at_sample(const RowArray& phi, const GridSamples& samples, const BandSamples& where, const NarrowBand& band,
                  size_t sample) {
  if (where.cell_row[sample] == 0) return {};
  const Corners corners = corners_of(band, rows_of(band, where.cell_row[sample]), where.cell_x[sample]);
  std::array<float, 8> v;
  for (size_t k = 0; k < 8; ++k) v[k] = phi.data()[corners.slot[k]];
  return trilinear(v, fraction_of(samples.local[sample]));
}

std::vector<Jet> jets_at_samples(const RowArray& phi, const GridSamples& samples, const BandSamples& where,
                                 const NarrowBand& band, const Parallel& parallel) {
  std::vector<Jet> jets(samples.size());
  parallel.for_each(samples.size(), cells_per_task,
                    [&](size_t s) { jets[s] = jet_at_sample(phi, samples, where, band, s); });
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
