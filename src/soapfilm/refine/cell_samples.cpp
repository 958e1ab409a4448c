#include "soapfilm/refine/cell_samples.h"

#include <algorithm>
#include <array>
#include <bit>
#include <utility>

#include "soapfilm/core/gather.h"

namespace soapfilm {

namespace {

constexpr size_t bricks_per_task = 32;

/// The band's rows of a row of cells' corners, y fastest, and those right of them.
struct CornerRows {
  std::array<uint32_t, 4> own, right;
};

CornerRows corners_of(const NarrowBand& band, uint32_t row) {
  CornerRows corners;
  corners.own = {row, band.neighbors(row)[3], band.neighbors(row)[5], band.neighbors(band.neighbors(row)[3])[5]};
  for (size_t k = 0; k < 4; ++k) corners.right[k] = band.neighbors(corners.own[k])[1];
  return corners;
}

/// Which cells of a row have all their corners in the band, as bits.
uint8_t whole_cells(const NarrowBand& band, const CornerRows& corners) {
  unsigned whole = 0xff;
  for (size_t k = 0; k < 4; ++k) {
    const unsigned left = band.mask(corners.own[k]);
    whole &= left & (left >> 1 | (band.mask(corners.right[k]) & 1u) << (brick_side - 1));
  }
  return static_cast<uint8_t>(whole);
}

/// The cell of a brick that holds a sample.
struct Cell {
  int x;
  size_t place;  ///< y + 8 z
  Vec3f fraction;
};

Cell cell_of(Vec3f local) {
  const auto part = [](float q) { return std::min(static_cast<int>(q), brick_side - 1); };
  const int x = part(local.x), y = part(local.y), z = part(local.z);
  return {x,
          static_cast<size_t>(y + brick_side * z),
          {local.x - static_cast<float>(x), local.y - static_cast<float>(y), local.z - static_cast<float>(z)}};
}

/// A brick's rows of cells, found by place.
class BrickCells {
 public:
  BrickCells(const NarrowBand& band, const CellSamples& cells, size_t brick) {
    const auto [begin, end] = cells.brick(brick);
    count_ = end - begin;
    for (size_t k = 0; k < count_; ++k) {
      const uint32_t row = cells.band_row(begin + k);
      at_[static_cast<size_t>(band.place(row))] = static_cast<uint8_t>(k);
      present_[k] = cells.present(begin + k);
      corners_[k] = corners_of(band, row);
    }
  }

  size_t count() const { return count_; }
  /// Which of the rows holds the cell.
  size_t row_of(const Cell& cell) const { return at_[cell.place]; }
  /// Cells are there for every sample that the band sees, so the others' are not.
  bool sees(const Cell& cell) const { return present_[row_of(cell)] >> cell.x & 1; }
  Jet jet(const RowArray& phi, const Cell& cell) const {
    const CornerRows& corners = corners_[row_of(cell)];
    const auto x = static_cast<size_t>(cell.x);
    std::array<float, 8> v;
    for (size_t k = 0; k < 4; ++k) {
      const float* own = phi.data() + size_t{corners.own[k]} * brick_side;
      v[2 * k] = own[x];
      v[2 * k + 1] = x + 1 < brick_side ? own[x + 1] : phi.data()[size_t{corners.right[k]} * brick_side];
    }
    return trilinear(v, cell.fraction);
  }

 private:
  static constexpr uint8_t none = brick_area;  // where no cell is present
  size_t count_ = 0;
  std::array<uint8_t, brick_area> at_ = filled();
  std::array<uint8_t, brick_area + 1> present_{};
  std::array<CornerRows, brick_area> corners_;

  static constexpr std::array<uint8_t, brick_area> filled() {
    std::array<uint8_t, brick_area> at{};
    for (uint8_t& k : at) k = none;
    return at;
  }
};

/// A row of cells while samples are added to them.
struct CellRow {
  float value[DataJob::values][brick_side];

