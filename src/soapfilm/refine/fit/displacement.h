// The smooth displacement that moves a level set onto the samples: a linear system, solved matrix-free.
#pragma once

#include <algorithm>

#include "soapfilm/context.h"
#include "soapfilm/refine/fit/cell_samples.h"
#include "soapfilm/refine/fit/multilevel.h"
#include "soapfilm/refine/fit/narrow_band.h"

namespace soapfilm {

/// Weights of the two smoothness terms against one sample; lattice units.
struct Smoothness {
  float slope = 0;      ///< beta, of |grad delta|^2
  float curvature = 0;  ///< gamma, of |laplacian (phi0 + delta)|^2
};

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
  Displacement(const NarrowBand& band, const RowArray& phi0, const Context& context);

  /// Builds the preconditioner from the positions and their weights, which may change a little before it is rebuilt.
  void precondition(const CellSamples& data, Smoothness smoothness);
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
  void reweight_curvature(double medians);
  /// Undoes that: the same gamma everywhere and no target.
  void reset_curvature_weights();
  /// Keeps the weights s and sets the target to 0.
  void drop_target() { std::fill_n(target_.data(), target_.size(), 0.0f); }

  const NarrowBand& band() const { return band_; }
  const RowArray& phi() const { return phi_; }
  RowArray& phi() { return phi_; }

 private:
  void residual(const CellSamples& data, Smoothness smoothness);
  /// The next conjugate direction z + ratio direction, z in scratch_ (whose array it takes over where ratio is 0);
  /// returns <direction, A direction>. A direction is in image_ afterwards, except in the last step, which does not
  /// need it.
  double search_direction(const CellSamples& data, Smoothness smoothness, float ratio, bool last);
  /// The kernel of that name on a layer of bricks.
  void laplacian(const LaplacianJob& job, int layer) const;

  const NarrowBand& band_;
  const Context& context_;
  Multilevel multilevel_;
  const RowArray& phi0_;
  RowArray phi_;
  RowArray residual_, direction_, image_, scratch_;
  RowArray share_;   // s: the factor of gamma, in (0, 1]
  RowArray target_;  // for laplacian phi inside the band
};

}  // namespace soapfilm
