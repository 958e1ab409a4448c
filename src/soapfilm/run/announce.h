// The lines of a run and its warnings, from what its stages returned.
#pragma once

#include <optional>

#include "soapfilm/report.h"
#include "soapfilm/run/details.h"
#include "soapfilm/run/memory_plan.h"
#include "soapfilm/run/prepare.h"
#include "soapfilm/run/trace.h"

namespace soapfilm {

/// The grid and the memory that the run will take, before anything takes long.
void announce_grid(const Grid& grid, const MemoryBudget& memory, Trace& trace);

/// What area weighs, and whatever there is to be warned of before the solve.
void announce_lambda(const Lambda& lambda, const Grid& grid, const ReconstructParams& params, Trace& trace);

/// What lies beyond the samples' box; warns where that is air, but the normals point `inward`.
void announce_border(const BorderReport& border, bool inward, Trace& trace);

/// Warns of what ran into its limit of iterations or could not be proved.
void warn_unconverged(const SolveReport& report, double lambda, const ReconstructParams& params, Trace& trace);

/// What is known of the result's energy: proved by methods with a dual, else only weighed by the same judge.
void announce_energy(const Certificate& certificate, const ReconstructParams& params, Trace& trace);

/// What drop_components() dropped, if anything.
void announce_components(const ComponentReport& report, const ReconstructParams& params, Trace& trace);

/// The plan of memory, where the solve found much more or less surface than the samples told. How much the samples are
/// trusted, by the data or as asked for; of how many parts refining left nothing, if any.
void announce_refinement(const std::optional<FitReport>& report, const MemoryBudget& memory,
                         const ReconstructParams& params, Trace& trace);

/// What trim() took away, if anything; warns where it would have taken all.
void announce_trim(const TrimReport& report, Trace& trace);

/// How much the mesh holds of the samples; warns where it lost more than 1 % of them, and says the likely cause.
void announce_self_check(const ReconstructReport& report, Trace& trace);

}  // namespace soapfilm
