#include "soapfilm/platform/page_pool.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <mutex>
#include <new>
#include <utility>

#include "soapfilm/platform/array_bytes.h"
#include "soapfilm/platform/memory.h"
#include "soapfilm/platform/scratch.h"

namespace soapfilm {

namespace {

constexpr size_t alignment = 64;
/// Size of a large page. Arrays of at least this size begin at a multiple of it, so that pages move between arrays as
/// whole large pages. Smaller arrays are allocated and freed within a stage: the allocator keeps their memory for the
/// next one.
constexpr size_t block_bytes = size_t{1} << 21;

constexpr size_t rounded_up(size_t bytes, size_t unit) { return (bytes + unit - 1) / unit * unit; }

size_t page_bytes() { return static_cast<size_t>(sysconf(_SC_PAGESIZE)); }

/// Maps memory anywhere, or replaces the mapping at `there`; null if the system refuses.
std::byte* map(size_t bytes, std::byte* there = nullptr) {
  const int flags = MAP_PRIVATE | MAP_ANONYMOUS | (there ? MAP_FIXED : 0);
  void* memory = mmap(there, bytes, PROT_READ | PROT_WRITE, flags, -1, 0);
  return memory == MAP_FAILED ? nullptr : static_cast<std::byte*>(memory);
}

/// Address space that begins at a block, all of it untouched; null if the system refuses.
std::byte* reserve_blocks(size_t bytes) {
  if (bytes > SIZE_MAX / 2) return nullptr;
  const size_t length = rounded_up(bytes, page_bytes());
  std::byte* const reserved = map(length + block_bytes);
  if (!reserved) return nullptr;
  const auto at = reinterpret_cast<uintptr_t>(reserved);
  const size_t before = rounded_up(at, block_bytes) - at;
  std::byte* const memory = reserved + before;
  if (before > 0) munmap(reserved, before);
  munmap(memory + length, block_bytes - before);
  return memory;
}

std::byte* map_blocks(size_t bytes) {
  std::byte* const memory = reserve_blocks(bytes);
  if (memory) prefer_large_pages(memory, rounded_up(bytes, page_bytes()));
  return memory;
}

/// The same with the contents of a file; null if the system refuses. Pages of the file in memory are large, too, where
/// the file system can: what is spent on each page is most of the cost.
std::byte* map_file(int file, size_t bytes) {
  std::byte* const memory = reserve_blocks(bytes);
  if (!memory) return nullptr;
  const size_t length = rounded_up(bytes, page_bytes());
  if (mmap(memory, length, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_FIXED, file, 0) != MAP_FAILED) {
    prefer_large_pages(memory, length);
    return memory;
  }
  munmap(memory, length);
  return nullptr;
}

/// Number of resident pages of a block: those that were touched and not freed early.
size_t resident_pages(std::byte* block) {
  std::array<unsigned char, block_bytes / 4096> pages{};
  if (mincore(block, block_bytes, pages.data()) != 0) return 0;
  return static_cast<size_t>(std::count_if(pages.begin(), pages.end(), [](unsigned char page) { return page & 1; }));
}
bool is_resident(std::byte* block) { return resident_pages(block) == block_bytes / page_bytes(); }

std::byte* next_block(void* memory) {
  return reinterpret_cast<std::byte*>(rounded_up(reinterpret_cast<uintptr_t>(memory), block_bytes));
}

}  // namespace

/// Blocks of freed arrays, as a list stored in the blocks themselves: freeing needs no memory.
class SpareBlocks {
 public:
  SpareBlocks() = default;
  SpareBlocks(const SpareBlocks&) = delete;
  SpareBlocks& operator=(const SpareBlocks&) = delete;

  ArrayBytes arrays, on_disk;

  void use_folder(const std::string& folder) {
    const std::lock_guard lock(mutex_);
    folder_ = folder;
    if (!folder_.empty()) unmap_all();
  }
  std::string folder() {
    const std::lock_guard lock(mutex_);
    return folder_;
  }

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

