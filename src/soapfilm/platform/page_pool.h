// Memory for large arrays, straight from the system: zero without being written, and taken page by page.
#pragma once

#include <cstddef>
#include <memory>

namespace soapfilm {

class SpareBlocks;

struct FreeZeroed {
  size_t bytes = 0;
  std::shared_ptr<SpareBlocks> spare;  ///< or null
  void operator()(std::byte* memory) const;
};
using ZeroedMemory = std::unique_ptr<std::byte, FreeZeroed>;

/// Of smaller arrays the ends that fill no large page would cost more memory than keeping their pages saves time.
inline constexpr size_t least_kept_bytes = size_t{12} << 20;

/// The arrays of a run. While a Keep of it lives, pages of arrays of `least_kept_bytes` and more that are freed, and of
/// any that are given back early, do not go back to the system but serve the pool's next large arrays, and whatever
/// else asks for them: a fresh page can cost more than the work on it, most of all on virtual machines. The process
/// holds no more pages of arrays than it did when most of them were in use; what it takes otherwise meanwhile, as for
/// most vectors, comes on top. Copies are the same pool, which lives until its last array is freed.
class PagePool {
 public:
  /// A pool of its own.
  static PagePool make();
  /// Can this platform keep pages of freed arrays for others? Elsewhere arrays come from the allocator and go back to
  /// it whole, and give_back() does nothing.
  static bool moves_pages();
  /// None: arrays come from the system and go back to it.
  PagePool() = default;

  /// `bytes` > 0 zero bytes, aligned to 64. What is large costs no memory until it is touched, and all of it goes back
  /// to the system when it is freed, unless a Keep lives. Throws std::bad_alloc.
  ZeroedMemory allocate(size_t bytes) const;

  /// Memory that is about to be written: pages that were kept, zero, serve large pages of [begin, begin + bytes) of
  /// which nothing has been touched. Throws std::bad_alloc.
  void serve(void* begin, size_t bytes) const;

  /// The most that its arrays took at once so far, since it was last restarted.
  size_t peak_bytes() const;
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

/// Of an array that lives on, bytes before `end` are not read any more: their pages go back to the system, or those of
/// whole large pages to the pool's Keep. What they held is lost: it may be written, not read. `gone`: bytes that went
/// before. Returns how many have gone by now.
size_t give_back(const ZeroedMemory& memory, size_t gone, size_t end);

}  // namespace soapfilm
