// The smooth displacement that moves a level set onto the samples: a linear system, solved matrix-free.
#pragma once

#include <algorithm>

#include "soapfilm/core/parallel.h"
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
/// phi = phi0 + delta, k = laplacian phi0 where all six neighbours are in the band and 0 elsewhere (there delta alone
/// is kept from bending, so that the band's rim pulls nothing), s = 1 until yield_to_bends(). Conjugate gradients,
/// multigrid preconditioner.
class Displacement {
 public:
  Displacement(const NarrowBand& band, const RowArray& phi0, const Parallel& parallel);

  /// Starts from the present state; returns the number of iterations.
  int minimize(const CellSamples& data, Smoothness smoothness, const SolveLimits& limits);

  /// Lowers the weight of curvature where the present surface bends: to gamma / (1 + (c / c0)^2) for the curvature c =
  /// laplacian phi, as root mean square over the vertices around, and c0 that many times the median of c over the band.
  /// Without the mean each vertex would be free to follow the noise that bent it. The band's rim keeps gamma.
  void yield_to_bends(double medians);
  /// The same gamma everywhere, as at first.
  void stiffen() { std::fill_n(share_.data(), share_.size(), 1.0f); }

  const RowArray& phi() const { return phi_; }
  RowArray& phi() { return phi_; }

 private:
  /// body(i) for every value of some rows.
  template <class Body>
  void for_values(RowRange rows, Body&& body);
  void residual(const CellSamples& data, Smoothness smoothness);
  /// The kernel of that name on a layer of bricks.
  double laplacian(const LaplacianJob& job, int layer);

  const NarrowBand& band_;
  const Parallel& parallel_;
  Multilevel multilevel_;
  const RowArray& phi0_;
  RowArray phi_;
  RowArray residual_, direction_, image_, scratch_;
  RowArray share_;  // of gamma, in (0, 1]
};

}  // namespace soapfilm
