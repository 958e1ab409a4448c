// How far the surface of several levels is from the best one on its leaves, at most.
#pragma once

#include <cstdint>
#include <vector>

#include "soapfilm/context.h"
#include "soapfilm/params.h"
#include "soapfilm/pyramid/coarse_to_fine.h"
#include "soapfilm/report.h"
#include "soapfilm/run/adapt.h"
#include "soapfilm/run/details.h"
#include "soapfilm/run/memory_plan.h"
#include "soapfilm/run/trace.h"

namespace soapfilm {

/// The levels above the placed one as its solve leaves them: their flux is known wherever finer levels' is.
class CoarseLevels {
 public:
  explicit CoarseLevels(const Context& context) : context_(context) {}
  /// `user`, which also keeps the levels.
  PyramidObserver watch(PyramidObserver user);
  uint64_t bytes() const;
  void clear() { levels_.clear(); }
  /// So many levels above the placed one; null where that was not solved with all of lambda.
  Level* find(int above);

 private:
  const Context& context_;
  std::vector<Level> levels_;
};

/// Plans the memory of the solved levels until certify_leaves(); frees them, with a warning, where it does not fit.
void keep_for_certificate(AdaptedSurface& adapted, CoarseLevels& coarse, MemoryBudget& memory, Trace& trace);

/// Of the levels that places have at last, in place of `of_grid`, which goes to the details; `of_grid` where there is
/// one level, or where the solved levels were not kept. Frees these.
Certificate certify_leaves(AdaptedSurface& adapted, CoarseLevels coarse, const Certificate& of_grid,
                           const PrimalDualParams& params, ReportDetails& details, const Context& context);

}  // namespace soapfilm
