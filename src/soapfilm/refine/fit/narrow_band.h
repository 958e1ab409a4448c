// The few vertices on either side of the surface, as rows of eight: what the sub-voxel fit works on.
//
// A row is the eight vertices of a brick with the same y and z. Rows are numbered from 1 in the order of the bricks,
// then by z and y; row 0 is empty and is the index of every row that is not in the band, so that loops need no
// branches. An array over a band has 8 floats per row, one more row that is empty too, and holds 0 at vertices outside
// the band.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "soapfilm/core/parallel.h"
#include "soapfilm/grid/brick_grid.h"
#include "soapfilm/grid/field.h"
#include "soapfilm/grid/ordered_sum.h"
#include "soapfilm/grid/slabs.h"
#include "soapfilm/kernels/row_kernel.h"
#include "soapfilm/refine/fit/layers.h"

namespace soapfilm {

using RowArray = AlignedArray<float>;

/// The layers of a grid's bricks along z, numbered so that neighboring layers have neighboring numbers and a layer's
/// number is even where its z is even: of empty layers between others at most one is counted.
class BandLayers {
 public:
  BandLayers() = default;
  explicit BandLayers(const BrickGrid& grid);

  int size() const { return static_cast<int>(z_.size()); }
  int z(int layer) const { return z_[static_cast<size_t>(layer)]; }
  /// The first layer whose z is at least the given one; size() if there is none.
  int from(int z) const { return static_cast<int>(std::lower_bound(z_.begin(), z_.end(), z) - z_.begin()); }
  /// Bricks [first, second).
  std::pair<size_t, size_t> operator[](int layer) const {
    return {begin_[static_cast<size_t>(layer)], begin_[static_cast<size_t>(layer) + 1]};
  }

 private:
  std::vector<int> z_;
  std::vector<size_t> begin_ = {0};
};

/// A set of vertices on a grid of bricks. Immutable once built.
class NarrowBand {
 public:
  NarrowBand() = default;
  /// `vertices` are the band's members: one byte per row of each brick (64 y-fastest rows), bit x for vertex x.
  NarrowBand(BrickGrid grid, const std::vector<uint8_t>& vertices, const Context& context);

  const BrickGrid& grid() const { return grid_; }
  const BandLayers& layers() const { return layers_; }
  size_t rows() const { return mask_.size() - 2; }
  /// Size of an array; one row more than there are, so that a row's end can be loaded together with what follows.
  size_t slots() const { return mask_.size() * brick_side; }
  size_t count() const;  ///< vertices
  RowArray make_array() const { return RowArray(slots(), pages_); }

  /// Rows of brick b: [first_row(b), first_row(b + 1)).
  uint32_t first_row(size_t brick) const { return first_row_[brick]; }
  /// The 64 rows of a brick at once, by y + 8 z.
  const uint32_t* rows_of(int32_t brick) const {
    static constexpr uint32_t none[brick_area] = {};
    return brick < 0 ? none : row_of_.data() + static_cast<size_t>(brick) * brick_area;
  }
  /// Row (y, z) of a brick, given as an index or as a result of BrickGrid::find; 0 where there is none.
  uint32_t row(int32_t brick, int y, int z) const { return rows_of(brick)[y + brick_side * z]; }
  uint8_t mask(uint32_t row) const { return mask_[row]; }
  /// y + 8 z of a row.
  int place(uint32_t row) const { return place_[row]; }
  const uint8_t* places() const { return place_.data(); }  ///< of all rows, from row 0 on
  /// Rows next to a row along -x, +x, -y, +y, -z, +z.
  const std::array<uint32_t, 6>& neighbors(uint32_t row) const { return neighbors_.data()[row]; }
  /// How many of a vertex's six neighbors are in the band, eight per row; 0 outside the band.
  const uint8_t* degree(uint32_t row) const { return degree_.data() + static_cast<size_t>(row) * brick_side; }

  /// From now on each rank has the values of its slab and of the layers next to it alone; null: of all.
  void share_out(std::shared_ptr<const Slabs> slabs) { slabs_ = std::move(slabs); }
  const Slabs* slabs() const { return slabs_.get(); }
  /// Layers next to a slab, on either side, whose values a rank gets from their owners: 16 vertices. Each stage of a
  /// pass is wrong at one vertex more than the one before, from the far side on; two cycles of Multilevel and the
  /// direction's image lose less than half of them. One layer is too few: what lies next to a slab adds to values in
  /// it, and a coarse layer of a slab that begins at an odd layer has parts from two below.
  static constexpr int layers_beside = 2;
  /// The layers that this rank works on, from an even one on.
  LayerRange layers_at_hand() const;

  /// The SIMD kernel for its rows.
  const RowKernel& kernel() const { return kernel_; }
  /// The kernel's view of it.
  BandRows view() const { return {neighbors_.data(), degree_.data(), mask_.data()}; }

 private:
  void count_neighbors(const Context& context);

