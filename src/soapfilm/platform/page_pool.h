// Memory for large arrays, directly from the system: zero without being written, and used page by page.
#pragma once

#include <cstddef>
#include <memory>
#include <string>

namespace soapfilm {

class SpareBlocks;

struct FreeZeroed {
  size_t bytes = 0;
  std::shared_ptr<SpareBlocks> spare;  ///< or null
  int file = -1;                       ///< that holds the contents, open; -1: they are in memory
  void operator()(std::byte* memory) const;
};
using ZeroedMemory = std::unique_ptr<std::byte, FreeZeroed>;

/// For smaller arrays the memory lost at ends that fill no large page outweighs the time saved by keeping their pages.
inline constexpr size_t least_kept_bytes = size_t{12} << 20;

/// The arrays of a run. While a Keep of it lives, the pages of freed arrays of at least `least_kept_bytes`, and all
/// pages given back early, are not returned to the system but reused for the pool's next large arrays and other
/// requests: a fresh page can cost more than the work on it, most of all on virtual machines. The process holds no more
/// pages of arrays than when most of them were in use; other memory, as of most vectors, is additional. Copies are the
/// same pool, which lives until its last array is freed.
class PagePool {
 public:
  /// A new pool.
  static PagePool make();
  /// Whether this platform can reuse pages of freed arrays. If not, arrays are allocated and freed whole by the
  /// allocator, and release_pages() does nothing.
  static bool moves_pages();
  /// No pool: arrays come from the system and are returned to it.
  PagePool() = default;

  /// `bytes` > 0 zero bytes, aligned to 64. Large arrays use no memory until touched, and all of it is returned to the
  /// system when freed, unless a Keep lives. Throws std::bad_alloc.
  ZeroedMemory allocate(size_t bytes) const;

  /// From now on large arrays are files of this folder, mapped: what memory has no room for is read again when it is
  /// used. A file has no name, so nothing is left of it even if the process is killed, and its space is reserved before
  /// it is used: where the disk has too little, allocate() throws OutputError. Empty: in memory again. Kept pages go
  /// back to the system. Has no effect on arrays that exist, nor where the platform lacks it (see platform/scratch.h).
  void use_folder(const std::string& folder) const;

  /// For memory that will soon be written: kept pages, set to zero, are used for large pages of [begin, begin + bytes)
  /// that have not been touched. Throws std::bad_alloc.
  void supply(void* begin, size_t bytes) const;

  /// The largest total size of its arrays at one time, since the last restart; of those in files.
  size_t peak_bytes() const;
  size_t peak_disk_bytes() const;
  void restart_peak() const;

  class Keep {
   public:
    explicit Keep(const PagePool& pool);
    ~Keep();
    Keep(const Keep&) = delete;
    Keep& operator=(const Keep&) = delete;

   private:
    std::shared_ptr<SpareBlocks> spare_;
  };

 private:
  std::shared_ptr<SpareBlocks> spare_;
};

/// For an array that is still in use: bytes before `end` are not read any more, so their pages are returned to the
/// system, or whole large pages to the pool's Keep. Their contents are lost: they may be written, not read. `gone`:
/// bytes given back before. Returns the number given back so far.
size_t release_pages(const ZeroedMemory& memory, size_t gone, size_t end);

/// Of an array in a file: bytes [begin, end) will soon be used, so that they are read in large pieces. Advice. Arrays
/// in memory stay as they are.
void fetch_pages(const ZeroedMemory& memory, size_t begin, size_t end);

}  // namespace soapfilm
