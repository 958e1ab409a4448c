// A multilevel preconditioner on a narrow band (Bramble, Pasciak and Xu 1990): the sum over the levels of a diagonal
// scaling, carried to and fro by trilinear interpolation. Coarse vertex I lies on fine vertex 2 I.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "soapfilm/refine/narrow_band.h"

namespace soapfilm {

/// A band of every second vertex that holds all that interpolation to the finer band asks for.
class CoarseBand {
 public:
  CoarseBand(const NarrowBand& fine, const Parallel& parallel);

  const NarrowBand& band() const { return band_; }
  /// coarse = P^T fine.
  void restrict_to(const NarrowBand& fine, const RowArray& from, RowArray& coarse, const Parallel& parallel) const;
  /// fine += P coarse at the band's vertices.
  void prolong_add(const NarrowBand& fine, const RowArray& coarse, RowArray& to, const Parallel& parallel) const;

 private:
  NarrowBand band_;
  std::vector<int32_t> parent_;                    ///< brick that holds a fine brick's first vertex
  std::vector<std::array<int32_t, 27>> children_;  ///< fine bricks around 2 B, by neighbor_slot()
};

/// An approximate inverse, symmetric positive definite, of A = data + beta G + gamma G^2: z = D^-1 r + P C M C P^T r. D
/// is A's diagonal on the band, M the mass P^T P, lumped, and C the sum over the coarse levels of P_l D_l^-1 P_l^T with
/// D_l the diagonal on level l of K = sqrt(gamma) G + sqrt(data) + beta / (2 sqrt(gamma)), so that K^2 is about A:
/// trilinear functions suit the second-order K, for G^2 itself they are too rough.
class Multilevel {
 public:
  Multilevel(const NarrowBand& fine, const Parallel& parallel);

  /// `data_diagonal` bounds the data term's row sums; gamma > 0.
  void set_operator(const RowArray& data_diagonal, float beta, float gamma, const Parallel& parallel);
  void apply(const RowArray& r, RowArray& z, const Parallel& parallel);

 private:
  void apply_root(const Parallel& parallel);

  const NarrowBand& fine_;
  std::vector<CoarseBand> levels_;  ///< 1, 2, ...
  std::vector<RowArray> extent_;    ///< P_l^T 1 of each coarse level: fine vertices that a coarse one speaks for
  std::vector<RowArray> inverse_;   ///< D_l^-1, from level 0
  std::vector<RowArray> residual_;  ///< of each coarse level
};

}  // namespace soapfilm
