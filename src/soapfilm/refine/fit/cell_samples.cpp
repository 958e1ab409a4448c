#include "soapfilm/refine/fit/cell_samples.h"

#include <algorithm>
#include <array>
#include <bit>
#include <utility>

#include "soapfilm/core/bits.h"
#include "soapfilm/core/context_state.h"
#include "soapfilm/core/gather.h"
#include "soapfilm/core/parallel.h"
#include "soapfilm/refine/fit/layers.h"

namespace soapfilm {

namespace {

constexpr size_t bricks_per_task = 32;

/// The band's rows that hold the corners of a row of cells, y fastest, and the rows right of them.
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
  const Vec3i first = cell_in_brick(local);
  return {first.x, static_cast<size_t>(first.y + brick_side * first.z), local - Vec3f(first)};
}

/// What is needed to weight the samples of a brick: its cells, and phi at their corners.
class BrickWindow {
 public:
  BrickWindow(const RowArray& phi, const NarrowBand& band, const CellSamples& cells, const GridSamples& samples,
              size_t brick) {
    const auto [begin, end] = cells.brick(brick);
    if (begin == end) return;
    for (size_t k = begin; k < end; ++k) {
      int32_t* row = cell_.data() + band.place(cells.band_row(k)) * brick_side;
      for (unsigned bits = cells.present(k); bits != 0; bits &= bits - 1) row[std::countr_zero(bits)] = ++count_;
    }
    copy_corners(phi, band, static_cast<size_t>(band.grid().find(samples.bricks.coord(brick))));
  }

  /// Cells, numbered from 1 in the order of the rows.
  int32_t count() const { return count_; }
  /// Every sample inside the band has a cell; the others have none.
  bool sees(const Cell& cell) const { return cell_[cell.place * brick_side + static_cast<size_t>(cell.x)] != 0; }
  Jet jet(const Cell& cell) const {
    const size_t y = cell.place % brick_side, z = cell.place / brick_side;
    const float* low = phi_.data() + static_cast<size_t>(cell.x) + side * y + area * z;
    return trilinear(
        {low[0], low[1], low[side], low[side + 1], low[area], low[area + 1], low[area + side], low[area + side + 1]},
        cell.fraction);
  }
  /// The parts of a kernel's job that describe the cells.
  SampleJob job() const {
    SampleJob job{};
    job.phi = phi_.data();
    job.cell = cell_.data();
    return job;
  }

 private:
  static constexpr int side = SampleJob::corners, area = side * side;

  void copy_corners(const RowArray& phi, const NarrowBand& band, size_t brick) {
    for (int z = 0; z < side; ++z)
      for (int y = 0; y < side; ++y) {
        const auto row = [&](int dx) {
          const int slot = neighbor_slot(dx, y / brick_side, z / brick_side);
          const int32_t owner = band.grid().neighbors(brick)[static_cast<size_t>(slot)];
          return phi.data() + size_t{band.row(owner, y % brick_side, z % brick_side)} * brick_side;
        };
        float* out = phi_.data() + side * y + area * z;
        std::copy_n(row(0), brick_side, out);
        out[brick_side] = *row(1);
      }
  }

  int32_t count_ = 0;
  std::array<int32_t, brick_volume> cell_{};
  std::array<float, area * side> phi_;
};

/// The sums over the samples of each cell of a brick; index 0 is unused.
class CellSums {
 public:
  explicit CellSums(int32_t cells) {
    std::fill_n(sum_.begin(), SampleJob::sums * (static_cast<size_t>(cells) + 1), 0.0f);
  }

  float* data() { return sum_.data(); }
  /// Writes them as means, of `count` cells from `first` on; returns how many have any weight.
  size_t write(size_t first, size_t count, float* out) const {
    size_t heavy = 0;
    for (size_t c = 0; c < count; ++c) {
      const float* sum = sum_.data() + SampleJob::sums * (first + c);
      const float weight = sum[6];
      for (size_t k = 0; k < 6; ++k) out[k * count + c] = weight > 0 ? sum[k] / weight : 0;
      out[6 * count + c] = weight;
      heavy += weight > 0;
    }
    return heavy;
  }

 private:
  alignas(64) std::array<float, SampleJob::sums*(brick_volume + 1)> sum_;
};

/// A row of cells that hold samples.
struct FoundRow {
  size_t brick;
  uint32_t row;
  uint8_t present;
};

}  // namespace

