// The samples of a cell as one: what the fit sees of them, however many there are.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "soapfilm/field/samples.h"
#include "soapfilm/grid/trilinear.h"
#include "soapfilm/refine/narrow_band.h"
#include "soapfilm/kernels/robust.h"

namespace soapfilm {

/// What samples weigh, beside each one's own weight.
struct DataWeights {
  float normal = 0;
  float slope = 0;
};

/// How the samples themselves are weighed: robust_weight() of the distance from the level set 0 of phi, |value| over
/// slope; 0 unless seen_from_outside().
struct Weighing {
  Penalty penalty = Penalty::least_squares;
  float scale = 1;                  ///< of the penalty, voxels, > 0
  bool directions = true;           ///< a sample's unit normal is along its direction; otherwise along -grad phi there
  std::span<const uint8_t> active;  ///< 0 leaves a sample out; may be empty: none is
};

/// What samples in a cell say together: means weighted by the samples', and the sum of their weights.
struct MergedCell {
  Vec3f fraction;  ///< place in the cell, in [0, 1]
  Vec3f normal;    ///< shorter than a unit vector where the samples' differ
  float weight = 0;
};

/// Samples merged by cell. A sample is seen by the band where all eight corners of its cell are in it; cells that hold
/// none of these are left out. The quadratic data term over the cells, phi trilinear in each (phi > 0 inside: its
/// gradient is minus the normal), with v and s of DataWeights:
///   sum_c w_c (phi(p_c)^2 + v |g_c - n_c (n_c g_c)|^2 + s (n_c g_c)^2),  g_c = grad phi(p_c) + n_c.
class CellSamples {
 public:
  CellSamples() = default;
  /// The cells that hold samples which the band sees; weightless as yet.
  CellSamples(const GridSamples& samples, const NarrowBand& band, const Context& context);

  /// Rows of cells: those with the same y and z in a brick, in the order of the band's rows.
  size_t rows() const { return row_.size(); }
  uint32_t band_row(size_t row) const { return row_[row]; }    ///< of its lowest corners
  uint8_t present(size_t row) const { return present_[row]; }  ///< which of the eight are there, as bits
  MergedCell cell(size_t row, int x) const;                    ///< one that is there
  void set_weight(size_t row, int x, float weight);
  /// Rows of the cells of brick b of the samples: [first, second).
  std::pair<size_t, size_t> brick(size_t b) const { return {brick_[b], brick_[b + 1]}; }

  size_t count = 0;    ///< cells that hold a sample of weight > 0
  size_t doubted = 0;  ///< samples of weight < 1/4, those that the band does not see included
  DataWeights weights;

 private:
  friend void merge(const RowArray& phi, const GridSamples& samples, const NarrowBand& band, const Weighing& weighing,
                    DataWeights weights, const Context& context, CellSamples& cells);
  friend class DataTerm;

  float* values(size_t row) { return values_.data() + DataJob::values * size_t{first_[row]}; }
  const float* values(size_t row) const { return values_.data() + DataJob::values * size_t{first_[row]}; }

  std::vector<uint32_t> row_;     // of the band
  std::vector<uint8_t> present_;  // of each row
  std::vector<uint32_t> first_;   // cells before each row; one more at the end
  std::vector<uint32_t> brick_;   // first row of each brick of samples; one more at the end
  std::vector<size_t> layer_;     // first row of each layer of bricks along z; one more at the end
  AlignedArray<float> values_;    // as DataJob has them
};

/// Value and gradient of phi at a sample.
using Jet = FieldJet<float>;

/// Merges samples into `cells`, in place of what these held: their weights times 1 for the position and `weights` for
/// the normal.
void merge(const RowArray& phi, const GridSamples& samples, const NarrowBand& band, const Weighing& weighing,
           DataWeights weights, const Context& context, CellSamples& cells);

/// Of a field on the band, at every sample that it sees.
std::vector<std::optional<Jet>> jets_at_samples(const RowArray& phi, const GridSamples& samples,
                                                const CellSamples& cells, const NarrowBand& band,
                                                const Context& context);

/// What the data term adds to a system of equations: layer of bricks by layer, or all at once. It keeps looking at what
/// it is given, which merge() must not change meanwhile.
class DataTerm {
 public:
  /// out += scale times its gradient (half of it) at v.
  static DataTerm gradient(const NarrowBand& band, const CellSamples& data, const RowArray& v, float scale,
                           RowArray& out);
  /// out += its Hessian (half of it) times v; null: nothing is added anywhere, only the energy worked out.
  static DataTerm hessian(const NarrowBand& band, const CellSamples& data, const RowArray& v, RowArray* out);
  /// out += the row sums of the positions' part of that: what it weighs on smooth functions.
  static DataTerm row_sums(const NarrowBand& band, const CellSamples& data, RowArray& out);

  /// The cells of a layer, in order: they touch vertices of this layer and of the next. A Hessian's <v, H v>.
  double add(int layer) const;
  /// All of them, even layers before odd ones.
  double add(const Context& context) const;

 private:
  DataTerm(const NarrowBand& band, const CellSamples& data, const RowArray* v, bool affine, float scale, RowArray* out);

  const NarrowBand& band_;
  const CellSamples& data_;
  DataJob job_{};
};

}  // namespace soapfilm
