// The smooth displacement that moves a level set onto the samples: a linear system, solved matrix-free.
#pragma once

#include <algorithm>

#include "soapfilm/context.h"
#include "soapfilm/refine/cell_samples.h"
#include "soapfilm/refine/multilevel.h"
#include "soapfilm/refine/narrow_band.h"

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

/// Minimises, over delta on the band,
///   E = data term of CellSamples (phi) + beta <delta, G delta> + gamma <G delta - k, s (G delta - k)>,
/// phi = phi0 + delta, k = laplacian phi0 less its target, along the axes on which both neighbors are in the band (on
/// the others delta alone is kept from sloping, so that the band's rim pulls nothing, and bends of phi0 along the rim
/// do not stay), s = 1 and the target 0 until yield_to_bends(). Conjugate gradients, multigrid preconditioner.
class Displacement {
 public:
  Displacement(const NarrowBand& band, const RowArray& phi0, const Context& context);

  /// Fits the preconditioner to the positions and their weights, which may change a little before it is fitted again.
  void precondition(const CellSamples& data, Smoothness smoothness);
  /// Starts from the present state; returns the number of iterations. Once preconditioned.
  int minimize(const CellSamples& data, Smoothness smoothness, const SolveLimits& limits);

  /// What the next solves expect of the curvature c = laplacian phi, from the present surface. Its target c1 is a share
  /// of the mean of c over the vertices around (within about two voxels) that yield little: bends that go on, as on a
  /// limb, are not pulled flat. Where the surface bends otherwise the weight falls to gamma / (1 + (d / d0)^2), d^2 the
  /// mean around of (c - c1)^2 + (k1 - k2)^2, k1 and k2 the principal curvatures, and d0 that many times the median of
  /// d over the band: without the mean each vertex would be free to follow the noise that bent it, and of a surface's
  /// three second derivatives c alone is one: too few to tell bends from noise so near by. Away from the surface, where
  /// a near fold of it bends phi, the weight falls as well; the band's rim keeps the target 0.
  void yield_to_bends(double medians);
  /// The same gamma everywhere and no target, as at first.
  void stiffen();
  /// Keeps what yields and drops the target.
  void drop_target() { std::fill_n(target_.data(), target_.size(), 0.0f); }

  const NarrowBand& band() const { return band_; }
  const RowArray& phi() const { return phi_; }
  RowArray& phi() { return phi_; }

 private:
  void residual(const CellSamples& data, Smoothness smoothness);
  /// The next conjugate direction z + ratio direction, z in scratch_, whose array it takes over where ratio is 0;
  /// returns <direction, A direction>. A direction is image_ afterwards, unless this is the last step, which has no use
  /// for it.
  double turn(const CellSamples& data, Smoothness smoothness, float ratio, bool last);
  /// The kernel of that name on a layer of bricks.
  double laplacian(const LaplacianJob& job, int layer) const;

  const NarrowBand& band_;
  const Context& context_;
  Multilevel multilevel_;
  const RowArray& phi0_;
  RowArray phi_;
  RowArray residual_, direction_, image_, scratch_;
  RowArray share_;   // of gamma, in (0, 1]
  RowArray target_;  // of laplacian phi inside the band
};

}  // namespace soapfilm