CellSamples::CellSamples(const GridSamples& samples, const NarrowBand& band, const Context& context) {
  const size_t bricks = samples.bricks.size();
  const auto found = gather<FoundRow>(bricks, bricks_per_task, context, [&](size_t b, std::vector<FoundRow>& rows) {
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
  row_.reserve(found.size());
  present_.reserve(found.size());
  first_.assign(1, 0);
  first_.reserve(found.size() + 1);
  for (const FoundRow& r : found) {
    row_.push_back(r.row);
    present_.push_back(r.present);
    first_.push_back(first_.back() + static_cast<uint32_t>(count_bits(r.present)));
    brick_[r.brick + 1] = static_cast<uint32_t>(row_.size());
  }
  for (size_t b = 0; b < bricks; ++b) {
    brick_[b + 1] = std::max(brick_[b], brick_[b + 1]);
    coord_.push_back(samples.bricks.coord(b));
  }
  layer_.assign(1, 0);
  for (int layer = 0; layer < layers_of(band); ++layer)
    layer_.push_back(samples.bricks.bricks_below(band.layers().z(layer) + 1));
  values_ = AlignedArray<float>(DataJob::values * size_t{first_.back()}, pages_of(context));
}

MergedCell CellSamples::cell(size_t row, int x) const {
  const auto stride = static_cast<size_t>(count_bits(present_[row]));
  const float* v = values(row) + count_bits(present_[row] & ((1u << x) - 1));
  return {{v[0], v[stride], v[2 * stride]}, {v[3 * stride], v[4 * stride], v[5 * stride]}, v[6 * stride]};
}

void CellSamples::set_weight(size_t row, int x, float weight) {
  const auto stride = static_cast<size_t>(count_bits(present_[row]));
  values(row)[6 * stride + static_cast<size_t>(count_bits(present_[row] & ((1u << x) - 1)))] = weight;
}

void merge(const RowArray& phi, const GridSamples& samples, const NarrowBand& band, const Weighing& weighing,
           DataWeights weights, const Context& context, CellSamples& cells) {
  constexpr float doubt = 0.25f;
  struct Counts {
    size_t cells = 0, doubted = 0;
  };
  std::vector<Counts> counts(samples.bricks.size());
  const RowKernel& kernel = band.kernel();
  const auto bricks_in = [&](Layers layers) { return bricks_of(samples.bricks, layers); };
  constexpr int beside = 2;  // layers whose cells add to those of a slab, and one more
  const ItemRange at_hand =
      band.slabs() ? bricks_in(band.slabs()->own().widened(beside, beside)) : ItemRange{0, counts.size()};
  parallel_for(context, at_hand.size(), bricks_per_task, [&](size_t i) {
    const size_t b = at_hand.begin + i;
    const size_t begin = samples.begin[b];
    const BrickWindow window(phi, band, cells, samples, b);
    CellSums sums(window.count());
    SampleJob job = window.job();
    job.local = samples.local.data() + begin;
    job.direction = samples.direction.data() + begin;
    job.sample_weight = samples.weight.empty() ? nullptr : samples.weight.data() + begin;
    job.active = weighing.active.empty() ? nullptr : weighing.active.data() + begin;
    job.count = samples.begin[b + 1] - begin;
    job.penalty = weighing.penalty;
    job.scale = weighing.scale;
    job.directions = weighing.directions;
    job.doubt = doubt;
    job.cells = sums.data();
    counts[b].doubted = window.count() > 0 ? kernel.add_samples(job) : job.count;
    const auto [first, last] = cells.brick(b);
    size_t written = 1;
    for (size_t k = first; k < last; ++k) {
      const auto count = static_cast<size_t>(count_bits(cells.present(k)));
      counts[b].cells += sums.write(written, count, cells.values(k));
      written += count;
    }
  });
  if (band.slabs()) bring_all(band.slabs()->ranks(), band.slabs()->parts(bricks_in), {{counts.data(), sizeof(Counts)}});
  cells.weights = weights;
  cells.count = cells.doubted = 0;
  for (const Counts& brick : counts) {
    cells.count += brick.cells;
    cells.doubted += brick.doubted;
  }
}

std::vector<std::optional<Jet>> jets_at_samples(const RowArray& phi, const GridSamples& samples,
                                                const CellSamples& cells, const NarrowBand& band,
                                                const Context& context) {
  std::vector<std::optional<Jet>> jets(samples.size());
  parallel_for(context, samples.bricks.size(), bricks_per_task, [&](size_t b) {
    const BrickWindow window(phi, band, cells, samples, b);
    for (uint32_t s = samples.begin[b]; s < samples.begin[b + 1]; ++s)
      if (const Cell cell = cell_of(samples.local[s]); window.sees(cell)) jets[s] = window.jet(cell);
  });
  return jets;
}

DataTerm::DataTerm(const NarrowBand& band, const CellSamples& data, const RowArray* v, bool affine, float scale,
                   RowArray* out)
    : band_(band), data_(data) {
  job_.cells = data.values_.data();
  job_.first = data.first_.data();
  job_.present = data.present_.data();
  job_.row = data.row_.data();
  job_.normal = data.weights.normal;
  job_.slope = data.weights.slope;
  job_.affine = affine;
  job_.scale = scale;
  job_.v = v ? v->data() : nullptr;
  job_.out = out ? out->data() : nullptr;
}

DataTerm DataTerm::gradient(const NarrowBand& band, const CellSamples& data, const RowArray& v, float scale,
                            RowArray& out) {
  return {band, data, &v, true, scale, &out};
}
DataTerm DataTerm::hessian(const NarrowBand& band, const CellSamples& data, const RowArray& v, RowArray* out) {
  return {band, data, &v, false, 1, out};
}
DataTerm DataTerm::row_sums(const NarrowBand& band, const CellSamples& data, RowArray& out) {
  return {band, data, nullptr, false, 1, &out};
}

double DataTerm::total(std::vector<double>& energies) const {
  if (const Slabs* slabs = band_.slabs()) {
    const auto z = [&](size_t b) { return data_.coord_[b].z; };
    bring_all(slabs->ranks(), slabs->parts([&](Layers layers) { return items_of(energies.size(), layers, z); }),
              {{energies.data(), sizeof(double)}});
  }
  return ordered_sum(energies, [&](size_t b) { return data_.coord_[b]; });
}

void DataTerm::add(int layer, std::vector<double>* energies) const {
  const auto first = data_.layer_.begin() + layer;
  for (size_t b = first[0]; b < first[1]; ++b) {
    const auto [begin, end] = data_.brick(b);
    const double energy = band_.kernel().data_term(band_.view(), job_, begin, end);
    if (energies) (*energies)[b] = energy;
  }
}

double DataTerm::add(const Context& context) const {
  std::vector<double> energies = make_energies();
  for_even_then_odd_layers(band_.layers_at_hand(), context, [&](int layer) { add(layer, &energies); });
  return total(energies);
}

}  // namespace soapfilm