  /// Frees a large array: its blocks are kept if a Keep lives, the rest is returned to the system.
  void take_over(std::byte* memory, size_t bytes) {
    const std::lock_guard lock(mutex_);
    size_t rest = bytes;  // from the end on: the first block is reused first, so neighbors stay neighbors
    if (keepers_ > 0 && folder_.empty() && bytes >= least_kept_bytes)
      for (size_t k = bytes / block_bytes; k-- > 0;) {
        std::byte* const block = memory + k * block_bytes;
        if (!is_resident(block)) continue;
        if (rest > (k + 1) * block_bytes) munmap(block + block_bytes, rest - (k + 1) * block_bytes);
        first_ = new (block) Block{first_};
        rest = k * block_bytes;
      }
    if (rest > 0) munmap(memory, rest);
  }

  /// Takes some blocks of an array that is still in use: untouched blocks replace them. False if the system cannot do
  /// that, or no Keep lives.
  bool take_over_early(std::byte* begin, std::byte* end) {
    const std::lock_guard lock(mutex_);
    if (keepers_ == 0 || !folder_.empty()) return false;
    for (; begin < end; begin += block_bytes) {
      if (!is_resident(begin)) {
        static_cast<void>(madvise(begin, block_bytes, MADV_DONTNEED));
        continue;
      }
      std::byte* const block = map_blocks(block_bytes);
      if (!block) return false;
      if (mremap(begin, block_bytes, block_bytes, MREMAP_MAYMOVE | MREMAP_FIXED | MREMAP_DONTUNMAP, block) ==
          MAP_FAILED) {
        // An old kernel refuses at once. After any other failure `block` may be unmapped, and used by something else.
        if (errno == EINVAL) munmap(block, block_bytes);
        return false;
      }
      first_ = new (block) Block{first_};
    }
    return true;
  }

  /// Moves kept blocks, set to zero, in place of blocks without resident pages. `fresh`: all of these are untouched.
  void fill(std::byte* begin, std::byte* end, bool fresh) {
    for (std::byte* to = next_block(begin); to < end && static_cast<size_t>(end - to) >= block_bytes;
         to += block_bytes) {
      {
        const std::lock_guard lock(mutex_);
        if (!first_) return;
        if (!fresh && resident_pages(to) > 0) continue;
        if (!move(std::exchange(first_, first_->next), to)) return;
      }
      std::memset(to, 0, block_bytes);
    }
  }

 private:
  struct Block {
    Block* next;
  };

