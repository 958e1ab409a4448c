#include "soapfilm/run/rank_times.h"

#include <memory>
#include <span>
#include <utility>

#include "soapfilm/core/context_state.h"
#include "soapfilm/core/ranks.h"
#include "soapfilm/run/details.h"

namespace soapfilm {

std::vector<RankTimes> times_of_ranks(const std::vector<StageTime>& own, const Context& context) {
  Ranks* const ranks = ranks_of(context);
  if (!ranks) return {};
  // Ranks have the same stages: numbers are enough.
  struct Numbers {
    double elapsed, cpu;
  };
  std::vector<Numbers> of_stages;
  for (const StageTime& stage : own) of_stages.push_back({stage.elapsed, stage.cpu});
  const std::vector<Ranks::Traffic> traffic = of_all(*ranks, ranks->traffic());
  const std::vector<Numbers> numbers = of_all(*ranks, std::span<const Numbers>(of_stages));
  const size_t count = traffic.size();
  std::vector<RankTimes> times(count);
  for (size_t r = 0; r < count; ++r) {
    for (size_t k = 0; k < own.size(); ++k) {
      const Numbers& of_stage = numbers[r * own.size() + k];
      times[r].stages.push_back({own[k].name, of_stage.elapsed, of_stage.cpu});
    }
    times[r].sent_bytes = traffic[r].bytes;
    times[r].exchange_seconds = traffic[r].seconds;
    times[r].exchange_cpu_seconds = traffic[r].cpu_seconds;
  }
  return times;
}

void add_first_stages(const std::vector<RankTimes>& first, ReconstructReport& report) {
  if (first.empty()) return;
  auto details = std::make_shared<ReportDetails>(*report.details);
  for (size_t r = 0; r < first.size(); ++r) {
    std::vector<StageTime>& stages = details->ranks[r].stages;
    stages.insert(stages.begin(), first[r].stages.begin(), first[r].stages.end());
  }
  report.details = std::move(details);
}

}  // namespace soapfilm
