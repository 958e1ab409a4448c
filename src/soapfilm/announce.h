// What a run tells while it goes on: lines for the progress object, from the report as it fills.
#pragma once

#include "soapfilm/core/progress.h"
#include "soapfilm/report.h"

namespace soapfilm {

/// The grid and the memory that the run will take, before anything takes long.
void announce_grid(const ReconstructReport& report, Progress& progress);

/// What area weighs, and whatever there is to be warned of before the solve (orient() has shown its own).
void announce_weight(const ReconstructReport& report, Progress& progress);

/// What lies beyond the samples' box.
void announce_border(const ReconstructReport& report, Progress& progress);

/// The plan of memory, where the solve found much more or less surface than the samples told.
void announce_plan(size_t first_plan, const ReconstructReport& report, Progress& progress);

/// Warns, here and in the report, of normals that look the wrong way for a surface with air around.
void warn_inward(ReconstructReport& report, Progress& progress);

/// Warns, here and in the report, of what ran into its limit of iterations or could not be proved.
void warn_unconverged(ReconstructReport& report, Progress& progress);

/// What is known of the result's energy: proved by methods with a dual, else only weighed by the same judge.
void announce_energy(const ReconstructReport& report, Progress& progress);

/// What drop_islands() dropped, if anything.
void announce_islands(const ReconstructReport& report, Progress& progress);

/// How much the samples are trusted, by the data or as asked for; of how many parts refining left nothing, if any.
void announce_refinement(const ReconstructReport& report, Progress& progress);

/// How much the mesh holds of the samples; warns, here and in the report, where it lost more than 1 % of them.
void announce_self_check(ReconstructReport& report, Progress& progress);

/// What trim() took away, if anything; warns, here and in the report, where it would have taken all.
void announce_trim(ReconstructReport& report, Progress& progress);

}  // namespace soapfilm
