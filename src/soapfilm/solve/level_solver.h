// The iteration of the certified solver, on the context's device (device/device.h), and what tells when to end it.
//
// The iteration is in solve/sweep.h; a step is these operations on floats, in this order, each rounded once, sums from
// left to right:
//
// primal step, at a vertex of the band:
//   d_k = p_k of the vertex below along axis k - p_k           (where there is none, the rim's flux, or else 0)
//   u_new = min(max(u - tau * (d_x + d_y + d_z - f), 0), cap)  (cap: 1 at free vertices, else 0)
//   u_bar = u_new + u_new - u
// dual step, after the primal step of the vertices above:
//   q_k = p_k + sigma * (u_bar of the vertex above along axis k - u_bar)             (0 beyond the grid)
//   p_k stays where it is fixed: between the band and a brick that rests, and at the border of an open box
//   isotropic: r2 = max(lambda * lambda - |fixed p|^2, 0), l2 = |free q|^2, where |v|^2 = x * x + y * y + z * z;
//     p_k = q_k, or where l2 > r2: q_k * (sqrt(r2) / sqrt(l2))
//     (the rounded root of a rounded square is the number itself, so where nothing is fixed sqrt(r2) is lambda)
//   anisotropic: p_k = min(max(q_k, -lambda), lambda)
// A brick that is held, or that the grid lacks, rests: nothing changes there.
// All with lambda a little smaller than the level's: dual_radius().
#pragma once

#include <memory>

#include "soapfilm/context.h"
#include "soapfilm/report.h"
#include "soapfilm/solve/level.h"

namespace soapfilm {

/// Step sizes; tau sigma 12 < 4/3 (12 bounds the squared norm of the gradient).
struct StepSizes {
  float sigma = 0;
  float tau = 0;
  bool operator==(const StepSizes&) const = default;
};

/// Those with this sigma, the longest for which the iteration converges.
StepSizes step_sizes(double sigma);

/// Rounding moves a projected p by at most 3.5e-7 of lambda: projected onto a ball this much smaller it stays exactly
/// feasible, and the certificate needs no rescaling.
constexpr float within_ball = 1 - 0x1p-21f;
inline float dual_radius(const Level& level) { return level.lambda * within_ball; }

/// The iteration of one level, and what tells when to end it. While it exists the level is changed by nothing else.
class LevelSolver {
 public:
  /// Both must outlive it.
  LevelSolver(Level& level, const Context& context) : level_(level), context_(context) {}
  virtual ~LevelSolver() = default;
  LevelSolver(const LevelSolver&) = delete;
  LevelSolver& operator=(const LevelSolver&) = delete;

  /// `times` iterations of the whole band. Callers who want to look at context.check() in time ask for at most
  /// sweeps_at_once of them.
  virtual void sweep(StepSizes steps, int times) = 0;
  static constexpr int sweeps_at_once = 8;
  /// After it u and p of the level are those of the device. Before it they are of no use.
  virtual void download() = 0;

  /// evaluate_energy() and estimate_gap() of the state on the device: by default on the host, after a download.
  virtual Energies energies();
  virtual double estimated_gap();

 protected:
  Level& level_;
  const Context& context_;
};

/// On the context's device: by default a Sweeper.
std::shared_ptr<LevelSolver> level_solver(Level& level, const Context& context);

}  // namespace soapfilm
