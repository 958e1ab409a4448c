// What the system says of its memory and of this process. platform/linux asks Linux, platform/portable the C++ library
// alone.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace soapfilm {

/// Most memory that this process has held at once so far (resident set), in bytes; 0 where the system does not say.
size_t peak_memory_bytes();

/// Memory that this process holds now, beside files that are mapped or shared, in bytes; 0 where the system does not
/// say.
size_t held_memory_bytes();

/// Memory that this process can still take without swapping or being killed, in bytes: what the system has available,
/// or less where a control group (v1 or v2, such as a container's) limits it. SIZE_MAX where the system does not say.
/// `root` is where proc/ and sys/ lie: a test may bring its own.
size_t available_memory_bytes(const std::string& root = "/");

/// Asks the system to back [memory, memory + bytes), not touched yet, with large pages: fewer faults, and fewer misses
/// of the address cache. Advice: where the system does not take it, nothing changes.
void prefer_large_pages(void* memory, size_t bytes);

/// CPU time that the calling thread has taken so far, nanoseconds; elapsed time where the system does not say.
int64_t thread_cpu_time();

}  // namespace soapfilm
