#include "soapfilm/core/zeroed_memory.h"

#include <sys/mman.h>
#include <unistd.h>

#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <mutex>
#include <new>
#include <utility>

#include "soapfilm/core/memory.h"

namespace soapfilm {

namespace {

constexpr size_t alignment = 64;
/// Smaller arrays come and go within a stage: the allocator keeps theirs for the next one.
constexpr size_t large_bytes = size_t{1} << 21;
/// What large arrays begin at a multiple of, so that pages move from one to the other in whole large pages.
constexpr size_t block_bytes = size_t{1} << 21;

size_t page_bytes() { return static_cast<size_t>(sysconf(_SC_PAGESIZE)); }

/// Anywhere, or in place of what is mapped there.
std::byte* map(size_t bytes, std::byte* there = nullptr) {
  const int flags = MAP_PRIVATE | MAP_ANONYMOUS | (there ? MAP_FIXED : 0);
  void* memory = mmap(there, bytes, PROT_READ | PROT_WRITE, flags, -1, 0);
  if (memory == MAP_FAILED) throw std::bad_alloc();
  return static_cast<std::byte*>(memory);
}

/// Address space that begins at a block, all of it untouched.
std::byte* map_blocks(size_t bytes) {
  const size_t length = rounded_up(bytes, page_bytes());
  if (length > SIZE_MAX - block_bytes) throw std::bad_alloc();
  std::byte* const reserved = map(length + block_bytes);
  const auto at = reinterpret_cast<uintptr_t>(reserved);
  const size_t before = rounded_up(at, block_bytes) - at;
  std::byte* const memory = reserved + before;
  if (before > 0) munmap(reserved, before);
  munmap(memory + length, block_bytes - before);
  prefer_large_pages(memory, length);
  return memory;
}

/// Blocks of freed arrays, a list that lies in the blocks themselves: freeing needs no memory.
class SpareBlocks {
 public:
  void keep() {
    const std::lock_guard lock(mutex_);
    ++keepers_;
  }

  void let_go() {
    const std::lock_guard lock(mutex_);
    if (--keepers_ > 0) return;
    while (first_) munmap(take(), block_bytes);
  }

  /// Takes over an array's whole blocks, where somebody keeps them; returns how many bytes of it.
  size_t add(std::byte* memory, size_t bytes) {
    const std::lock_guard lock(mutex_);
    if (keepers_ == 0) return 0;
    const size_t count = bytes / block_bytes;
    // The array's first one is taken first: neighbours that stay neighbours stay one mapping of the system's.
    for (size_t k = count; k-- > 0;) first_ = new (memory + k * block_bytes) Block{first_};
    return count * block_bytes;
  }

  /// Blocks that there are move to the front of an untouched array, zero.
  void fill(std::byte* memory, size_t bytes) {
    size_t filled = 0;
    {
      const std::lock_guard lock(mutex_);
      for (; first_ && bytes - filled >= block_bytes; filled += block_bytes) {
        Block* const block = take();
        if (mremap(block, block_bytes, block_bytes, MREMAP_MAYMOVE | MREMAP_FIXED, memory + filled) != MAP_FAILED)
          continue;
        munmap(block, block_bytes);
        // What was there may be gone by now.
        map(block_bytes, memory + filled);
      }
    }
    std::memset(memory, 0, filled);
  }

 private:
  struct Block {
    Block* next;
  };

  Block* take() { return std::exchange(first_, first_->next); }

  std::mutex mutex_;
  int keepers_ = 0;
  Block* first_ = nullptr;
};

SpareBlocks& spare_blocks() {
  static SpareBlocks blocks;
  return blocks;
}

}  // namespace

ZeroedMemory allocate_zeroed(size_t bytes) {
  if (bytes >= large_bytes) {
    ZeroedMemory memory(map_blocks(bytes), {bytes});
    spare_blocks().fill(memory.get(), bytes);
    return memory;
  }
  void* memory = std::aligned_alloc(alignment, rounded_up(bytes, alignment));
  if (!memory) throw std::bad_alloc();
  std::memset(memory, 0, bytes);
  return ZeroedMemory(static_cast<std::byte*>(memory), {bytes});
}

void FreeZeroed::operator()(std::byte* memory) const {
  if (bytes < large_bytes) {
    std::free(memory);
    return;
  }
  const size_t kept = has_holes ? 0 : spare_blocks().add(memory, bytes);
  if (kept < bytes) munmap(memory + kept, bytes - kept);
}

void give_back(ZeroedMemory& memory, size_t begin, size_t end) {
  const auto at = reinterpret_cast<uintptr_t>(memory.get());
  const uintptr_t first = rounded_up(at + begin, page_bytes()), last = (at + end) / page_bytes() * page_bytes();
  if (first >= last) return;
  memory.get_deleter().has_holes = true;
  // Advice: where the system does not take it, the pages stay.
  static_cast<void>(madvise(reinterpret_cast<void*>(first), last - first, MADV_DONTNEED));
}

KeepFreedPages::KeepFreedPages() { spare_blocks().keep(); }
KeepFreedPages::~KeepFreedPages() { spare_blocks().let_go(); }

}  // namespace soapfilm
