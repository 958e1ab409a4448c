// Prints the lines and warnings of a run, from the results of its stages.
#pragma once

#include <optional>

#include "soapfilm/report.h"
#include "soapfilm/run/details.h"
#include "soapfilm/run/memory_plan.h"
#include "soapfilm/run/prepare.h"
#include "soapfilm/run/trace.h"

namespace soapfilm {

/// The grid and the memory that the run will need, before the slow stages.
void announce_grid(const Grid& grid, const MemoryBudget& memory, Trace& trace);

/// The weight of area, and warnings before the solve.
void announce_lambda(const Lambda& lambda, const Grid& grid, const ReconstructParams& params, Trace& trace);

/// What lies beyond the samples' box; warns where that is air, but the normals point `inward` or were turned over.
void announce_border(const BorderReport& border, bool inward, Trace& trace);

/// Warns of solves that reached their limit of iterations or could not be proved.
void warn_unconverged(const SolveReport& report, double lambda, const ReconstructParams& params, Trace& trace);

/// The energy of the result: proved for methods with a dual, else only computed by the common energy evaluator.
void announce_energy(const Certificate& certificate, const ReconstructParams& params, Trace& trace);
/// The same of several levels, where there are such.
void announce_leaves(const Certificate& certificate, Method method, const ReportDetails& details, Trace& trace);

/// What drop_components() dropped, if anything.
void announce_components(const ComponentReport& report, const ReconstructParams& params, Trace& trace);

/// The memory plan, if the solve found much more or less surface than the samples suggested. The fit weights, chosen or
/// given; the number of vanished parts, if any.
void announce_refinement(const std::optional<FitReport>& report, const MemoryBudget& memory,
                         const ReconstructParams& params, Trace& trace);

/// What trim() removed, if anything; warns where it would have removed everything.
void announce_trim(const TrimReport& report, const TrimParams& params, Trace& trace);

/// The interval of the volumes of other segmentations.
void announce_volumes(const VolumeInterval& volumes, double voxel, Trace& trace);

/// Area and volume, what one voxel of offset changes, and what the holes leave open.
void announce_measures(const ReconstructReport& report, Trace& trace);

/// What is left of the triangles, and the distance that is proved.
void announce_simplification(const SimplifyReport& report, double voxel, Trace& trace);

/// The self-check; warns where more than 1 % of the samples are lost, and says the likely cause.
void announce_self_check(const ReconstructReport& report, Trace& trace);

}  // namespace soapfilm
