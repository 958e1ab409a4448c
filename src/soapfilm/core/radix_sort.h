// Sorting integers in time linear in their number.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "soapfilm/core/memory.h"
#include "soapfilm/core/parallel.h"

namespace soapfilm {

/// Sorts items by the lowest `bits` > 0 of key_of(item), and keeps the order of those with equal bits (Knuth, The Art
/// of Computer Programming 3, section 5.2.5): they are put into groups by highest digit, each thread a run of them;
/// then each group is sorted in the cache, lowest digits first. Needs as much additional memory as the items.
template <class T, class KeyOf>
void radix_sort(std::vector<T>& items, int bits, const Context& context, KeyOf&& key_of) {
  constexpr int high_bits = 12, low_bits = 8;
  constexpr size_t most_chunks = 16, least_chunk = size_t{1} << 15;
  const size_t count = items.size();
  const int low = std::max(bits - high_bits, 0);
  const size_t hands = size_t{1} << (bits - low);
  const auto hand_of = [&](uint64_t key) { return static_cast<size_t>(key >> low) & (hands - 1); };
  const auto other = std::make_unique_for_overwrite<T[]>(count);
  prefer_large_pages(other.get(), count * sizeof(T));

  const size_t chunks = std::clamp<size_t>(count / least_chunk, 1, most_chunks), grain = count / chunks + 1;
  std::vector<size_t> next(chunks * hands);  // of each chunk and group: first the number, then the next position
  const auto for_each_place = [&](auto&& visit) {
    parallel_chunks(context, count, grain, [&](size_t begin, size_t end) {
      size_t* place = next.data() + begin / grain * hands;
      for (size_t i = begin; i < end; ++i) visit(items[i], place[hand_of(key_of(items[i]))]++);
    });
  };
  for_each_place([](const T&, size_t) {});
  std::vector<size_t> hand_begin(hands + 1);
  for (size_t hand = 0, sum = 0; hand < hands; ++hand) {
    for (size_t c = 0; c < chunks; ++c) sum += std::exchange(next[c * hands + hand], sum);
    hand_begin[hand + 1] = sum;
  }
  for_each_place([&](const T& item, size_t place) { other[place] = item; });

  parallel_for(context, hands, 16, [&](size_t hand) {
    const size_t size = hand_begin[hand + 1] - hand_begin[hand];
    T* from = other.get() + hand_begin[hand];
    T* to = items.data() + hand_begin[hand];
    for (int shift = 0; size > 1 && shift < low; shift += low_bits, std::swap(from, to)) {
      const uint64_t mask = (uint64_t{1} << std::min(low_bits, low - shift)) - 1;
      std::array<size_t, size_t{1} << low_bits> at{};
      for (size_t i = 0; i < size; ++i) ++at[key_of(from[i]) >> shift & mask];
      for (size_t sum = 0; size_t & n : at) sum += std::exchange(n, sum);
      for (size_t i = 0; i < size; ++i) to[at[key_of(from[i]) >> shift & mask]++] = from[i];
    }
    T* const sorted = items.data() + hand_begin[hand];
    if (from != sorted) std::copy_n(from, size, sorted);
  });
}

/// The same for keys.
inline void radix_sort(std::vector<uint64_t>& keys, int bits, const Context& context) {
  radix_sort(keys, bits, context, [](uint64_t key) { return key; });
}

}  // namespace soapfilm
