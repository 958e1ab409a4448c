// The samples of a cell as one: what the fit sees of them, however many there are.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "soapfilm/field/samples.h"
#include "soapfilm/refine/narrow_band.h"

namespace soapfilm {

/// Where each sample lies in the band, and what it weighs.
struct BandSamples {
  std::vector<uint32_t> cell_row;  ///< row of its cell's lowest vertex; 0: a corner of its cell is not in the band
  std::vector<uint8_t> cell_x;     ///< and x in that row, 0..7
};

/// Finds the cells. Eight corners of a cell in the band: the sample can be seen by it.
BandSamples locate(const GridSamples& samples, const NarrowBand& band, const Parallel& parallel);

/// Merged samples of one cell: their weighted means, and the sums of their weights.
struct CellSample {
  Vec3f fraction;           ///< mean position in the cell, each in [0, 1]
  float weight = 0;         ///< of the position
  Vec3f normal;             ///< mean unit outward normal
  float normal_weight = 0;  ///< of the normal's direction
  float slope_weight = 0;   ///< of the slope along the normal
};

/// The quadratic data term over the cells, phi trilinear in each (phi > 0 inside: its gradient is minus the normal):
///   sum_c w_c phi(p_c)^2 + v_c |g_c - n_c (n_c g_c)|^2 + s_c (n_c g_c)^2,  g_c = grad phi(p_c) + n_c.
struct CellSamples {
  /// Weights of the cell's corners for the value and for the derivative along the normal.
  struct Stencil {
    std::array<float, 8> value, along;
  };
  std::vector<CellSample> cells;  ///< in the order of (row, x)
  std::vector<Stencil> stencil;
  std::vector<uint8_t> x;
  std::vector<uint32_t> begin;                  ///< row r's cells are [begin[r], begin[r + 1])
  std::array<std::vector<uint32_t>, 8> colors;  ///< bricks that hold cells, by the parity of their coordinates
};

/// What samples weigh, beside each one's own weight.
struct DataWeights {
  float normal = 0;
  float slope = 0;
};

/// Merges samples: weight[s] times 1 for the position and `weights` for its unit normal. Samples that are out of the
/// band or of weight 0 are left out.
CellSamples merge(const GridSamples& samples, const BandSamples& where, const NarrowBand& band,
                  std::span<const float> weight, std::span<const Vec3f> normal, DataWeights weights,
                  const Parallel& parallel);

/// Value and gradient of phi at a sample (per voxel).
struct Jet {
  float value = 0;
  Vec3f gradient;
};
/// At every sample that the band sees, zero at others; of a field on the band.
std::vector<Jet> jets_at_samples(const RowArray& phi, const GridSamples& samples, const BandSamples& where,
                                 const NarrowBand& band, const Parallel& parallel);

/// out += the data term's Hessian (half of it) times v; with `affine` its gradient (half of it) at v.
void add_data_term(const NarrowBand& band, const CellSamples& data, const RowArray& v, bool affine, RowArray& out,
                   const Parallel& parallel);

/// out += an upper bound of the Hessian's (half of it) row sums: the diagonal for preconditioning.
void add_data_diagonal(const NarrowBand& band, const CellSamples& data, RowArray& out, const Parallel& parallel);

}  // namespace soapfilm
