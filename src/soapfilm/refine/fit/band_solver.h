// The linear system of the displacement on one band: what is done there with whole arrays, on the context's device
// (device/device.h). displacement.h has the steps.
#pragma once

#include <memory>

#include "soapfilm/context.h"
#include "soapfilm/refine/fit/cell_samples.h"
#include "soapfilm/refine/fit/narrow_band.h"

namespace soapfilm {

/// Weights of the two smoothness terms against one sample; lattice units.
struct Smoothness {
  float slope = 0;      ///< beta, of |grad delta|^2
  float curvature = 0;  ///< gamma, of |laplacian (phi0 + delta)|^2
};

/// The energy E of Displacement, half of whose Hessian is A and half of whose gradient at phi is -r, and what conjugate
/// gradients need: the residual r, a direction d, the preconditioned residual z. Each function is one pass, or a few,
/// over the arrays of the band.
///
/// Bits, in float: kernels/row_kernel.h says what each vertex gets. Differences to neighbors add those along x, y and z
/// as x + (y + z). Cells of samples add to their corners by rows of bricks along z, even layers before odd ones, within
/// one in the order of CellSamples. A sum is that of its bricks (ordered_sum); a brick's is by the vertex's place along
/// x, 64 rows at a time in float, those in double, and ((0 + 1) + (2 + 3)) + ((4 + 5) + (6 + 7)) of the eight.
class BandSolver {
 public:
  virtual ~BandSolver() = default;

  /// On the host. What is changed there counts from the next start() or reweight_curvature() on.
  virtual RowArray& phi() = 0;
  /// Builds the preconditioner from the positions and their weights.
  virtual void precondition(const CellSamples& data, Smoothness smoothness) = 0;
  /// r at the present phi.
  virtual void start(const CellSamples& data, Smoothness smoothness) = 0;
  /// z, about A^-1 r: two cycles of Multilevel. Returns <r, z>.
  virtual double preconditioned() = 0;
  /// d = z + ratio d. Returns <d, A d>, and keeps A d but for the last step, which does not need it.
  virtual double search_direction(const CellSamples& data, Smoothness smoothness, float ratio, bool last) = 0;
  /// phi += length d, and but for the last step r -= length A d.
  virtual void step(float length, bool last) = 0;

  /// Displacement's functions of these names: s and the target.
  virtual void reweight_curvature(double medians) = 0;
  virtual void reset_curvature_weights() = 0;
  virtual void drop_target() = 0;
};

/// On the context's device: by default a CpuBandSolver. The band, phi0
/// and the context must outlive it.
std::shared_ptr<BandSolver> band_solver(const NarrowBand& band, const RowArray& phi0, const Context& context);

}  // namespace soapfilm