  RowKernel kernel_{};
  PagePool pages_;
  BrickGrid grid_;
  BandLayers layers_;
  std::shared_ptr<const Slabs> slabs_;
  AlignedArray<uint32_t> row_of_;
  std::vector<uint32_t> first_row_;
  std::vector<uint8_t> mask_ = {0, 0};
  std::vector<uint8_t> place_;
  AlignedArray<std::array<uint32_t, 6>> neighbors_;
  AlignedArray<uint8_t> degree_;
};

inline constexpr size_t rows_per_task = 1 << 10;

/// A range [begin, end) of rows.
struct RowRange {
  size_t begin, end;
};
inline RowRange all_rows(const NarrowBand& band) { return {1, band.rows() + 1}; }
/// Layers of bricks, along z.
inline int layers_of(const NarrowBand& band) { return band.layers().size(); }
inline RowRange rows_of_layer(const NarrowBand& band, int layer) {
  const auto [begin, end] = band.layers()[layer];
  return {band.first_row(begin), band.first_row(end)};
}

/// Of the layers at hand.
inline RowRange rows_at_hand(const NarrowBand& band) {
  const LayerRange layers = band.layers_at_hand();
  if (layers.size() <= 0) return {1, 1};
  return {rows_of_layer(band, layers.begin).begin, rows_of_layer(band, layers.end - 1).end};
}
/// Rows of some layers, by z, as an array has them.
inline ItemRange rows_of(const NarrowBand& band, Layers layers) {
  const ItemRange bricks = bricks_of(band.grid(), layers);
  return {band.first_row(bricks.begin), band.first_row(bricks.end)};
}
/// Brings the layers beside the slab of a band in slabs up to date.
void bring_borders(const NarrowBand& band, RowArray& values);
/// Brings all rows.
void bring_all(const NarrowBand& band, RowArray& values);
/// What an array has in some rows, in their order, of which each rank may lack most.
std::vector<std::array<float, brick_side>> values_in(const NarrowBand& band, const RowArray& values,
                                                     const std::vector<uint32_t>& rows);

/// A subset of the rows, used for statistics: of larger bands those of bricks with some 16,000 rows, chosen by place.
inline std::vector<uint32_t> some_rows(const NarrowBand& band) {
  constexpr size_t enough_rows = 1 << 14;
  const size_t step = std::max<size_t>(band.rows() / enough_rows, 1);
  std::vector<uint32_t> rows;
  for (size_t b = 0; b < band.grid().size(); ++b)
    if (step == 1 || is_sampled(band.grid().coord(b), step))
      for (uint32_t r = band.first_row(b); r < band.first_row(b + 1); ++r) rows.push_back(r);
  return rows;
}

/// body(begin, end) over rows in chunks.
template <class Body>
void for_rows(RowRange rows, const Context& context, Body&& body) {
  parallel_chunks(context, rows.end - rows.begin, rows_per_task,
                  [&](size_t begin, size_t end) { body(rows.begin + begin, rows.begin + end); });
}

/// The sum of body(begin, end) over the rows of each brick (ordered_sum).
template <class Body>
double sum_over_rows(const NarrowBand& band, const Context& context, Body&& body) {
  return ordered_sum<double>(band.grid(), context,
                             [&](size_t b) { return body(band.first_row(b), band.first_row(b + 1)); });
}

/// The same, bit for bit, on the calling thread alone.
template <class Body>
double sum_over_rows(const NarrowBand& band, Body&& body) {
  TileSums<double> sums;
  for (size_t b = 0; b < band.grid().size(); ++b)
    sums.add(band.grid().coord(b), body(band.first_row(b), band.first_row(b + 1)));
  return sums.total();
}

/// The same in layers of bricks, which threads may take in any order.
class LayerSums {
 public:
  explicit LayerSums(const NarrowBand& band) : band_(band), of_brick_(band.grid().size()) {}
  template <class Body>
  void add(int layer, Body&& body) {
    const auto [first, last] = band_.layers()[layer];
    for (size_t b = first; b < last; ++b) of_brick_[b] = body(band_.first_row(b), band_.first_row(b + 1));
  }
  /// Of all layers, whichever rank added them.
  double total() {
    if (const Slabs* slabs = band_.slabs())
      bring_all(slabs->ranks(), slabs->parts([&](Layers layers) { return bricks_of(band_.grid(), layers); }),
                {{of_brick_.data(), sizeof(double)}});
    return ordered_sum(band_.grid(), of_brick_);
  }

 private:
  const NarrowBand& band_;
  std::vector<double> of_brick_;
};

/// visit(vertex, index into an array over the band) for a brick's vertices, in the order of rows.
template <class Visit>
void for_each_vertex_of(const NarrowBand& band, size_t brick, Visit&& visit) {
  for (uint32_t r = band.first_row(brick); r < band.first_row(brick + 1); ++r)
    for (int x = 0; x < brick_side; ++x)
      if (band.mask(r) >> x & 1)
        visit(band.grid().first_vertex(brick) + Vec3i{x, band.place(r) & 7, band.place(r) >> 3},
              size_t{r} * brick_side + static_cast<size_t>(x));
}

/// The same for all bricks.
template <class Visit>
void for_each_vertex(const NarrowBand& band, Visit&& visit) {
  for (size_t b = 0; b < band.grid().size(); ++b) for_each_vertex_of(band, b, visit);
}

/// A value of an array over the band at a vertex, or `otherwise` where that is not in the band.
inline float value_at(const NarrowBand& band, const RowArray& values, Vec3i v, float otherwise) {
  const uint32_t row = band.row(band.grid().find(brick_of(v)), v.y & 7, v.z & 7);
  return band.mask(row) >> (v.x & 7) & 1 ? values.data()[size_t{row} * brick_side + static_cast<size_t>(v.x & 7)]
                                         : otherwise;
}

/// out = weight_v v + weight_g G v; G is the band's graph Laplacian, positive semi-definite: (G v)_i = sum over
/// neighbors j in the band of v_i - v_j. Its null space are the constants on connected parts. Returns <G v, out>. Of a
/// band in slabs on the layers at hand, and the sum is of no use.
double apply_laplacian(const NarrowBand& band, const RowArray& v, float weight_v, float weight_g, RowArray& out,
                       const Context& context);

}  // namespace soapfilm
