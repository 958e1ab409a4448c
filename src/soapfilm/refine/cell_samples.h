// The samples of a cell as one: what the fit sees of them, however many there are.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "soapfilm/field/samples.h"
#include "soapfilm/grid/trilinear.h"
#include "soapfilm/refine/narrow_band.h"

namespace soapfilm {

/// Where each sample lies in the band.
struct BandSamples {
  std::vector<uint32_t> cell_row;  ///< row of its cell's lowest vertex; 0: a corner of its cell is not in the band
  std::vector<uint8_t> cell_x;     ///< and x in that row, 0..7
};

/// Finds the cells. Eight corners of a cell in the band: the sample can be seen by it.
BandSamples locate(const GridSamples& samples, const NarrowBand& band, const Parallel& parallel);

/// What samples weigh, beside each one's own weight.
struct DataWeights {
  float normal = 0;
  float slope = 0;
};

/// What a sample says: its weight, and its unit outward normal.
struct WeighedSample {
  float weight = 0;
  Vec3f normal;
};

/// Samples merged by cell: weighted means of their positions and of their unit outward normals, and the sums of their
/// weights. The quadratic data term over the cells, phi trilinear in each (phi > 0 inside: its gradient is minus the
/// normal), with v and s of DataWeights:
///   sum_c w_c (phi(p_c)^2 + v |g_c - n_c (n_c g_c)|^2 + s (n_c g_c)^2),  g_c = grad phi(p_c) + n_c.
struct CellSamples {
  std::vector<CellRow> rows;    ///< of eight cells, in the order of the band's rows
  std::vector<uint32_t> row;    ///< the band's row of each one's lowest corners
  std::vector<uint32_t> first;  ///< first row of each brick of samples; one more at the end
  std::vector<size_t> layer;    ///< first row of each layer of bricks along z; one more at the end
  size_t count = 0;             ///< cells that hold a sample of weight > 0
  size_t doubted = 0;           ///< samples of weight < 1/4, those that the band does not see included
  DataWeights weights;
};

/// The rows of cells that hold samples which the band sees; no weights as yet.
CellSamples cells_of(const GridSamples& samples, const BandSamples& where, const NarrowBand& band,
                     const Parallel& parallel);

/// Merges samples into `cells`, in place of what these held: weigh(s).weight times 1 for the position and `weights` for
/// the normal. weigh() is called once for each sample that the band sees, from any thread.
void merge(const GridSamples& samples, const BandSamples& where, const NarrowBand& band,
           const std::function<WeighedSample(size_t)>& weigh, DataWeights weights, const Parallel& parallel,
           CellSamples& cells);

/// Value and gradient of phi at a sample.
using Jet = FieldJet<float>;
/// Of a field on the band; zero where the band does not see the sample.
Jet jet_at_sample(const RowArray& phi, const GridSamples& samples, const BandSamples& where, const NarrowBand& band,
                  size_t sample);
/// At every sample.
std::vector<Jet> jets_at_samples(const RowArray& phi, const GridSamples& samples, const BandSamples& where,
                                 const NarrowBand& band, const Parallel& parallel);

/// out += scale times the data term's Hessian (half of it) times v, or with `affine` its gradient (half of it) at v.
/// Returns scale <v, H v> without `affine`.
double add_data_term(const NarrowBand& band, const CellSamples& data, const RowArray& v, bool affine, float scale,
                     RowArray& out, const Parallel& parallel);

/// out += the row sums of the positions' part of the data term: what it weighs on smooth functions.
void add_position_weights(const NarrowBand& band, const CellSamples& data, RowArray& out, const Parallel& parallel);

}  // namespace soapfilm
