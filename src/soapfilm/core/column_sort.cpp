#include "soapfilm/core/column_sort.h"

#include <numeric>
#include <utility>

#include "soapfilm/core/memory.h"
#include "soapfilm/core/random.h"

namespace soapfilm {

ColumnSort::ColumnSort(std::vector<uint64_t> keys, size_t parts, size_t small)
    : parts_(parts), small_(std::max<size_t>(small, 1)), keys_(std::move(keys)), source_(keys_.size()) {
  sort({0, keys_.size()}, 0);
  release(keys_);
}

void ColumnSort::sort(Run run, size_t depth) {
  const auto first = keys_.begin() + static_cast<std::ptrdiff_t>(run.first);
  const auto end = keys_.begin() + static_cast<std::ptrdiff_t>(run.end);
  if (std::is_sorted(first, end)) return;
  if (run.end - run.first > small_) return deal(run, depth);
  runs_.push_back(run);
  const auto source = std::span(source_).subspan(run.first, run.end - run.first);
  std::iota(source.begin(), source.end(), 0u);
  std::stable_sort(source.begin(), source.end(), [&](uint32_t a, uint32_t b) { return first[a] < first[b]; });
}

void ColumnSort::deal(Run run, size_t depth) {
  constexpr size_t asked_for_each = 64;  // keys, to choose where parts end
  Random random(run.first);
  std::vector<uint64_t> some;
  for (size_t k = 0; k < asked_for_each * parts_; ++k)
    some.push_back(keys_[run.first + random.next() % (run.end - run.first)]);
  std::sort(some.begin(), some.end());
  // A frequent key is a part of its own, and a single end separates a key: so parts are smaller than the run.
  std::vector<uint64_t> ends;
  for (size_t part = 1; part < parts_; ++part) ends.push_back(some[part * asked_for_each]);
  for (size_t part = parts_ - 1; part-- > 0;)
    if ((parts_ == 2 || (part > 0 && ends[part] == ends[part - 1])) && ends[part] < UINT64_MAX)
      ends.push_back(ends[part] + 1);
  std::sort(ends.begin(), ends.end());
  ends.erase(std::unique(ends.begin(), ends.end()), ends.end());
  const auto part_of = [&](uint64_t key) {
    const auto above = std::upper_bound(ends.begin(), ends.end(), key);
    return static_cast<size_t>(above - ends.begin());
  };
  if (rounds_.size() == depth) rounds_.push_back({{}, std::vector<uint8_t>(keys_.size())});
  Round& round = rounds_[depth];
  Deal deal{run, {}};
  std::array<size_t, most_parts + 1> count{};
  for (size_t i = run.first; i < run.end; ++i) {
    round.part[i] = static_cast<uint8_t>(part_of(keys_[i]));
    ++count[round.part[i]];
  }
  std::exclusive_scan(count.begin(), count.end() - 1, deal.begin.begin(), run.first);
  round.deals.push_back(deal);
  std::vector<uint64_t> dealt(run.end - run.first);
  std::array<size_t, most_parts> next = deal.begin;
  for (size_t i = run.first; i < run.end; ++i) dealt[next[round.part[i]]++ - run.first] = keys_[i];
  std::copy(dealt.begin(), dealt.end(), keys_.begin() + static_cast<std::ptrdiff_t>(run.first));
  release(dealt);
  for (size_t part = 0; part <= ends.size(); ++part) sort({deal.begin[part], next[part]}, depth + 1);
}

}  // namespace soapfilm
