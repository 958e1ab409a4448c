#include "soapfilm/core/zeroed_memory.h"

#include <sys/mman.h>
#include <unistd.h>

#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <new>

#include "soapfilm/core/memory.h"

namespace soapfilm {

namespace {

constexpr size_t alignment = 64;
/// Smaller arrays come and go within a stage: the allocator keeps theirs for the next one.
constexpr size_t large_bytes = size_t{1} << 21;

}  // namespace

ZeroedMemory allocate_zeroed(size_t bytes) {
  if (bytes >= large_bytes) {
    void* memory = mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (memory == MAP_FAILED) throw std::bad_alloc();
    prefer_large_pages(memory, bytes);
    return ZeroedMemory(static_cast<std::byte*>(memory), {bytes});
  }
  void* memory = std::aligned_alloc(alignment, rounded_up(bytes, alignment));
  if (!memory) throw std::bad_alloc();
  std::memset(memory, 0, bytes);
  return ZeroedMemory(static_cast<std::byte*>(memory), {bytes});
}

void FreeZeroed::operator()(std::byte* memory) const {
  if (bytes >= large_bytes)
    munmap(memory, bytes);
  else
    std::free(memory);
}

void give_back(std::byte* begin, std::byte* end) {
  const auto page = static_cast<uintptr_t>(sysconf(_SC_PAGESIZE));
  const uintptr_t first = rounded_up(reinterpret_cast<uintptr_t>(begin), page);
  const uintptr_t last = reinterpret_cast<uintptr_t>(end) / page * page;
  // Advice: where the system does not take it, the pages stay.
  if (first < last) static_cast<void>(madvise(reinterpret_cast<void*>(first), last - first, MADV_DONTNEED));
}

}  // namespace soapfilm
