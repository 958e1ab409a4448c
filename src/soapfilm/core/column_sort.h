// Sorting rows whose columns are larger than memory.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace soapfilm {

/// The stable order of rows by their keys, found once and applied to each column. Rows are dealt to a few parts by
/// key, each part again, until one is small: so columns on disk are read and written in a few streams at a time, some
/// times in all, whatever the order was.
class ColumnSort {
 public:
  /// `parts`, 2 to 128, of a range; a `small` one is sorted in memory.
  explicit ColumnSort(std::vector<uint64_t> keys, size_t parts = 16, size_t small = size_t{1} << 20);

  /// `column` is as long as the keys.
  template <class T>
  void apply(std::span<T> column) const {
    std::vector<T> other(column.size());
    for (const Round& round : rounds_)
      for (const Deal& deal : round.deals) {
        std::array<size_t, most_parts> next = deal.begin;
        for (size_t i = deal.first; i < deal.end; ++i) other[next[round.part[i]]++] = column[i];
        std::copy_n(other.begin() + static_cast<std::ptrdiff_t>(deal.first), deal.end - deal.first,
                    column.begin() + static_cast<std::ptrdiff_t>(deal.first));
      }
    for (const Run& run : runs_) {
      for (size_t i = run.first; i < run.end; ++i) other[i] = column[run.first + source_[i]];
      std::copy_n(other.begin() + static_cast<std::ptrdiff_t>(run.first), run.end - run.first,
                  column.begin() + static_cast<std::ptrdiff_t>(run.first));
    }
  }

 private:
  static constexpr size_t most_parts = 256;
  struct Run {
    size_t first, end;
  };
  /// A run whose rows are dealt to parts that begin there.
  struct Deal : Run {
    std::array<size_t, most_parts> begin;
  };
  struct Round {
    std::vector<Deal> deals;
    std::vector<uint8_t> part;  ///< of each row, as they lie before it
  };

  void sort(Run run, size_t depth);
  void deal(Run run, size_t depth);

  size_t parts_, small_;
  std::vector<uint64_t> keys_;  ///< as they lie
  std::vector<Round> rounds_;
  std::vector<Run> runs_;         ///< that are sorted in memory
  std::vector<uint32_t> source_;  ///< of each row in them, from the run's first one on
};

}  // namespace soapfilm
