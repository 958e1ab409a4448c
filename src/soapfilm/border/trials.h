// A coarse level solved with air, solid matter or nothing beyond the box.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "soapfilm/border/border.h"
#include "soapfilm/context.h"
#include "soapfilm/field/divergence.h"
#include "soapfilm/solve/primal_dual.h"

namespace soapfilm {

/// The result with one border; energies and costs are those of its level.
struct Trial {
  double energy = 0;     ///< lowest found; at most E(0) = 0
  double bound = 0;      ///< no u has a lower energy
  double area_cost = 0;  ///< lambda TV(u), at least 1000 lambda
  double flux = 0;       ///< through the border
  double closing = 0;    ///< share of the surface's area that is there only to close it
  int level = 0;

  /// A lower bound of the energy with any border: another border can gain at most all of the flux of p through the
  /// border of a closed problem.
  double bound_of_any() const { return bound - flux; }
};

class BorderTrials {
 public:
  BorderTrials(const BorderProblem& problem, const Context& context);

  /// Down to `level`; with solid matter energies are those of the original, not of its complement.
  Trial run(Border border, int level, const PrimalDualParams& solver);
  /// Those that are needed first: with air, solid matter and an open border, in this order, as many as there are ranks,
  /// each by one of them. Without ranks, none. Each rank then has what run() gives.
  std::vector<Trial> run_ahead(int level, const PrimalDualParams& solver);

 private:
  Trial solve(Border border, int level, PrimalDualParams solver);
  /// f of a level, of the original or of the complement: minus f. Only what is read is negated; level 0 is the
  /// problem's own, and must be turned back.
  const SupportField& data(size_t level, bool complement);

  const BorderProblem& problem_;
  const Context& context_;
  std::vector<SupportField> coarser_;  ///< data of levels 1 and on, the same for all trials
  std::vector<uint8_t> negated_;       ///< by level: whether f is that of the complement
  /// Of f. E(u) is the energy of the complement u' = 1 - u of the negated data minus this: zero for the divergence of
  /// directions alone, not for further evidence linear in u.
  std::optional<double> sum_;
};

}  // namespace soapfilm
