// A multigrid preconditioner on a narrow band: V-cycles of a second-order root of the fourth-order system. Coarse
// vertex I lies on fine vertex 2 I; transfers are trilinear.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "soapfilm/refine/fit/narrow_band.h"

namespace soapfilm {

/// A band of the half-resolution grid that contains all vertices needed for interpolation to the finer band.
class CoarseBand {
 public:
  CoarseBand() = default;
  /// `fine` must outlive this; it may be moved.
  CoarseBand(const NarrowBand& fine, const Context& context);

  const NarrowBand& band() const { return band_; }
  /// coarse = P^T from, which is 0 outside the fine band. In slabs what is at hand of `from` must be up to date, and of
  /// `coarse` is.
  void restrict_to(const RowArray& from, RowArray& coarse, const Context& context) const;
  /// coarse += P^T from of a layer of fine bricks along z. Neighboring layers add to common rows: see EvenOddStage.
  void restrict_layer(int layer, const RowArray& from, RowArray& coarse) const;
  /// The same for the residual of RowKernel::restrict_residual(), with the same `fine`.
  void restrict_residual(int layer, const NarrowBand& fine, const CycleJob& job, RowArray& coarse) const;
  /// Of a sum over the layers at hand, complete for what a rank's slab covers: brings what is at hand of the coarse
  /// band.
  void collect(RowArray& coarse) const;
  /// out = inverse b + P x where inverse > 0, elsewhere 0, on a layer of fine bricks along z, with the same `fine`; x
  /// is coarse.
  void prolong_onto(int layer, const NarrowBand& fine, const CycleJob& job) const;

 private:
  /// `parent`: the coarse brick that holds the fine one's first vertex.
  BrickTransfer make_transfer(const NarrowBand& fine, size_t brick, int32_t parent) const;
  std::span<const BrickTransfer> of_layer(int layer) const {
    const auto z = static_cast<size_t>(layer);
    return std::span(transfers_).subspan(first_transfer_[z], first_transfer_[z + 1] - first_transfer_[z]);
  }

  NarrowBand band_;
  std::vector<BrickTransfer> transfers_;   ///< of the fine bricks that have rows; they refer to the fine band
  std::vector<size_t> first_transfer_;     ///< of each layer of fine bricks along z
  LayerRange fine_layers_ = 0;             ///< at hand
  std::shared_ptr<const Slabs> complete_;  ///< the slabs for whose coarse layers ranks have complete sums; null: all
};

/// An approximate inverse, symmetric positive definite, of A = data + beta G + gamma G^2: two V-cycles, one after the
/// other, of K = sqrt(gamma) G + sqrt(d) + beta / (2 sqrt(gamma)), so that K^2 is about A; d are the row sums of the
/// positions' part of the data term. (For G^2 itself trilinear functions are too rough. The slopes' part matters only
/// across the band, where it is about as large as gamma G^2.) A coarse level's K has the weight of the fine vertices
/// that it represents, its extent P^T 1. One damped Jacobi step before and one after each coarse correction. Where
/// sqrt(d) is small relative to 6 sqrt(gamma), as under noise, the finest level omits it, and its steps have one
/// length: half as much to read, and coarser levels take the positions into account.
class Multilevel {
 public:
  Multilevel(const NarrowBand& fine, const Context& context);

  /// gamma > 0.
  void set_operator(const RowArray& position_weights, float beta, float gamma, const Context& context);
  /// mean = `scale` times the weighted mean of values / weights over the vertices around (variance 3 voxels^2 along
  /// each axis) where `where` is positive, elsewhere 0; `values` hold weight times value. First calls complete(layer),
  /// a stage of layer_by_layer(), which may still write values, weights and `where`. Returns false, and does nothing,
  /// where the band is too small for a coarse one.
  bool local_mean(const std::function<void(int)>& complete, const RowArray& values, const RowArray& weights,
                  const RowArray& where, float scale, RowArray& mean, const Context& context);
  /// Returns <r, z>; `work` is overwritten. complete(layer), a stage of layer_by_layer() that completes r, may still
  /// read it.
  double apply(const std::function<void(int)>& complete, const RowArray& r, RowArray& z, RowArray& work,
               const Context& context);

 private:
  struct Coarse {
    CoarseBand coarse;
    RowArray extent;      ///< P^T 1: number of fine vertices that a coarse one represents
    RowArray inverse;     ///< as CycleJob has it
    RowArray b, x, work;  ///< right side, solution
  };
  const NarrowBand& band(size_t level) const { return level == 0 ? fine_ : coarse_[level - 1].coarse.band(); }
  bool weigh_little(const RowArray& position_weights) const;
  void set_inverse(size_t level, const RowArray& weights, const Context& context);
  CycleJob job(size_t level, const RowArray& b) const;
  /// A V-cycle from level 1 on: x is about K^-1 b.
  void solve(size_t level, const RowArray& b, RowArray& work, RowArray& x, const Context& context);
  double solve_coarsest(const RowArray& b, RowArray& work, RowArray& x, const RowArray* weight, const Context& context);
  /// The rest of it once the coarser right side is complete. `after`: stages that may read x, and add to that right
  /// side, which has been reset to 0 by then.
  template <class... Stages>
  double correct(size_t level, const RowArray& b, RowArray& work, RowArray& x, const RowArray* weight,
                 const Context& context, Stages&&... after);

  const NarrowBand& fine_;
  RowArray inverse_, work_;
  std::vector<Coarse> coarse_;  ///< levels 1, 2, ...
  float diffusion_ = 0;         ///< sqrt(gamma)
  float reaction_ = 0;          ///< beta / (2 sqrt(gamma))
  bool even_ = false;           ///< whether Jacobi steps of the finest level have the same length everywhere
};

}  // namespace soapfilm
