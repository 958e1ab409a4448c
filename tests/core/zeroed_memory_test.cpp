#include "soapfilm/core/zeroed_memory.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <new>
#include <vector>

namespace soapfilm {
namespace TEST_FILE {

TEST(ZeroedMemory, IsZeroAlignedAndWritable) {
  for (const size_t bytes : {size_t{1}, size_t{100}, size_t{1} << 20, (size_t{1} << 21) - 1, (size_t{1} << 22) + 5}) {
    for (int again = 0; again < 2; ++again) {  // memory that was used before, too
      const ZeroedMemory memory = allocate_zeroed(bytes);
      EXPECT_EQ(reinterpret_cast<uintptr_t>(memory.get()) % 64, 0u);
      EXPECT_EQ(std::count(memory.get(), memory.get() + bytes, std::byte{0}), static_cast<ptrdiff_t>(bytes));
      std::memset(memory.get(), 0xFF, bytes);
    }
  }
}

TEST(ZeroedMemory, WhatIsNotGivenBackStays) {
  constexpr size_t bytes = size_t{1} << 22, first = 100'000, last = 3'000'001;
  ZeroedMemory memory = allocate_zeroed(bytes);
  std::memset(memory.get(), 0x5A, bytes);
  give_back(memory, first, last);
  give_back(memory, 5, 6);  // less than a page: nothing
  EXPECT_EQ(std::count(memory.get(), memory.get() + first, std::byte{0x5A}), static_cast<ptrdiff_t>(first));
  EXPECT_EQ(std::count(memory.get() + last, memory.get() + bytes, std::byte{0x5A}),
            static_cast<ptrdiff_t>(bytes - last));
  std::memset(memory.get(), 1, bytes);  // and it may be written again
}

size_t resident_bytes() {
  std::ifstream statm("/proc/self/statm");
  size_t size = 0, resident = 0;
  statm >> size >> resident;
  return resident * static_cast<size_t>(sysconf(_SC_PAGESIZE));
}

TEST(ZeroedMemory, KeptPagesServeTheNextArraysAndThenGoBack) {
  constexpr size_t bytes = (size_t{64} << 20) + 12345, rest = size_t{2} << 20;
  constexpr size_t slack = size_t{6} << 20;
  const size_t before = resident_bytes();
  {
    const KeepFreedPages keep;
    {
      const KeepFreedPages also;
      ZeroedMemory with_holes = allocate_zeroed(bytes);
      std::memset(with_holes.get(), 1, bytes);
      give_back(with_holes, 0, bytes / 2);
      const ZeroedMemory first = allocate_zeroed(bytes);
      std::memset(first.get(), 2, bytes);
    }
    EXPECT_NEAR(static_cast<double>(resident_bytes()), static_cast<double>(before + bytes), slack);
    // In pieces, large and small, all of them zero.
    std::vector<ZeroedMemory> pieces;
    for (const size_t size : {3 * rest + 1, size_t{1000}, 10 * rest, rest, bytes - 14 * rest}) {
      pieces.push_back(allocate_zeroed(size));
      const std::byte* const piece = pieces.back().get();
      EXPECT_EQ(reinterpret_cast<uintptr_t>(piece) % 64, 0u);
      EXPECT_EQ(std::count(piece, piece + size, std::byte{0}), static_cast<ptrdiff_t>(size));
      std::memset(pieces.back().get(), 3, size);
    }
    EXPECT_NEAR(static_cast<double>(resident_bytes()), static_cast<double>(before + bytes), slack);
    pieces.erase(pieces.begin() + 2);
    const ZeroedMemory more = allocate_zeroed(2 * bytes);  // more than there is
    EXPECT_EQ(std::count(more.get(), more.get() + 2 * bytes, std::byte{0}), static_cast<ptrdiff_t>(2 * bytes));
  }
  EXPECT_NEAR(static_cast<double>(resident_bytes()), static_cast<double>(before), slack);
}

TEST(ZeroedMemory, TooMuchIsRefused) { EXPECT_THROW(allocate_zeroed(SIZE_MAX / 2), std::bad_alloc); }

}  // namespace TEST_FILE
}  // namespace soapfilm
