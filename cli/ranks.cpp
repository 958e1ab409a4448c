#include "cli/ranks.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "soapfilm/core/context_state.h"
#include "soapfilm/core/hash.h"
#include "soapfilm/error.h"
#include "soapfilm/io/files.h"
#include "soapfilm/platform/memory.h"
#include "soapfilm/platform/processes.h"
#ifdef SOAPFILM_MPI
#include "soapfilm/mpi/mpi_ranks.h"
#endif

namespace soapfilm::cli {

#ifdef SOAPFILM_MPI

std::shared_ptr<Ranks> join_ranks() { return MpiRanks::join(); }
void become_ranks(char**) {}

bool gave_up_for_another(const Cancelled& error) { return dynamic_cast<const RankGaveUp*>(&error) != nullptr; }

Ending leave_ranks(Ranks& ranks, const Ending& own) {
  const MpiRanks::End end = static_cast<MpiRanks&>(ranks).leave({own.code, own.line, own.followed});
  return {end.code, end.line, end.followed};
}

void close_ranks(Ranks& ranks) { static_cast<MpiRanks&>(ranks).close(); }

namespace {

/// When a rank was killed mpirun ends the others, and does not wait long: files that the killed one left go first.
void end_if_cancelled(const Context& context) {
  try {
    context.check();
  } catch (const Cancelled&) {
    remove_temporary_files();
    throw;
  }
}

}  // namespace

void share_run(const std::shared_ptr<Ranks>& ranks, Context& context) {
  auto& processes = static_cast<MpiRanks&>(*ranks);
  processes.while_waiting = [&context] { end_if_cancelled(context); };
  const size_t free = available_memory_bytes() / static_cast<size_t>(processes.on_this_machine());
  const std::vector<size_t> rooms = of_all(*ranks, context.memory_limit().value_or(free));
  context.limit_memory(*std::min_element(rooms.begin(), rooms.end()));
  context.state().ranks = ranks;
}

#else

std::shared_ptr<Ranks> join_ranks() { return nullptr; }
void become_ranks(char** arguments) {
  const int processes = processes_of_mpirun();
  if (processes == 1) return;
  become_program("soapfilm-mpi", arguments);
  throw ParameterError(
      fmt::format("mpirun: {} processes, and soapfilm-mpi, which makes one run of them, is not beside "
                  "this program; the package of that name has it",
                  processes));
}
bool gave_up_for_another(const Cancelled&) { return false; }
Ending leave_ranks(Ranks&, const Ending& own) { return own; }
void close_ranks(Ranks&) {}
void share_run(const std::shared_ptr<Ranks>& ranks, Context& context) { context.state().ranks = ranks; }

#endif

void require_same_params(Ranks& ranks, const ReconstructParams& params) {
  Hash hash;
  hash.add(to_json(params));
  require_same(ranks, "parameters", hash.value());
}

void require_same_samples(Ranks& ranks, const PointCloud& cloud) { require_same(ranks, "samples", hash_of(cloud)); }

}  // namespace soapfilm::cli
