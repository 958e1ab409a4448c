// The memory data available from the C++ library alone: almost none.
#include "soapfilm/platform/memory.h"

#include <chrono>

namespace soapfilm {

size_t peak_memory_bytes() { return 0; }

size_t held_memory_bytes() { return 0; }

size_t available_memory_bytes(const std::string&) { return SIZE_MAX; }

void prefer_large_pages(void*, size_t) {}

bool knows_cpu_time() { return false; }

int64_t thread_cpu_time() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

}  // namespace soapfilm
