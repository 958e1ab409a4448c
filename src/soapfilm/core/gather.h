// Lists and sums computed by several threads, independent of their number.
#pragma once

#include <cstddef>
#include <vector>

#include "soapfilm/core/parallel.h"

namespace soapfilm {

/// What body(i, found) appends to the vector `found` for each i in [0, count), `grain` of them per task, in the order
/// of i.
template <class T, class Body>
std::vector<T> gather(size_t count, size_t grain, const Context& context, Body&& body) {
  std::vector<std::vector<T>> found((count + grain - 1) / grain);
  parallel_chunks(context, count, grain, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) body(i, found[begin / grain]);
  });
  size_t total = 0;
  for (const std::vector<T>& part : found) total += part.size();
  std::vector<T> all;
  all.reserve(total);
  for (const std::vector<T>& part : found) all.insert(all.end(), part.begin(), part.end());
  return all;
}

/// The results of part(begin, end) for chunks of [0, count), `grain` each, joined in order by join(whole, part),
/// starting from T{}.
template <class T, class Part, class Join>
T join_chunks(size_t count, size_t grain, const Context& context, Part&& part, Join&& join) {
  std::vector<T> parts((count + grain - 1) / grain);
  parallel_chunks(context, count, grain, [&](size_t begin, size_t end) { parts[begin / grain] = part(begin, end); });
  T whole{};
  for (const T& p : parts) join(whole, p);
  return whole;
}

/// The same, joined by +=.
template <class T, class Part>
T sum_chunks(size_t count, size_t grain, const Context& context, Part&& part) {
  return join_chunks<T>(count, grain, context, part, [](T& whole, const T& p) { whole += p; });
}

}  // namespace soapfilm
