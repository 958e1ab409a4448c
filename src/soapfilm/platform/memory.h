// The system's data on its memory and on this process. platform/linux uses Linux, platform/portable only the C++
// library.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace soapfilm {

/// Most memory that this process has held at once so far (resident set), in bytes; 0 if unknown.
size_t peak_memory_bytes();

/// Memory that this process holds now, without mapped or shared files, in bytes; 0 if unknown.
size_t held_memory_bytes();

/// Memory that this process can still use without swapping or being killed, in bytes: the system's available memory, or
/// less where a control group (v1 or v2, as of a container) limits it. SIZE_MAX if unknown. `root` is the folder with
/// proc/ and sys/: tests may use their own.
size_t available_memory_bytes(const std::string& root = "/");

/// Asks the system to use large pages for [memory, memory + bytes), not touched yet: fewer page faults, and fewer TLB
/// misses. Advice: if the system ignores it, nothing changes.
void prefer_large_pages(void* memory, size_t bytes);

/// CPU time of the calling thread so far, nanoseconds; elapsed time if unknown.
int64_t thread_cpu_time();
/// Does the system say it?
bool knows_cpu_time();

}  // namespace soapfilm
