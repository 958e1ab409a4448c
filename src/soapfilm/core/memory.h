// What the machine has, what this process used, and memory sizes as people write them.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "soapfilm/core/page_pool.h"

namespace soapfilm {

/// Most memory that this process has held at once so far (resident set), in bytes.
size_t peak_memory_bytes();

/// Memory that this process holds now, beside files that are mapped or shared, in bytes; 0 where the system does not
/// say.
size_t held_memory_bytes();

/// Memory that this process can still take without swapping or being killed, in bytes: what the system has available,
/// or less where a control group (v1 or v2, such as a container's) limits it. SIZE_MAX where the system does not say.
/// `root` is where proc/ and sys/ lie: a test may bring its own.
size_t available_memory_bytes(const std::string& root = "/");

/// Empties a vector and hands its memory back. (`v = {}` keeps it: that assigns an empty initializer list.)
template <class T>
void release(std::vector<T>& values) {
  std::vector<T>().swap(values);
}

/// The first multiple of `unit` that is not below `bytes`.
constexpr size_t rounded_up(size_t bytes, size_t unit) { return (bytes + unit - 1) / unit * unit; }

/// Asks the system to back [memory, memory + bytes), not touched yet, with large pages: fewer faults, and fewer misses
/// of the address cache. Advice: where the system does not take it, nothing changes.
void prefer_large_pages(void* memory, size_t bytes);

/// Room for `count` values in an empty vector, on large pages where there are many, and on such as the pool has.
template <class T>
void reserve_many(std::vector<T>& values, size_t count, const PagePool& pages = {}) {
  values.reserve(count);
  prefer_large_pages(values.data(), count * sizeof(T));
  if (count * sizeof(T) >= least_kept_bytes) pages.serve(values.data(), count * sizeof(T));
}

/// Reads "600M", "2G", "1.5GiB", "800 MB" or plain bytes. K, M, G, T and KiB, MiB, GiB, TiB are powers of 1024; KB, MB,
/// GB, TB powers of 1000; upper or lower case. Throws ParameterError unless it is a size of at least one byte.
size_t parse_memory(std::string_view text);

/// Three significant digits in the largest fitting power of 1024: "512 B", "1.50 GiB", "613 MiB".
std::string format_bytes(size_t bytes);

}  // namespace soapfilm
