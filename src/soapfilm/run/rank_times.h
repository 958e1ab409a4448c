// What each rank of a run spent (core/ranks.h).
#pragma once

#include <cstdint>
#include <vector>

#include "soapfilm/context.h"
#include "soapfilm/report.h"

namespace soapfilm {

struct RankTimes {
  std::vector<StageTime> stages;
  uint64_t sent_bytes = 0;
  double exchange_seconds = 0;  ///< sending, receiving and, most of it, waiting for other ranks
  double exchange_cpu_seconds = 0;
};

/// Of all ranks, on each, so far; empty where there are none.
std::vector<RankTimes> times_of_ranks(const std::vector<StageTime>& own, const Context& context);

/// What the ranks did before the run, `first`, is the first of what its report says of them.
void add_first_stages(const std::vector<RankTimes>& first, ReconstructReport& report);

}  // namespace soapfilm
