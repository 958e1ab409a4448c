#include "soapfilm/core/zeroed_memory.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <new>

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
  const ZeroedMemory memory = allocate_zeroed(bytes);
  std::memset(memory.get(), 0x5A, bytes);
  give_back(memory.get() + first, memory.get() + last);
  give_back(memory.get() + 5, memory.get() + 6);  // less than a page: nothing
  EXPECT_EQ(std::count(memory.get(), memory.get() + first, std::byte{0x5A}), static_cast<ptrdiff_t>(first));
  EXPECT_EQ(std::count(memory.get() + last, memory.get() + bytes, std::byte{0x5A}),
            static_cast<ptrdiff_t>(bytes - last));
  std::memset(memory.get(), 1, bytes);  // and it may be written again
}

TEST(ZeroedMemory, TooMuchIsRefused) { EXPECT_THROW(allocate_zeroed(SIZE_MAX / 2), std::bad_alloc); }

}  // namespace TEST_FILE
}  // namespace soapfilm
