// The memory that this process holds now.
#pragma once

#include <malloc.h>

#include <fstream>
#include <string>

namespace soapfilm::test {

/// As the program does (cli/main.cpp): else peaks depend on what the allocator has seen before.
inline void give_arrays_pages_of_their_own() { mallopt(M_MMAP_THRESHOLD, 1 << 20); }

/// In bytes, after the allocator has returned its unused memory.
inline double resident_bytes() {
  malloc_trim(0);
  std::ifstream rollup("/proc/self/smaps_rollup");
  std::string word;
  while (rollup >> word && word != "Rss:") {
  }
  double kilobytes = 0;
  rollup >> kilobytes;
  return 1024 * kilobytes;
}

}  // namespace soapfilm::test
