// The paper's own solver (section 4.2): lagged diffusivity and successive over-relaxation on the whole box.
//
// Equation (7), lambda div(grad u / |grad u|) + div v = 0, is made linear by holding the diffusivity
// g = 1 / sqrt(|grad u|^2 + epsilon^2) constant; the linear system is relaxed vertex by vertex (equation (8)):
//
//   u_i <- (1 - omega) u_i + omega (lambda sum_j g_ij u_j + f_i) / (lambda sum_j g_ij),   g_ij = (g_i + g_j) / 2
//
// Choices that the paper leaves open: u is clipped to [0, 1] at each update, |grad u| in g is by central differences
// (SorGradient; in E(u) by forward ones, as in energy.h), u = 0 on the box's outermost layer. pyramid/sor_pyramid.h
// runs it over the levels.
#pragma once

#include <functional>
#include <vector>

#include "soapfilm/context.h"
#include "soapfilm/field/divergence.h"
#include "soapfilm/grid/dense_field.h"
#include "soapfilm/params.h"
#include "soapfilm/progress.h"
#include "soapfilm/report.h"
#include "soapfilm/solve/level.h"

namespace soapfilm {

// SorGradient: central, (u(x + 1) - u(x - 1)) / 2, is usual where g_ij is the mean of two vertices; forward, as in the
// total variation: the upper vertex of a jump does not see the jump, and the iteration cycles.

struct SorLevelReport {
  int level = 0;
  int iterations = 0;
  bool converged = false;
  std::vector<double> energy;   ///< E(u) after k iterations, k = 0 .. iterations (sums in double, on the whole box)
  std::vector<double> seconds;  ///< from the level's begin to the end of energy[k]'s pass; without the observer's time
  size_t bytes = 0;             ///< u, diffusivity, kinds of runs and data term
};

/// Throws ParameterError for a value out of its range.
void validate(const SorParams& params);

/// A state between two passes of renew_every iterations.
struct SorState {
  const LevelBox& box;
  double lambda;  ///< of this level
  const SupportField& support;
  const DenseField<float>& u;
  int iterations;
  double seconds;
};
using SorObserver = std::function<void(const SorState&)>;

/// Changes u, which is 0 on the box's outermost layer, until every iteration of a pass changes E by less than the
/// tolerance, or to the limit. `lambda` is this level's. The result does not depend on threads or SIMD target.
SorLevelReport relax_sor(DenseField<float>& u, const LevelBox& box, double lambda, const SupportField& support,
                         const SorParams& params, const Context& context, const SorObserver& observe = {});

/// The whole-box u as a level whose p is the dual implied by equation (8), p = lambda g_ij (u_j - u_i) on the face
/// between i and j, scaled to |p| <= lambda where it is longer. Outside the band u is constant and p = 0. `support`
/// must outlive the level.
Level sor_level(const DenseField<float>& u, const LevelBox& box, double lambda, const SupportField& support,
                const SorParams& params, const Context& context);

/// The memory of all fields while the solver works (docs/notes/methods.md).
inline constexpr double sor_bytes_per_vertex = 7;

}  // namespace soapfilm