  /// The system may refuse, for example because of too many mappings. The memory at `to` may be unmapped by then.
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
  std::string folder_;  // of arrays on disk; empty: none are, and only then blocks are kept
  int keepers_ = 0;
  Block* first_ = nullptr;
};

namespace {

ZeroedMemory allocate_on_disk(size_t bytes, const std::string& folder, const std::shared_ptr<SpareBlocks>& spare) {
  const int file = make_scratch_file(folder, bytes);
  std::byte* const address = map_file(file, bytes);
  if (!address) {
    close_scratch_file(file);
    throw std::bad_alloc();
  }
  spare->arrays.add(bytes);
  spare->on_disk.add(bytes);
  return ZeroedMemory(address, {bytes, spare, file});
}

/// [begin, end) in whole pages, within the array.
template <class Advise>
void advise_pages(const ZeroedMemory& memory, size_t begin, size_t end, Advise&& advise) {
  if (!memory || memory.get_deleter().file < 0) return;
  const size_t first = begin / page_bytes() * page_bytes(), last = std::min(end, memory.get_deleter().bytes);
  if (first < last) advise(memory.get() + first, rounded_up(last - first, page_bytes()));
}

}  // namespace

ZeroedMemory PagePool::allocate(size_t bytes) const {
  std::byte* address = nullptr;
  if (bytes >= block_bytes && spare_)
    if (const std::string folder = spare_->folder(); !folder.empty()) return allocate_on_disk(bytes, folder, spare_);
  if (bytes >= block_bytes) {
    address = map_blocks(bytes);
    if (!address && spare_) {
      spare_->clear();  // the address space may be exhausted
      address = map_blocks(bytes);
    }
    if (!address) throw std::bad_alloc();
  } else {
    address = static_cast<std::byte*>(std::aligned_alloc(alignment, rounded_up(bytes, alignment)));
    if (!address) throw std::bad_alloc();
    std::memset(address, 0, bytes);
  }
  ZeroedMemory memory(address, {bytes, spare_, -1});
  if (!spare_) return memory;
  spare_->arrays.add(bytes);
  if (bytes >= block_bytes) spare_->fill(address, address + bytes, true);
  return memory;
}

void FreeZeroed::operator()(std::byte* memory) const {
  if (file >= 0) {
    munmap(memory, bytes);
    close_scratch_file(file);
    spare->on_disk.remove(bytes);
  } else if (bytes < block_bytes)
    std::free(memory);
  else if (spare)
    spare->take_over(memory, bytes);
  else
    munmap(memory, bytes);
  if (spare) spare->arrays.remove(bytes);
}

size_t release_pages(const ZeroedMemory& memory, size_t gone, size_t end) {
  const auto& [bytes, spare, file] = memory.get_deleter();
  if (bytes < block_bytes) return gone;  // belongs to the allocator
  // Arrays of at least one block begin at a block.
  const size_t blocks_end = end / block_bytes * block_bytes, pages_end = end / page_bytes() * page_bytes();
  if (gone >= blocks_end) return gone;
  if (file >= 0) {  // zero without being written, and still reserved
    const auto from = static_cast<off_t>(gone), length = static_cast<off_t>(pages_end - gone);
    return fallocate(file, FALLOC_FL_ZERO_RANGE | FALLOC_FL_KEEP_SIZE, from, length) == 0 ? pages_end : gone;
  }
  if (spare && spare->take_over_early(memory.get() + gone / block_bytes * block_bytes, memory.get() + blocks_end))
    return blocks_end;
  // Advice: if the system ignores it, the pages stay.
  static_cast<void>(madvise(memory.get() + gone, pages_end - gone, MADV_DONTNEED));
  return pages_end;
}

/// A page that is read first and written then costs a tenth of one that is written at once: measured 0.1 and 0.6 to 1.6
/// CPU seconds a gigabyte.
void fetch_pages(const ZeroedMemory& memory, size_t begin, size_t end) {
  advise_pages(memory, begin, end, [](std::byte* first, size_t bytes) {
#ifdef MADV_POPULATE_READ
    if (madvise(first, bytes, MADV_POPULATE_READ) == 0) return;  // else an old kernel
#endif
    static_cast<void>(madvise(first, bytes, MADV_WILLNEED));
  });
}

void PagePool::use_folder(const std::string& folder) const {
  if (spare_) spare_->use_folder(folder);
}

bool PagePool::moves_pages() { return true; }

PagePool PagePool::make() {
  PagePool pool;
  pool.spare_ = std::make_shared<SpareBlocks>();
  return pool;
}

void PagePool::supply(void* begin, size_t bytes) const {
  auto* const first = static_cast<std::byte*>(begin);
  if (spare_) spare_->fill(first, first + bytes, false);
}

size_t PagePool::peak_bytes() const { return spare_ ? spare_->arrays.peak() : 0; }

size_t PagePool::peak_disk_bytes() const { return spare_ ? spare_->on_disk.peak() : 0; }

void PagePool::restart_peak() const {
  if (!spare_) return;
  spare_->arrays.restart_peak();
  spare_->on_disk.restart_peak();
}

PagePool::Keep::Keep(const PagePool& pool) : spare_(pool.spare_) {
  if (spare_) spare_->keep();
}
PagePool::Keep::~Keep() {
  if (spare_) spare_->let_go();
}

}  // namespace soapfilm
