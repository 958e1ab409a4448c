// A run on several processes, started by mpirun. Rank 0 prints; all write the mesh.
#pragma once

#include <memory>
#include <string>

#include "soapfilm/cloud.h"
#include "soapfilm/context.h"
#include "soapfilm/core/ranks.h"
#include "soapfilm/error.h"
#include "soapfilm/params.h"

namespace soapfilm::cli {

/// How a process ends: its exit code, and a line for standard error, or none.
struct Ending {
  int code = 0;
  std::string line{};
  bool followed = false;  ///< because another process ends so
};

/// Null where this process is alone, or the program was built without MPI. Call it once.
std::shared_ptr<Ranks> join_ranks();
/// Where mpirun has started several of the program without MPI, each goes on as the one with it. Throws ParameterError
/// where there is none.
void become_ranks(char** arguments);
/// Whether a run was cancelled because another process ends.
bool gave_up_for_another(const Cancelled& error);
/// Waits for all of them; returns how all end.
Ending leave_ranks(Ranks& ranks, const Ending& own);
/// Call last, when that is told.
void close_ranks(Ranks& ranks);

/// Makes a run of `context` one of the ranks: they agree on its memory, the least that one of them has, and stop
/// waiting when it is cancelled. Throws MemoryError.
void share_run(const std::shared_ptr<Ranks>& ranks, Context& context);
/// Throw ParameterError where ranks have other parameters, or other samples, than rank 0.
void require_same_params(Ranks& ranks, const ReconstructParams& params);
void require_same_samples(Ranks& ranks, const PointCloud& cloud);

}  // namespace soapfilm::cli
