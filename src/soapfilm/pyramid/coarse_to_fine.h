// Section 4.3: the problem solved from the coarsest level to the finest, each on a narrow band around the coarser
// solution, with a certificate for the whole domain. Above them, on levels too coarse to pay for the surface's area, an
// easier problem gives the first one its start.
#pragma once

#include <functional>
#include <optional>
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
  double lambda_share = 1;  ///< fraction of lambda used; below 1 it only gave the next finer level its start
  size_t active_vertices = 0;
  int iterations = 0;
  double tolerance = 0;  ///< of its solution: twice that of the finest at level 1, at most 3e-4 at coarser ones, 1e-2
                         ///< if it used less than lambda
  int band_growths = 0;
  bool converged = false;
  Stop stop = Stop::limit;
  Energies energies;  ///< of the relaxed u, whole domain
  Energies binary;    ///< of u thresholded at 1/2; the finest level's are in the certificate
};

struct PyramidSolution {
  Level finest;                      ///< refers to the support field passed in
  std::vector<LevelReport> reports;  ///< coarsest first
};

/// Fraction of the coarser level's flux p from which `level`, on a band, starts; the finest level keeps all of it.
float flux_kept(int level);

/// A level on these bricks, u and p zero, which refers to its data.
using MakeLevel = std::function<Level(const BrickMask& bricks)>;

/// Called during the solve, from the calling thread, for levels that use all of lambda; each may be empty.
struct PyramidObserver {
  /// Each level when it is solved, coarsest first, and where its vertices are in the world.
  std::function<void(const Level&, const Lattice& of_level)> solved;
  /// Each evaluation of the relaxed u, after `iterations` on this level. If it is set no gap is estimated: large levels
  /// may stop an iteration or two earlier or later.
  std::function<void(const Level&, int iterations, const Energies&)> evaluated;
  /// For every level, before its memory is allocated: its bricks, and those of coarser levels held at the same time.
  /// May throw.
  std::function<void(int level, size_t bricks, size_t beside)> begins;
  /// For every level: its solution where an earlier run has found it (of the report, `level` is set), else none; and
  /// what this run has found.
  std::function<std::optional<Level>(LevelReport&, const MakeLevel&)> known;
  std::function<void(const Level&, const LevelReport&)> keep;
  /// The same for every graph of a graph cut: its vertices. May throw.
  std::function<void(size_t vertices)> cuts;
};

/// Solves min lambda TV(u) - <f, u> (equation (4)) on the lattice, TV by `norm`. `support` is the finest level's data
/// term.
PyramidSolution solve_coarse_to_fine(const Lattice& lattice, const SupportField& support, double lambda,
                                     const PrimalDualParams& params, const Context& context,
                                     Norm norm = Norm::isotropic, const PyramidObserver& observe = {});

/// Parameters of a rough solution.
struct RoughParams {
  int last = 2;             ///< level to stop at, or the first one that uses all of lambda, if that is finer
  PrimalDualParams solver;  ///< its tolerance is that of all levels that use all of lambda
  Norm norm = Norm::isotropic;
};

/// The data term of a level, called when it is read.
using LevelData = std::function<const SupportField&(int level)>;

/// Solves the levels down to one above the finest, for decisions made from it, each rank by itself. data(0) must
/// be `support`, whose values are read where level 0 is solved; else its bricks alone.
PyramidSolution solve_coarse_levels(const Lattice& lattice, const SupportField& support, const LevelData& data,
                                    double lambda, const RoughParams& params, const Context& context,
                                    const PyramidObserver& observe = {});

}  // namespace soapfilm
