#include "cli/ranks.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <span>
#include <string_view>
#include <vector>

#include "soapfilm/core/context_state.h"
#include "soapfilm/error.h"
#include "soapfilm/platform/memory.h"
#ifdef SOAPFILM_MPI
#include "soapfilm/mpi/mpi_ranks.h"
#endif

namespace soapfilm::cli {

namespace {

/// What every rank has, on each.
template <class T>
std::vector<T> of_all(Ranks& ranks, const T& own) {
  const auto count = static_cast<size_t>(ranks.count());
  std::vector<T> all(count);
  all[static_cast<size_t>(ranks.rank())] = own;
  std::vector<ItemRange> each;
  for (size_t r = 0; r < count; ++r) each.push_back({r, r + 1});
  bring_all(ranks, each, {{all.data(), sizeof(T)}});
  return all;
}

/// Fowler, Noll and Vo's hash over words of eight bytes.
class Hash {
 public:
  template <class T>
  void add(const std::vector<T>& values) {
    add(std::as_bytes(std::span(values)));
  }
  void add(std::string_view text) { add(std::as_bytes(std::span(text))); }
  uint64_t value() const { return value_; }

 private:
  void add(std::span<const std::byte> bytes) {
    add_word(bytes.size());
    for (size_t k = 0; k < bytes.size(); k += sizeof(uint64_t)) {
      uint64_t word = 0;
      std::memcpy(&word, bytes.data() + k, std::min(sizeof word, bytes.size() - k));
      add_word(word);
    }
  }
  void add_word(uint64_t word) {
    value_ = (value_ ^ word) * 0x100000001b3u;
    value_ ^= value_ >> 29;  // so that high bits reach low ones
  }
  uint64_t value_ = 0xcbf29ce484222325u;
};

void require_same(Ranks& ranks, const char* what, uint64_t own) {
  const std::vector<uint64_t> all = of_all(ranks, own);
  const auto other = std::find_if(all.begin(), all.end(), [&](uint64_t hash) { return hash != all[0]; });
  if (other != all.end())
    throw ParameterError(fmt::format("rank {} has other {} than rank 0: each needs the same command and the same files",
                                     other - all.begin(), what));
}

uint64_t hash_of(const PointCloud& cloud) {
  Hash hash;
  hash.add(cloud.positions);
  hash.add(cloud.normals);
  hash.add(cloud.sensors);
  hash.add(cloud.weights);
  for (const Scan& scan : cloud.scans) hash.add(fmt::format("{} {}", scan.end, scan.sensor.has_value()));
  return hash.value();
}

}  // namespace

#ifdef SOAPFILM_MPI

std::shared_ptr<Ranks> join_ranks() { return MpiRanks::join(); }

bool gave_up_for_another(const Cancelled& error) { return dynamic_cast<const RankGaveUp*>(&error) != nullptr; }

Ending leave_ranks(Ranks& ranks, const Ending& own) {
  const MpiRanks::End end = static_cast<MpiRanks&>(ranks).leave({own.code, own.line, own.followed});
  return {end.code, end.line, end.followed};
}

void share_run(const std::shared_ptr<Ranks>& ranks, Context& context) {
  auto& processes = static_cast<MpiRanks&>(*ranks);
  processes.while_waiting = [&context] { context.check(); };
  const size_t free = available_memory_bytes() / static_cast<size_t>(processes.on_this_machine());
  const std::vector<size_t> rooms = of_all(*ranks, context.memory_limit().value_or(free));
  context.limit_memory(*std::min_element(rooms.begin(), rooms.end()));
  context.state().ranks = ranks;
}

#else

std::shared_ptr<Ranks> join_ranks() { return nullptr; }
bool gave_up_for_another(const Cancelled&) { return false; }
Ending leave_ranks(Ranks&, const Ending& own) { return own; }
void share_run(const std::shared_ptr<Ranks>& ranks, Context& context) { context.state().ranks = ranks; }

#endif

void check_agreement(Ranks& ranks, const ReconstructParams& params, const PointCloud& cloud) {
  Hash hash;
  hash.add(to_json(params));
  require_same(ranks, "parameters", hash.value());
  require_same(ranks, "samples", hash_of(cloud));
}

}  // namespace soapfilm::cli
