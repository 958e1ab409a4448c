// The samples of a cell merged into one: the cost of the fit does not depend on the number of samples.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "soapfilm/field/samples.h"
#include "soapfilm/grid/trilinear.h"
#include "soapfilm/kernels/robust.h"
#include "soapfilm/refine/fit/narrow_band.h"

namespace soapfilm {

/// Weights of the terms of the data term, next to each sample's own weight.
struct DataWeights {
  float normal = 0;
  float slope = 0;
};

/// How samples are weighted: robust_weight() of the distance from the level set 0 of phi, |value| over slope; 0 unless
/// seen_from_outside().
struct Weighing {
  Penalty penalty = Penalty::least_squares;
  float scale = 1;                  ///< of the penalty function, voxels, > 0
  bool directions = true;           ///< a sample's unit normal is along its direction; otherwise along -grad phi there
  std::span<const uint8_t> active;  ///< 0 excludes a sample; may be empty: all are used
};

/// The mean of the samples in a cell, weighted by their weights, and the sum of these.
struct MergedCell {
  Vec3f fraction;  ///< place in the cell, in [0, 1]
  Vec3f normal;    ///< shorter than a unit vector where the samples' differ
  float weight = 0;
};

/// Samples merged by cell. A sample is used where all eight corners of its cell are in the band; cells without such
/// samples are not stored. The quadratic data term over the cells, phi trilinear in each (phi > 0 inside: its gradient
/// is minus the normal), with v and s of DataWeights:
///   sum_c w_c (phi(p_c)^2 + v (|g_c|^2 - (n_c g_c)^2) + s (n_c g_c)^2),  g_c = grad phi(p_c) + n_c.
class CellSamples {
 public:
  CellSamples() = default;
  /// The cells that hold samples inside the band; all weights are 0 at first.
  CellSamples(const GridSamples& samples, const NarrowBand& band, const Context& context);

  /// Rows of cells: those with the same y and z in a brick, in the order of the band's rows.
  size_t rows() const { return row_.size(); }
  uint32_t band_row(size_t row) const { return row_[row]; }    ///< the band's row that holds its lowest corners
  uint8_t present(size_t row) const { return present_[row]; }  ///< which of the eight exist, as bits
  MergedCell cell(size_t row, int x) const;                    ///< of a cell that exists
  void set_weight(size_t row, int x, float weight);
  size_t bricks() const { return coord_.size(); }  ///< of the samples
  Vec3i coord(size_t brick) const { return coord_[brick]; }
  /// Rows of the cells of brick b of the samples: [first, second).
  std::pair<size_t, size_t> brick(size_t b) const { return {brick_[b], brick_[b + 1]}; }

  size_t count = 0;    ///< cells that hold a sample of weight > 0
  size_t doubted = 0;  ///< samples of weight < 1/4, including those outside the band
  DataWeights weights;

 private:
  friend void merge(const RowArray& phi, const GridSamples& samples, const NarrowBand& band, const Weighing& weighing,
                    DataWeights weights, const Context& context, CellSamples& cells);
  friend class DataTerm;

  float* values(size_t row) { return values_.data() + DataJob::values * size_t{first_[row]}; }
  const float* values(size_t row) const { return values_.data() + DataJob::values * size_t{first_[row]}; }

  std::vector<uint32_t> row_;     // row of the band
  std::vector<uint8_t> present_;  // which cells of each row exist
  std::vector<uint32_t> first_;   // cells before each row; one more at the end
  std::vector<uint32_t> brick_;   // first row of each brick of samples; one more at the end
  std::vector<size_t> layer_;     // first of these bricks of each layer along z; one more at the end
  std::vector<Vec3i> coord_;      // of these bricks
  AlignedArray<float> values_;    // in the layout of DataJob
};

/// Value and gradient of phi at a sample.
using Jet = FieldJet<float>;

/// Merges samples into `cells`, replacing their contents: the samples' weights times 1 for the position and times
/// `weights` for the normal.
void merge(const RowArray& phi, const GridSamples& samples, const NarrowBand& band, const Weighing& weighing,
           DataWeights weights, const Context& context, CellSamples& cells);

/// Value and gradient of a function on the band, at every sample inside it.
std::vector<std::optional<Jet>> jets_at_samples(const RowArray& phi, const GridSamples& samples,
                                                const CellSamples& cells, const NarrowBand& band,
                                                const Context& context);

/// What the data term adds to a system of equations: by layers of bricks, or all at once. It keeps references to its
/// arguments; merge() must not change `data` while it is in use.
class DataTerm {
 public:
  /// out += scale times its gradient (half of it) at v.
  static DataTerm gradient(const NarrowBand& band, const CellSamples& data, const RowArray& v, float scale,
                           RowArray& out);
  /// out += its Hessian (half of it) times v; out null: only the energy is computed.
  static DataTerm hessian(const NarrowBand& band, const CellSamples& data, const RowArray& v, RowArray* out);
  /// out += the row sums of the positions' part of the Hessian: its weight on smooth functions.
  static DataTerm row_sums(const NarrowBand& band, const CellSamples& data, RowArray& out);

  /// A part of <v, H v> for each brick of samples, of a Hessian; and their sum (ordered_sum).
  std::vector<double> make_energies() const { return std::vector<double>(data_.coord_.size()); }
  double total(std::vector<double>& energies) const;

  /// Adds the cells of a layer, in order; they touch vertices of this layer and of the next.
  void add(int layer, std::vector<double>* energies = nullptr) const;
  /// Adds all layers, even ones before odd ones. Returns <v, H v> of a Hessian.
  double add(const Context& context) const;

 private:
  DataTerm(const NarrowBand& band, const CellSamples& data, const RowArray* v, bool affine, float scale, RowArray* out);

  const NarrowBand& band_;
  const CellSamples& data_;
  DataJob job_{};
};

}  // namespace soapfilm
