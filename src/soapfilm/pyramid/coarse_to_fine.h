// Section 4.3: the problem solved from the coarsest level to the finest, each on a thin band around what the coarser
// one found, with a certificate for the whole domain. Above them, on levels too coarse to pay for the surface's area,
// an easier problem tells the first one where to start.
#pragma once

#include <functional>
#include <vector>

#include "soapfilm/context.h"
#include "soapfilm/field/divergence.h"
#include "soapfilm/grid/lattice.h"
#include "soapfilm/progress.h"
#include "soapfilm/report.h"
#include "soapfilm/solve/primal_dual.h"

namespace soapfilm {

struct LevelReport {
  int level = 0;
  double lambda_share = 1;  ///< of lambda that it took; below 1 the next finer level only started from it
  size_t active_vertices = 0;
  int iterations = 0;
  double tolerance = 0;  ///< that it was solved to: twice that of the finest at level 1, at most 3e-4 at coarser ones,
                         ///< 1e-2 where it took less than lambda
  int band_growths = 0;
  bool converged = false;
  Stop stop = Stop::limit;
  Energies energies;  ///< of the relaxed u, whole domain
  Energies binary;    ///< of u thresholded at 1/2; the finest level's is in the certificate
};

struct PyramidSolution {
  Level finest;                      ///< refers to the support field that was passed in
  std::vector<LevelReport> reports;  ///< coarsest first
};

/// Share of the coarser level's flux p that `level`, on a band, starts from; the finest one starts from all of it.
float flux_kept(int level);

/// Called while it works, from the calling thread, of levels that take all of lambda; either may be empty.
struct PyramidObserver {
  /// Each level when it is solved, coarsest first, and where its vertices lie in the world.
  std::function<void(const Level&, const Lattice& of_level)> solved;
  /// Each evaluation of the relaxed u, `iterations` on this level so far. Where it is set no gap is estimated: large
  /// levels may stop an iteration or two from where they would.
  std::function<void(const Level&, int iterations, const Energies&)> evaluated;
  /// Of every level, before its memory is taken: its bricks, and those of coarser levels that are held beside it. May
  /// throw.
  std::function<void(int level, size_t bricks, size_t beside)> begins;
};

/// Solves min lambda TV(u) - <f, u> (equation (4)) on the lattice, TV by `norm`. `support` is the finest level's data
/// term.
PyramidSolution solve_coarse_to_fine(const Lattice& lattice, const SupportField& support, double lambda,
                                     const PrimalDualParams& params, const Context& context,
                                     Norm norm = Norm::isotropic, const PyramidObserver& observe = {});

/// A rough look at the problem.
struct RoughParams {
  int last = 2;             ///< level to stop at, or the first one that takes all of lambda, if that is finer
  PrimalDualParams solver;  ///< its tolerance is that of all levels that take all of lambda
  Norm norm = Norm::isotropic;
};

/// The levels down to one above the finest, for what they tell of it. The data f of the one returned is gone unless it
/// is level 0: only `observe` sees it.
PyramidSolution solve_coarse_levels(const Lattice& lattice, const SupportField& support, double lambda,
                                    const RoughParams& params, const Context& context,
                                    const PyramidObserver& observe = {});

}  // namespace soapfilm
