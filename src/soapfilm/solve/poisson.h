// Method `poisson`: the quadratic regularizer, equation (6) of the paper without its bounds, as in Kazhdan's method.
//
//   min over u of E(u) = lambda sum |grad u|^2 - <f, u>,   u = 0 outside the box      =>    -2 lambda Laplace(u) = f
//
// on the whole box, h = 1, 7-point stencil. Linear in f: lambda only scales u, and the surface does not depend on it.
#pragma once

#include <cstddef>
#include <vector>

#include "soapfilm/context.h"
#include "soapfilm/field/divergence.h"
#include "soapfilm/grid/dense_field.h"
#include "soapfilm/grid/lattice.h"
#include "soapfilm/params.h"
#include "soapfilm/progress.h"
#include "soapfilm/report.h"

namespace soapfilm {

struct PoissonReport {
  int iterations = 0;
  bool converged = false;
  double residual = 0;            ///< relative, computed from u itself at the end
  std::vector<double> residuals;  ///< relative, after each iteration, from the recurrence
  double energy = 0;              ///< E(u)
  size_t unknowns = 0;            ///< free vertices of the box
  size_t bytes = 0;               ///< most held at once by the solver's fields, u included
};

/// The memory of all fields while the solver works (docs/notes/methods.md).
inline constexpr double poisson_bytes_per_vertex = 17.2;

/// u at every vertex of the lattice's finest level, by conjugate gradients with a multigrid preconditioner. The same
/// bytes for any number of threads. u is float: its rounding alone leaves a residual of 1e-5 to 3e-5 on boxes of 256 to
/// 512 vertices, and a tolerance below that is reported as not reached. Throws ParameterError for a lambda, tolerance
/// or number of iterations out of range, Cancelled.
DenseField<float> solve_poisson(const Lattice& lattice, const SupportField& support, double lambda,
                                const PoissonParams& params, const Context& context, PoissonReport& report);

}  // namespace soapfilm
