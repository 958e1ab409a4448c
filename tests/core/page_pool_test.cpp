#include "soapfilm/platform/page_pool.h"

#include <gtest/gtest.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <cstring>
#include <new>
#include <string>
#include <thread>
#include <vector>

#include "soapfilm/core/memory.h"
#include "support/resident.h"
#include "support/sanitized.h"

namespace soapfilm {
namespace TEST_FILE {

TEST(PagePool, IsZeroAlignedAndWritable) {
  const PagePool pool = PagePool::make();
  for (const size_t bytes : {size_t{1}, size_t{100}, size_t{1} << 20, (size_t{1} << 21) - 1, (size_t{1} << 22) + 5}) {
    for (int again = 0; again < 2; ++again) {  // memory that was used before, too
      const ZeroedMemory memory = pool.allocate(bytes);
      EXPECT_EQ(reinterpret_cast<uintptr_t>(memory.get()) % 64, 0u);
      EXPECT_EQ(std::count(memory.get(), memory.get() + bytes, std::byte{0}), static_cast<ptrdiff_t>(bytes));
      std::memset(memory.get(), 0xFF, bytes);
    }
  }
}

TEST(PagePool, WhatIsNotReleasedStays) {
  const PagePool pool = PagePool::make();
  constexpr size_t bytes = size_t{5} << 20;
  const ZeroedMemory memory = pool.allocate(bytes);
  std::memset(memory.get(), 0x5A, bytes);
  size_t gone = 0;
  for (const size_t end : {size_t{5}, size_t{1'000'000}, size_t{999'999}, size_t{3'000'001}}) {
    const size_t before = gone;
    gone = release_pages(memory, before, end);
    EXPECT_LE(gone, std::max(before, end));
    EXPECT_EQ(std::count(memory.get() + gone, memory.get() + bytes, std::byte{0x5A}),
              static_cast<ptrdiff_t>(bytes - gone));
  }
  EXPECT_EQ(std::count(memory.get(), memory.get() + gone, std::byte{0}), static_cast<ptrdiff_t>(gone));
  std::memset(memory.get(), 1, bytes);  // and it may be written again
}

bool is_zero(const ZeroedMemory& memory, size_t bytes) {
  return std::all_of(memory.get(), memory.get() + bytes, [](std::byte b) { return b == std::byte{0}; });
}

constexpr size_t block = size_t{2} << 20;
constexpr size_t large = 20 * block + 12345;
// The sanitizers' shadow comes on top: some kernels count it in large pages. Release builds judge.
constexpr double slack = test::sanitized ? 0.75 * large : 3 * block;

TEST(PagePool, AreReusedByTheNextArraysAndThenReleased) {
  const PagePool pool = PagePool::make();
  const double before = test::resident_bytes();
  {
    const PagePool::Keep keep(pool);
    {
      const PagePool::Keep also(pool);
      const ZeroedMemory memory = pool.allocate(large);
      std::memset(memory.get(), 2, large);
    }
    EXPECT_NEAR(test::resident_bytes(), before + large, slack);
    // In pieces, large and small, all of them zero.
    std::vector<ZeroedMemory> pieces;
    for (const size_t size : {3 * block + 1, size_t{1000}, 6 * block, block, large - 10 * block}) {
      pieces.push_back(pool.allocate(size));
      EXPECT_EQ(reinterpret_cast<uintptr_t>(pieces.back().get()) % 64, 0u);
      EXPECT_TRUE(is_zero(pieces.back(), size)) << size;
      std::memset(pieces.back().get(), 3, size);
    }
    EXPECT_NEAR(test::resident_bytes(), before + large, slack);
    pieces.erase(pieces.begin() + 2);
    const ZeroedMemory more = pool.allocate(2 * large);  // more than there is
    EXPECT_TRUE(is_zero(more, 2 * large));
  }
  EXPECT_NEAR(test::resident_bytes(), before, slack);
}

TEST(PagePool, AreNoneThatNobodyTouched) {
  const PagePool pool = PagePool::make();
  const double before = test::resident_bytes();
  const PagePool::Keep keep(pool);
  { const ZeroedMemory untouched = pool.allocate(large); }
  EXPECT_NEAR(test::resident_bytes(), before, slack);
  {
    const ZeroedMemory memory = pool.allocate(large);
    std::memset(memory.get(), 2, large / 2);
  }
  EXPECT_NEAR(test::resident_bytes(), before + large / 2, slack);
  const ZeroedMemory memory = pool.allocate(large);
  EXPECT_TRUE(is_zero(memory, large));
  std::memset(memory.get(), 3, large);
  EXPECT_NEAR(test::resident_bytes(), before + large, slack);
}

TEST(PagePool, AreReusedBeforeTheirArrayEnds) {
  const PagePool pool = PagePool::make();
  const double before = test::resident_bytes();
  {
    const PagePool::Keep keep(pool);
    const ZeroedMemory old = pool.allocate(large), next = pool.allocate(large);
    std::memset(old.get(), 2, large);
    const auto page = static_cast<size_t>(sysconf(_SC_PAGESIZE));
    madvise(old.get() + 8 * block, page, MADV_DONTNEED);  // a block without its first page: the rest goes too
    std::memset(next.get() + 5 * block, 3, block);        // touched already: stays as it is
    size_t gone = 0;
    for (const size_t end : {block / 2, 3 * block + 7, 3 * block + 8, 12 * block}) {
      gone = release_pages(old, gone, end);
      EXPECT_EQ(gone, end / block * block);
    }
    EXPECT_NEAR(test::resident_bytes(), before + large, slack);
    std::byte* const from = next.get() + 100;
    pool.supply(from, large - 100);  // whole large pages after the first
    EXPECT_NEAR(test::resident_bytes(), before + large, slack);
    // Only what is there: some kernels count the zero page that reading maps elsewhere as resident.
    for (size_t i = 0; i < 12 * block; ++i) ASSERT_EQ(next.get()[i], i / block == 5 ? std::byte{3} : std::byte{0}) << i;
    std::memset(next.get(), 4, 13 * block);  // eleven and one of these are there
    EXPECT_NEAR(test::resident_bytes(), before + large + block, slack);
    EXPECT_EQ(std::count(next.get() + 13 * block, next.get() + large, std::byte{0}),
              static_cast<ptrdiff_t>(large - 13 * block));
    EXPECT_EQ(std::count(old.get() + gone, old.get() + large, std::byte{2}), static_cast<ptrdiff_t>(large - gone));
    std::memset(old.get(), 5, large);  // what went may be written
    EXPECT_EQ(std::count(old.get(), old.get() + large, std::byte{5}), static_cast<ptrdiff_t>(large));
  }
  EXPECT_NEAR(test::resident_bytes(), before, slack);
}

TEST(PagePool, AreReusedByVectors) {
  const PagePool pool = PagePool::make();
  const double before = test::resident_bytes();
  {
    const PagePool::Keep keep(pool);
    {
      const ZeroedMemory memory = pool.allocate(large);
      std::memset(memory.get(), 2, large);
    }
    std::vector<int> values;
    reserve_many(values, large / sizeof(int), pool);
    EXPECT_NEAR(test::resident_bytes(), before + large, slack);
    values.resize(large / sizeof(int));
    EXPECT_EQ(std::count(values.begin(), values.end(), 0), static_cast<ptrdiff_t>(values.size()));
    EXPECT_NEAR(test::resident_bytes(), before + large, slack);
  }
  if (!test::sanitized) {  // whose allocators keep what is freed
    EXPECT_NEAR(test::resident_bytes(), before, slack);
  }
}

TEST(PagePool, GoFromThreadToThread) {
  const PagePool pool = PagePool::make();
  const PagePool::Keep keep(pool);
  std::atomic<int> wrong = 0;
  std::vector<std::thread> threads;
  for (int t = 0; t < 3; ++t)
    threads.emplace_back([&, t] {
      const PagePool::Keep also(pool);
      for (const size_t blocks : {3, 17, 1, 20, 5}) {
        const size_t bytes = blocks * block + 100;
        const ZeroedMemory memory = pool.allocate(bytes);
        wrong += !is_zero(memory, bytes);
        std::memset(memory.get(), t + 1, bytes);
      }
    });
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(wrong, 0);
}

TEST(PagePool, TooMuchIsRefused) {
  const PagePool pool = PagePool::make();
  for (const size_t bytes : {SIZE_MAX / 4, SIZE_MAX / 2, SIZE_MAX - 10, SIZE_MAX})
    EXPECT_THROW(pool.allocate(bytes), std::bad_alloc) << bytes;
}

TEST(PagePool, KeepsNoneForAnotherPool) {
  const double before = test::resident_bytes();
  const PagePool pool = PagePool::make(), other = PagePool::make();
  const PagePool::Keep keep(pool);
  {
    const ZeroedMemory memory = other.allocate(large);
    std::memset(memory.get(), 2, large);
  }
  EXPECT_NEAR(test::resident_bytes(), before, slack);
}

TEST(PagePool, OutlivesItsContextByItsArrays) {
  ZeroedMemory memory;
  {
    const PagePool pool = PagePool::make();
    memory = pool.allocate(large);
  }
  std::memset(memory.get(), 2, large);
  memory.reset();
}

TEST(PagePool, KnowsTheMostThatItsArraysTookAtOnce) {
  const PagePool pool = PagePool::make(), copy = pool;
  EXPECT_EQ(pool.peak_bytes(), 0u);
  {
    const ZeroedMemory first = pool.allocate(1000);
    { const ZeroedMemory second = copy.allocate(large); }
    const ZeroedMemory third = pool.allocate(500);
  }
  EXPECT_EQ(pool.peak_bytes(), 1000 + large);
  EXPECT_EQ(copy.peak_bytes(), 1000 + large);
}

}  // namespace TEST_FILE
}  // namespace soapfilm
