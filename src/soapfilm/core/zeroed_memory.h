// Memory for large arrays, straight from the system: zero without being written, and taken page by page.
#pragma once

#include <cstddef>
#include <memory>

namespace soapfilm {

struct FreeZeroed {
  size_t bytes = 0;
  void operator()(std::byte* memory) const;
};
using ZeroedMemory = std::unique_ptr<std::byte, FreeZeroed>;

/// `bytes` > 0 zero bytes, aligned to 64. What is large costs no memory until it is touched, and all of it goes back to
/// the system when it is freed, unless a KeepFreedPages lives. Throws std::bad_alloc.
ZeroedMemory allocate_zeroed(size_t bytes);

/// Of an array that lives on, bytes before `end` are not read any more: their pages go back to the system, or those of
/// whole large pages to a KeepFreedPages. What they held is lost: it may be written, not read. `gone`: bytes that went
/// before. Returns how many have gone by now.
size_t give_back(const ZeroedMemory& memory, size_t gone, size_t end);

/// Memory that is about to be written: pages that a KeepFreedPages has, zero, serve large pages of [begin, begin +
/// bytes) of which nothing has been touched. Throws std::bad_alloc.
void take_pages(void* begin, size_t bytes);

/// Of smaller arrays the ends that fill no large page would cost more memory than keeping their pages saves time.
inline constexpr size_t least_kept_bytes = size_t{12} << 20;

/// While one lives, anywhere in the process, pages of arrays of `least_kept_bytes` and more that are freed, and of any
/// that are given back early, do not go back to the system but serve the next large arrays, and whatever takes pages: a
/// fresh page can cost more than the work on it, most of all on virtual machines. The process holds no more pages of
/// arrays than it did when most of them were in use; what it takes otherwise meanwhile, as for most vectors, comes on
/// top.
class KeepFreedPages {
 public:
  KeepFreedPages();
  ~KeepFreedPages();
  KeepFreedPages(const KeepFreedPages&) = delete;
  KeepFreedPages& operator=(const KeepFreedPages&) = delete;
};

}  // namespace soapfilm
