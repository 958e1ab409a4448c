// The memory that this process holds now.
#pragma once

#include <malloc.h>

#include <fstream>
#include <string>

namespace soapfilm::test {

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
