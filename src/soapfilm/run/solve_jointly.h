// The levels solved as one: from each level's solution by itself to one on the leaves of all, and how far that is from
// the best one, at most.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "soapfilm/context.h"
#include "soapfilm/params.h"
#include "soapfilm/pyramid/coarse_to_fine.h"
#include "soapfilm/report.h"
#include "soapfilm/run/details.h"
#include "soapfilm/run/memory_plan.h"
#include "soapfilm/run/other_levels.h"
#include "soapfilm/run/trace.h"
#include "soapfilm/solve/labels.h"

namespace soapfilm {

/// What solving levels jointly has from the run.
struct JointTask {
  const ReconstructParams& params;
  MemoryBudget& memory;
  Trace& trace;
};

/// Plans the memory of solving levels jointly. Returns false, with a warning, where it does not fit.
bool plan_joint_solve(const SolvedLevels& solved, const CoarseLevels& coarse, const JointTask& task);

/// The sides of each level, the finest first (adapt/leaf_labels.h), for the data of `samples`, each on the level of its
/// place: by tv's iteration, or for graph cuts by one cut of all leaves. The certificate, of all levels, takes the
/// place of the grid's, which goes to the details. Frees the levels. None, with a warning, where a graph does not fit
/// into the memory.
std::optional<std::vector<Labels>> solve_jointly(SolvedLevels& solved, CoarseLevels coarse, const GridSamples& samples,
                                                 const JointTask& task, Certificate& certificate,
                                                 ReportDetails& details, const Context& context);

}  // namespace soapfilm
