#include "soapfilm/run/rank_times.h"

#include "soapfilm/core/context_state.h"
#include "soapfilm/core/ranks.h"

namespace soapfilm {

std::vector<RankTimes> times_of_ranks(const std::vector<StageTime>& own, const Context& context) {
  Ranks* const ranks = ranks_of(context);
  if (!ranks) return {};
  const auto count = static_cast<size_t>(ranks->count()), self = static_cast<size_t>(ranks->rank());
  // Ranks have the same stages: numbers are enough.
  struct Numbers {
    double elapsed, cpu;
  };
  std::vector<Numbers> numbers(count * own.size());
  std::vector<Ranks::Traffic> traffic(count);
  for (size_t k = 0; k < own.size(); ++k) numbers[self * own.size() + k] = {own[k].elapsed, own[k].cpu};
  traffic[self] = ranks->traffic();
  std::vector<ItemRange> each;
  for (size_t r = 0; r < count; ++r) each.push_back({r, r + 1});
  bring_all(*ranks, each, {{numbers.data(), own.size() * sizeof(Numbers)}, {traffic.data(), sizeof(Ranks::Traffic)}});
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

}  // namespace soapfilm
