// The displacement's system by loops over rows, layers of bricks at a time, so that one pass finds in the cache what
// the one before it wrote.
#pragma once

#include "soapfilm/refine/fit/band_solver.h"
#include "soapfilm/refine/fit/multilevel.h"

namespace soapfilm {

class CpuBandSolver : public BandSolver {
 public:
  CpuBandSolver(const NarrowBand& band, const RowArray& phi0, const Context& context);

  RowArray& phi() override { return phi_; }
  void precondition(const CellSamples& data, Smoothness smoothness) override;
  void start(const CellSamples& data, Smoothness smoothness) override;
  double preconditioned() override;
  double search_direction(const CellSamples& data, Smoothness smoothness, float ratio, bool last) override;
  /// The next preconditioned() takes the step, in its first pass.
  void step(float length, bool last) override;
  void reweight_curvature(double medians) override;
  void reset_curvature_weights() override;
  void drop_target() override;

 protected:
  /// The kernel of that name on a layer of bricks.
  void laplacian(const LaplacianJob& job, int layer) const;

  const NarrowBand& band_;
  const Context& context_;
  Multilevel multilevel_;
  const RowArray& phi0_;
  RowArray phi_;
  RowArray residual_, direction_;
  RowArray image_;    // A d, and work between
  RowArray scratch_;  // z, and work between
  RowArray share_;    // s: the factor of gamma, in (0, 1]
  RowArray target_;   // for laplacian phi inside the band
  float step_ = 0;    // not taken yet
};

}  // namespace soapfilm
