// Loops whose items ranks share, each taking as many: for what all of them have whole.
#pragma once

#include <algorithm>
#include <utility>
#include <vector>

#include "soapfilm/context.h"
#include "soapfilm/core/context_state.h"
#include "soapfilm/core/gather.h"
#include "soapfilm/core/memory.h"
#include "soapfilm/core/parallel.h"
#include "soapfilm/core/ranks.h"

namespace soapfilm {

/// About as many items for each rank, or as a test cuts; without ranks one part, all.
inline std::vector<ItemRange> even_parts(size_t count, const Context& context) {
  const Ranks* const ranks = ranks_of(context);
  if (!ranks) return {{0, count}};
  constexpr size_t pieces = 1024;  // of equal size
  const std::vector<size_t> cut = ranks->cut(std::vector<size_t>(pieces, 1));
  std::vector<ItemRange> found;
  for (size_t r = 0; r + 1 < cut.size(); ++r) found.push_back({count * cut[r] / pieces, count * cut[r + 1] / pieces});
  return found;
}

/// This rank's part; without ranks the only one.
inline ItemRange own_part(const std::vector<ItemRange>& parts, const Context& context) {
  const Ranks* const ranks = ranks_of(context);
  return parts[ranks ? static_cast<size_t>(ranks->rank()) : 0];
}

/// Of `count` items each rank has found its part (even_parts): of the array, [first_of(k), first_of(k + 1)) of item k.
/// Brings each rank those of all.
template <class First>
void bring_items(size_t count, SharedArray array, const Context& context, First&& first_of) {
  Ranks* const ranks = ranks_of(context);
  if (!ranks) return;
  std::vector<ItemRange> written;
  for (const ItemRange& part : even_parts(count, context))
    written.push_back({first_of(part.begin), first_of(part.end)});
  bring_all(*ranks, written, {array});
}

/// Calls body(k) for each k < `count`, on all ranks together, `grain` of them per task. What it writes are values
/// [first_of(k), first_of(k + 1)): those of all items are then on each rank.
template <class T, class First, class Body>
void share_items(size_t count, std::vector<T>& values, size_t grain, const Context& context, First&& first_of,
                 Body&& body) {
  const ItemRange own = own_part(even_parts(count, context), context);
  parallel_for(context, own.size(), grain, [&](size_t k) { body(own.begin + k); });
  bring_items(count, {values.data(), sizeof(T)}, context, first_of);
}

/// The same, one value for each item.
template <class T, class Body>
void share_values(std::vector<T>& values, size_t grain, const Context& context, Body&& body) {
  share_items(
      values.size(), values, grain, context, [](size_t k) { return k; }, body);
}

/// The lists of all ranks, one after the other, on each. Without ranks the own one.
template <class T>
std::vector<T> lists_of_all(std::vector<T> own, const Context& context) {
  Ranks* const ranks = ranks_of(context);
  if (!ranks) return own;
  std::vector<ItemRange> parts;
  size_t end = 0;
  for (const size_t size : of_all(*ranks, own.size())) {
    parts.push_back({end, end + size});
    end += size;
  }
  std::vector<T> all(end);
  std::copy(own.begin(), own.end(),
            all.begin() + static_cast<std::ptrdiff_t>(parts[static_cast<size_t>(ranks->rank())].begin));
  release(own);
  bring_all(*ranks, parts, {{all.data(), sizeof(T)}});
  return all;
}

/// gather() (core/gather.h) by all ranks together: the list is then on each.
template <class T, class Body>
std::vector<T> share_gather(size_t count, size_t grain, const Context& context, Body&& body) {
  const ItemRange own = own_part(even_parts(count, context), context);
  return lists_of_all(
      gather<T>(own.size(), grain, context, [&](size_t k, std::vector<T>& found) { body(own.begin + k, found); }),
      context);
}

/// Joins what ranks have of each value by join(value, of another rank), in the order of the ranks: the result is then
/// on each.
template <class T, class Join>
void join_values(std::vector<T>& values, const Context& context, Join&& join) {
  Ranks* const ranks = ranks_of(context);
  if (!ranks) return;
  const std::vector<ItemRange> parts = even_parts(values.size(), context);
  const auto count = parts.size(), self = static_cast<size_t>(ranks->rank());
  const ItemRange own = parts[self];
  std::vector<T> of_each(count * own.size());
  std::vector<Ranks::Message> out, in;
  for (size_t r = 0; r < count; ++r) {
    if (r == self) continue;
    if (parts[r].size() > 0)
      out.push_back({static_cast<int>(r), values.data() + parts[r].begin, parts[r].size() * sizeof(T)});
    if (own.size() > 0) in.push_back({static_cast<int>(r), of_each.data() + r * own.size(), own.size() * sizeof(T)});
  }
  ranks->exchange(out, in);
  std::copy_n(values.data() + own.begin, own.size(), of_each.data() + self * own.size());
  std::copy_n(of_each.data(), own.size(), values.data() + own.begin);
  for (size_t r = 1; r < count; ++r)
    for (size_t k = 0; k < own.size(); ++k) join(values[own.begin + k], of_each[r * own.size() + k]);
  bring_all(*ranks, parts, {{values.data(), sizeof(T)}});
}

}  // namespace soapfilm
