// The samples of a cell as one: what the fit sees of them, however many there are.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "soapfilm/field/samples.h"
#include "soapfilm/grid/trilinear.h"
#include "soapfilm/refine/narrow_band.h"

namespace soapfilm {

/// Where each sample lies in the band, and what it weighs.
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

/// Samples merged by cell: weighted means of their positions and of their unit outward normals, and the sums of their
/// weights. The quadratic data term over the cells, phi trilinear in each (phi > 0 inside: its gradient is minus the
/// normal), with v and s of DataWeights:
///   sum_c w_c (phi(p_c)^2 + v |g_c - n_c (n_c g_c)|^2 + s (n_c g_c)^2),  g_c = grad phi(p_c) + n_c.
struct CellSamples {
  std::vector<CellRow> rows;  ///< of eight cells, in the order of the band's rows
  std::vector<uint32_t> row;  ///< the band's row of each one's lowest corners
  std::vector<size_t> layer;  ///< first row of each layer of bricks along z; one more at the end
  size_t count = 0;           ///< cells that hold a sample
  DataWeights weights;
};

/// Merges samples: weight[s] times 1 for the position and `weights` for its unit normal. Samples that are out of the
/// band or of weight 0 are left out. The memory of an `old` one is used again.
CellSamples merge(const GridSamples& samples, const BandSamples& where, const NarrowBand& band,
                  std::span<const float> weight, std::span<const Vec3f> normal, DataWeights weights,
                  const Parallel& parallel, CellSamples old = {});

/// Value and gradient of phi at a sample.
using Jet = FieldJet<float>;
/// At every sample that the band sees, zero at others; of a field on the band.
std::vector<Jet> jets_at_samples(const RowArray& phi, const GridSamples& samples, const BandSamples& where,
                                 const NarrowBand& band, const Parallel& parallel);

/// out += scale times the data term's Hessian (half of it) times v, or with `affine` its gradient (half of it) at v.
/// Returns scale <v, H v> without `affine`.
double add_data_term(const NarrowBand& band, const CellSamples& data, const RowArray& v, bool affine, float scale,
                     RowArray& out, const Parallel& parallel);

/// out += the row sums of the positions' part of the data term: what it weighs on smooth functions.
void add_position_weights(const NarrowBand& band, const CellSamples& data, RowArray& out, const Parallel& parallel);

}  // namespace soapfilm
