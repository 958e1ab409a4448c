#include "soapfilm/core/zeroed_memory.h"

#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <array>
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
/// A large page. Arrays that fill one begin at a multiple of it, so that pages move from one to the other in whole
/// large pages. Smaller ones come and go within a stage: the allocator keeps theirs for the next one.
constexpr size_t block_bytes = size_t{1} << 21;
/// Of smaller arrays the ends that fill no block would cost more memory than their blocks save time.
constexpr size_t least_kept_bytes = 16 * block_bytes;

size_t page_bytes() { return static_cast<size_t>(sysconf(_SC_PAGESIZE)); }

/// Anywhere, or in place of what is mapped there; null where the system refuses.
std::byte* map(size_t bytes, std::byte* there = nullptr) {
  const int flags = MAP_PRIVATE | MAP_ANONYMOUS | (there ? MAP_FIXED : 0);
  void* memory = mmap(there, bytes, PROT_READ | PROT_WRITE, flags, -1, 0);
  return memory == MAP_FAILED ? nullptr : static_cast<std::byte*>(memory);
}

/// Address space that begins at a block, all of it untouched; null where the system refuses.
std::byte* map_blocks(size_t bytes) {
  if (bytes > SIZE_MAX / 2) return nullptr;
  const size_t length = rounded_up(bytes, page_bytes());
  std::byte* const reserved = map(length + block_bytes);
  if (!reserved) return nullptr;
  const auto at = reinterpret_cast<uintptr_t>(reserved);
  const size_t before = rounded_up(at, block_bytes) - at;
  std::byte* const memory = reserved + before;
  if (before > 0) munmap(reserved, before);
  munmap(memory + length, block_bytes - before);
  prefer_large_pages(memory, length);
  return memory;
}

/// Whether all pages of a block are there: not untouched, nor given back early.
bool is_resident(std::byte* block) {
  std::array<unsigned char, block_bytes / 4096> pages;
  const size_t count = block_bytes / page_bytes();
  return mincore(block, block_bytes, pages.data()) == 0 &&
         std::all_of(pages.begin(), pages.begin() + static_cast<std::ptrdiff_t>(count),
                     [](unsigned char page) { return (page & 1) != 0; });
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
    if (--keepers_ == 0) unmap_all();
  }

  void clear() {
    const std::lock_guard lock(mutex_);
    unmap_all();
  }

  /// The end of a large array: its blocks are kept where somebody wants them, the rest goes.
  void take_over(std::byte* memory, size_t bytes) {
    const std::lock_guard lock(mutex_);
    size_t rest = bytes;  // from the end on: the first block is taken first, so neighbours stay neighbours
    if (keepers_ > 0 && bytes >= least_kept_bytes)
      for (size_t k = bytes / block_bytes; k-- > 0;) {
        std::byte* const block = memory + k * block_bytes;
        if (!is_resident(block)) continue;
        if (rest > (k + 1) * block_bytes) munmap(block + block_bytes, rest - (k + 1) * block_bytes);
        first_ = new (block) Block{first_};
        rest = k * block_bytes;
      }
    if (rest > 0) munmap(memory, rest);
  }

  /// Blocks that there are move to the front of an untouched array, zero.
  void fill(std::byte* memory, size_t bytes) {
    size_t filled = 0;
    {
      const std::lock_guard lock(mutex_);
      for (; first_ && bytes - filled >= block_bytes; filled += block_bytes)
        if (!move(std::exchange(first_, first_->next), memory + filled)) break;
    }
    std::memset(memory, 0, filled);
  }

 private:
  struct Block {
    Block* next;
  };

  /// The system may refuse, as when it counts too many mappings. What was at `to` may be gone by then.
  static bool move(Block* block, std::byte* to) {
    if (mremap(block, block_bytes, block_bytes, MREMAP_MAYMOVE | MREMAP_FIXED, to) != MAP_FAILED) return true;
    munmap(block, block_bytes);
    if (!map(block_bytes, to)) throw std::bad_alloc();
    return false;
  }

  void unmap_all() {
    while (first_) munmap(std::exchange(first_, first_->next), block_bytes);
  }

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
  if (bytes >= block_bytes) {
    std::byte* address = map_blocks(bytes);
    if (!address) {
      spare_blocks().clear();  // the address space may be what is short
      address = map_blocks(bytes);
      if (!address) throw std::bad_alloc();
    }
    ZeroedMemory memory(address, {bytes});
    spare_blocks().fill(address, bytes);
    return memory;
  }
  void* memory = std::aligned_alloc(alignment, rounded_up(bytes, alignment));
  if (!memory) throw std::bad_alloc();
  std::memset(memory, 0, bytes);
  return ZeroedMemory(static_cast<std::byte*>(memory), {bytes});
}

void FreeZeroed::operator()(std::byte* memory) const {
  if (bytes < block_bytes)
    std::free(memory);
  else
    spare_blocks().take_over(memory, bytes);
}

void give_back(std::byte* begin, std::byte* end) {
  const uintptr_t first = rounded_up(reinterpret_cast<uintptr_t>(begin), page_bytes());
  const uintptr_t last = reinterpret_cast<uintptr_t>(end) / page_bytes() * page_bytes();
  // Advice: where the system does not take it, the pages stay.
  if (first < last) static_cast<void>(madvise(reinterpret_cast<void*>(first), last - first, MADV_DONTNEED));
}

KeepFreedPages::KeepFreedPages() { spare_blocks().keep(); }
KeepFreedPages::~KeepFreedPages() { spare_blocks().let_go(); }

}  // namespace soapfilm
