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
/// the system when it is freed. Throws std::bad_alloc.
ZeroedMemory allocate_zeroed(size_t bytes);

/// Hands the pages that lie wholly in [begin, end) of an array back to the system before it is freed. What
/// they held is lost: it may be written, not read.
void give_back(std::byte* begin, std::byte* end);

}  // namespace soapfilm
