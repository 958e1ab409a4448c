// Vectors on the pages of a run, and memory sizes as text.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "soapfilm/platform/memory.h"
#include "soapfilm/platform/page_pool.h"

namespace soapfilm {

/// Empties a vector and frees its memory. (`v = {}` keeps it: that assigns an empty initializer list.)
template <class T>
void release(std::vector<T>& values) {
  std::vector<T>().swap(values);
}

/// Reserves `count` values in an empty vector, for many values on large pages, from the pool if it has some.
template <class T>
void reserve_many(std::vector<T>& values, size_t count, const PagePool& pages = {}) {
  values.reserve(count);
  prefer_large_pages(values.data(), count * sizeof(T));
  if (count * sizeof(T) >= least_kept_bytes) pages.supply(values.data(), count * sizeof(T));
}

/// Reads "600M", "2G", "1.5GiB", "800 MB" or plain bytes. K, M, G, T and KiB, MiB, GiB, TiB are powers of 1024; KB, MB,
/// GB, TB powers of 1000; upper or lower case. Throws ParameterError unless it is a size of at least one byte.
size_t parse_memory(std::string_view text);

/// Three significant digits in the largest fitting power of 1024: "512 B", "1.50 GiB", "613 MiB".
std::string format_bytes(uint64_t bytes);

}  // namespace soapfilm
