// Several processes that make one run together, on one machine or on many. Each has a rank. All of them do the same
// work on the same input, but for large arrays, of which each has a part (grid/slabs.h). So whatever they decide they
// decide alike, and only values go from one to another. mpi/ has the ranks of Open MPI.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <span>
#include <vector>

namespace soapfilm {

/// Items [begin, end) of an array.
struct ItemRange {
  size_t begin = 0, end = 0;

  size_t size() const { return end - begin; }
  ItemRange common(ItemRange other) const {
    const size_t first = std::max(begin, other.begin);
    return {first, std::max(first, std::min(end, other.end))};
  }
  bool operator==(const ItemRange&) const = default;
};

class Ranks {
 public:
  /// To another rank, or from it.
  struct Message {
    int rank;
    void* data;
    size_t bytes;
  };
  /// What this rank sent, and how long it was busy with that, most of it waiting for others.
  struct Traffic {
    uint64_t bytes = 0;
    double seconds = 0, cpu_seconds = 0;
  };

  Ranks(int rank, int count) : rank_(rank), count_(count) {}
  virtual ~Ranks() = default;
  Ranks(const Ranks&) = delete;
  Ranks& operator=(const Ranks&) = delete;

  int rank() const { return rank_; }
  int count() const { return count_; }

  /// Sends and receives; returns when all is done. Messages from one rank to another arrive in the order in which they
  /// were sent. Only the thread that began the run calls it. Throws Cancelled, also when another rank gives up.
  void exchange(const std::vector<Message>& out, const std::vector<Message>& in);
  const Traffic& traffic() const { return traffic_; }

  /// Layers of bricks along z that a slab should have at least: thinner ones are not worth their borders.
  virtual int least_layers() const { return 12; }
  /// Where to cut layers with so many bricks into count() slabs: count() + 1 layers, the first 0, the last their
  /// number.
  virtual std::vector<size_t> cut(const std::vector<size_t>& bricks_of_layer) const;

 protected:
  virtual void pass(const std::vector<Message>& out, const std::vector<Message>& in) = 0;

 private:
  int rank_, count_;
  Traffic traffic_;
};

/// An array that every rank has, with so many bytes for each item.
struct SharedArray {
  void* data;
  size_t item_bytes;
};

/// Brings each rank the items that it wants from those that own them: of `owned` parts no two have common items.
void bring(Ranks& ranks, const std::vector<ItemRange>& owned, const std::vector<ItemRange>& wanted,
           std::initializer_list<SharedArray> arrays);
/// Brings each rank all items.
void bring_all(Ranks& ranks, const std::vector<ItemRange>& owned, std::initializer_list<SharedArray> arrays);

/// Values of all ranks, as many of each, on each: rank by rank.
template <class T>
std::vector<T> of_all(Ranks& ranks, std::span<const T> own) {
  const auto count = static_cast<size_t>(ranks.count());
  std::vector<T> all(count * own.size());
  std::vector<ItemRange> each;
  for (size_t r = 0; r < count; ++r) each.push_back({r * own.size(), (r + 1) * own.size()});
  std::copy(own.begin(), own.end(),
            all.begin() + static_cast<std::ptrdiff_t>(each[static_cast<size_t>(ranks.rank())].begin));
  bring_all(ranks, each, {{all.data(), sizeof(T)}});
  return all;
}
template <class T>
std::vector<T> of_all(Ranks& ranks, const T& own) {
  return of_all(ranks, std::span<const T>(&own, 1));
}

/// Throws ParameterError, which names a rank that has another hash of `what` than rank 0, where one has.
void require_same(Ranks& ranks, const char* what, uint64_t own);

}  // namespace soapfilm