  void add(const Cell& cell, const WeighedSample& sample) {
    for (int axis = 0; axis < 3; ++axis) {
      value[axis][cell.x] += sample.weight * cell.fraction[axis];
      value[3 + axis][cell.x] += sample.weight * sample.normal[axis];
    }
    value[6][cell.x] += sample.weight;
  }
  /// Those present, with means instead of sums; returns how many have any weight.
  size_t write(uint8_t present, float* out) const {
    const auto stride = static_cast<size_t>(std::popcount(present));
    size_t heavy = 0;
    for (unsigned bits = present; bits != 0; bits &= bits - 1, ++out) {
      const int x = std::countr_zero(bits);
      const float weight = value[6][x];
      for (size_t k = 0; k < 6; ++k) out[k * stride] = weight > 0 ? value[k][x] / weight : 0;
      out[6 * stride] = weight;
      heavy += weight > 0;
    }
    return heavy;
  }
};

/// A row of cells that hold samples.
struct FoundRow {
  size_t brick;
  uint32_t row;
  uint8_t present;
};

}  // namespace

CellSamples::CellSamples(const GridSamples& samples, const NarrowBand& band, const Parallel& parallel) {
  const size_t bricks = samples.bricks.size();
  const auto found = gather<FoundRow>(bricks, bricks_per_task, parallel, [&](size_t b, std::vector<FoundRow>& rows) {
    const uint32_t* row = band.rows_of(band.grid().find(samples.bricks.coord(b)));
    std::array<uint8_t, brick_area> held{};
    for (uint32_t s = samples.begin[b]; s < samples.begin[b + 1]; ++s) {
      const Cell cell = cell_of(samples.local[s]);
      held[cell.place] = static_cast<uint8_t>(held[cell.place] | 1u << cell.x);
    }
    for (size_t place = 0; place < brick_area; ++place)
      if (row[place] != 0 && held[place] != 0) {
        const unsigned seen = held[place] & whole_cells(band, corners_of(band, row[place]));
        if (seen != 0) rows.push_back({b, row[place], static_cast<uint8_t>(seen)});
      }
  });
  brick_.assign(bricks + 1, 0);
  layer_.assign(static_cast<size_t>(band.grid().bricks().z) + 1, 0);
  row_.reserve(found.size());
  present_.reserve(found.size());
  first_.assign(1, 0);
  first_.reserve(found.size() + 1);
  for (const FoundRow& r : found) {
    row_.push_back(r.row);
    present_.push_back(r.present);
    first_.push_back(first_.back() + static_cast<uint32_t>(std::popcount(r.present)));
    brick_[r.brick + 1] = static_cast<uint32_t>(row_.size());
    layer_[static_cast<size_t>(samples.bricks.coord(r.brick).z) + 1] = row_.size();
  }
  for (size_t b = 0; b < bricks; ++b) brick_[b + 1] = std::max(brick_[b], brick_[b + 1]);
  for (size_t z = 1; z < layer_.size(); ++z) layer_[z] = std::max(layer_[z - 1], layer_[z]);
  values_ = AlignedArray<float>(DataJob::values * size_t{first_.back()});
}

MergedCell CellSamples::cell(size_t row, int x) const {
  const auto stride = static_cast<size_t>(std::popcount(present_[row]));
  const float* v = values(row) + std::popcount(present_[row] & ((1u << x) - 1));
  return {{v[0], v[stride], v[2 * stride]}, {v[3 * stride], v[4 * stride], v[5 * stride]}, v[6 * stride]};
}

void CellSamples::set_weight(size_t row, int x, float weight) {
  const auto stride = static_cast<size_t>(std::popcount(present_[row]));
  values(row)[6 * stride + static_cast<size_t>(std::popcount(present_[row] & ((1u << x) - 1)))] = weight;
}

void merge(const RowArray& phi, const GridSamples& samples, const NarrowBand& band,
           const std::function<WeighedSample(size_t, const Jet&)>& weigh, DataWeights weights, const Parallel& parallel,
           CellSamples& cells) {
  constexpr float doubt = 0.25f;
  struct Counts {
    size_t cells = 0, doubted = 0;
  };
  std::vector<Counts> counts(samples.bricks.size());
  parallel.for_each(counts.size(), bricks_per_task, [&](size_t b) {
    const BrickCells brick(band, cells, b);
    std::array<CellRow, brick_area> rows;
    std::fill_n(rows.begin(), brick.count(), CellRow{});
    for (uint32_t s = samples.begin[b]; s < samples.begin[b + 1]; ++s) {
      const Cell cell = cell_of(samples.local[s]);
      const bool seen = brick.sees(cell);
      const WeighedSample sample = seen ? weigh(s, brick.jet(phi, cell)) : WeighedSample{};
      if (sample.weight < doubt) ++counts[b].doubted;
      if (sample.weight > 0) rows[brick.row_of(cell)].add(cell, sample);
    }
    const size_t first = cells.brick(b).first;
    for (size_t k = 0; k < brick.count(); ++k)
      counts[b].cells += rows[k].write(cells.present(first + k), cells.values(first + k));
  });
  cells.weights = weights;
  cells.count = cells.doubted = 0;
  for (const Counts& brick : counts) {
    cells.count += brick.cells;
    cells.doubted += brick.doubted;
  }
}

std::vector<std::optional<Jet>> jets_at_samples(const RowArray& phi, const GridSamples& samples,
                                                const CellSamples& cells, const NarrowBand& band,
                                                const Parallel& parallel) {
  std::vector<std::optional<Jet>> jets(samples.size());
  parallel.for_each(samples.bricks.size(), bricks_per_task, [&](size_t b) {
    const BrickCells brick(band, cells, b);
    for (uint32_t s = samples.begin[b]; s < samples.begin[b + 1]; ++s)
      if (const Cell cell = cell_of(samples.local[s]); brick.sees(cell)) jets[s] = brick.jet(phi, cell);
  });
  return jets;
}

/// All rows of cells, layer of bricks by layer; those of a layer in order. Every second layer touches no common vertex:
/// they may add to their corners at the same time, and the order of the sums is fixed.
double add_to_rows(const NarrowBand& band, const CellSamples& data, DataJob job, const Parallel& parallel) {
  const RowKernel kernel = row_kernel();
  job.cells = data.values_.data();
  job.first = data.first_.data();
  job.present = data.present_.data();
  job.row = data.row_.data();
  std::vector<double> sums(data.layer_.size() - 1);
  for_layers_apart(sums.size(), parallel, [&](size_t layer) {
    sums[layer] = kernel.data_term(band.view(), job, data.layer_[layer], data.layer_[layer + 1]);
  });
  double total = 0;
  for (const double sum : sums) total += sum;
  return total;
}

double add_data_term(const NarrowBand& band, const CellSamples& data, const RowArray& v, bool affine, float scale,
                     RowArray& out, const Parallel& parallel) {
  DataJob job{};
  job.normal = data.weights.normal;
  job.slope = data.weights.slope;
  job.affine = affine;
  job.scale = scale;
  job.v = v.data();
  job.out = out.data();
  return add_to_rows(band, data, job, parallel);
}

void add_position_weights(const NarrowBand& band, const CellSamples& data, RowArray& out, const Parallel& parallel) {
  DataJob job{};
  job.scale = 1;
  job.out = out.data();
  add_to_rows(band, data, job, parallel);
}

}  // namespace soapfilm
