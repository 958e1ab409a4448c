// The smooth displacement that moves a level set onto the samples: a linear system, solved matrix-free.
#pragma once

#include <memory>

#include "soapfilm/context.h"
#include "soapfilm/refine/fit/band_solver.h"

namespace soapfilm {

struct SolveLimits {
  int iterations = 12;
  double tolerance = 0.15;  ///< of the residual, in the preconditioner's norm, relative to the first one: the step that
                            ///< starts below it is the last
};

/// Minimizes, over delta on the band,
///   E = data term of CellSamples (phi) + beta <delta, G delta> + gamma <G delta - k, s (G delta - k)>,
/// phi = phi0 + delta, k = laplacian phi0 minus its target, along the axes on which both neighbors are in the band. (On
/// the others only the slope of delta is penalized, so that the band boundary exerts no force and curvature of phi0
/// along it does not stay.) s = 1 and the target is 0 until reweight_curvature(). Conjugate gradients, multigrid
/// preconditioner.
class Displacement {
 public:
  Displacement(const NarrowBand& band, const RowArray& phi0, const Context& context)
      : band_(band), solver_(band_solver(band, phi0, context)) {}

  /// Builds the preconditioner from the positions and their weights, which may change a little before it is rebuilt.
  void precondition(const CellSamples& data, Smoothness smoothness) { solver_->precondition(data, smoothness); }
  /// Starts from the present phi; returns the number of iterations. Call precondition() before.
  int minimize(const CellSamples& data, Smoothness smoothness, const SolveLimits& limits);

  /// Edge-preserving reweighting: sets, from the present surface, how the next solves penalize the curvature c =
  /// laplacian phi. Its target c1 is a fraction of the mean of c over nearby vertices (within about two voxels),
  /// weighted by their weights s: curvature that continues, as on a limb, is not flattened. Where the curvature differs
  /// from that, the weight falls to gamma / (1 + (d / d0)^2), d^2 the local mean of (c - c1)^2 + (k1 - k2)^2, k1 and k2
  /// the principal curvatures, and d0 = `medians` times the median of d over the band. Without the mean each vertex
  /// could follow the noise that curved it, and c is only one of a surface's three second derivatives: too few to
  /// distinguish edges from noise so locally. Away from the surface, where phi is curved by a fold nearby, the weight
  /// falls as well; at the band boundary the target stays 0.
  void reweight_curvature(double medians) { solver_->reweight_curvature(medians); }
  /// Undoes that: the same gamma everywhere and no target.
  void reset_curvature_weights() { solver_->reset_curvature_weights(); }
  /// Keeps the weights s and sets the target to 0.
  void drop_target() { solver_->drop_target(); }

  const NarrowBand& band() const { return band_; }
  const RowArray& phi() const { return solver_->phi(); }
  RowArray& phi() { return solver_->phi(); }

 private:
  const NarrowBand& band_;
  std::shared_ptr<BandSolver> solver_;
};

}  // namespace soapfilm
