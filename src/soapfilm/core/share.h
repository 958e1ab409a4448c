// Loops whose items ranks share, each taking as many: for what all of them have whole.
#pragma once

#include <vector>

#include "soapfilm/context.h"
#include "soapfilm/core/context_state.h"
#include "soapfilm/core/parallel.h"
#include "soapfilm/core/ranks.h"

namespace soapfilm {

/// About as many items for each rank; without ranks one part, all.
inline std::vector<ItemRange> even_parts(size_t count, const Context& context) {
  const Ranks* const ranks = ranks_of(context);
  const size_t parts = ranks ? static_cast<size_t>(ranks->count()) : 1;
  std::vector<ItemRange> found;
  for (size_t r = 0; r < parts; ++r) found.push_back({count * r / parts, count * (r + 1) / parts});
  return found;
}

/// Calls body(k) for each k < `count`, on all ranks together, `grain` of them per task. What it writes are values
/// [first_of(k), first_of(k + 1)): those of all items are then on each rank.
template <class T, class First, class Body>
void share_items(size_t count, std::vector<T>& values, size_t grain, const Context& context, First&& first_of,
                 Body&& body) {
  const std::vector<ItemRange> parts = even_parts(count, context);
  Ranks* const ranks = ranks_of(context);
  const ItemRange own = parts[ranks ? static_cast<size_t>(ranks->rank()) : 0];
  parallel_for(context, own.size(), grain, [&](size_t k) { body(own.begin + k); });
  if (!ranks) return;
  std::vector<ItemRange> written;
  for (const ItemRange& part : parts) written.push_back({first_of(part.begin), first_of(part.end)});
  bring_all(*ranks, written, {{values.data(), sizeof(T)}});
}

/// The same, one value for each item.
template <class T, class Body>
void share_values(std::vector<T>& values, size_t grain, const Context& context, Body&& body) {
  share_items(
      values.size(), values, grain, context, [](size_t k) { return k; }, body);
}

}  // namespace soapfilm
