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

/// Hands the pages that lie wholly in [begin, end) of an array back to the system before it is freed. What
/// they held is lost: it may be written, not read.
void give_back(std::byte* begin, std::byte* end);

/// While one lives, anywhere in the process, pages of arrays of 32 MiB and more that are freed do not go back to the
/// system but serve the next large arrays: a fresh page can cost more than the work on it, most of all on virtual
/// machines. The process holds no more pages of arrays than it did when most of them were in use; what it takes
/// otherwise meanwhile, as for vectors, comes on top.
class KeepFreedPages {
 public:
  KeepFreedPages();
  ~KeepFreedPages();
  KeepFreedPages(const KeepFreedPages&) = delete;
  KeepFreedPages& operator=(const KeepFreedPages&) = delete;
};

}  // namespace soapfilm
