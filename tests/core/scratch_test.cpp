// Arrays of a pool in files without a name.
#include "soapfilm/platform/scratch.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <string>

#include "soapfilm/error.h"
#include "soapfilm/grid/field.h"
#include "support/process.h"

namespace soapfilm {
namespace TEST_FILE {

constexpr size_t block = size_t{2} << 20;

bool is_filled(const ZeroedMemory& memory, size_t begin, size_t end, int value) {
  return std::all_of(memory.get() + begin, memory.get() + end,
                     [&](std::byte b) { return b == static_cast<std::byte>(value); });
}

TEST(ScratchFiles, AreZeroAlignedAndWritable) {
  if (!has_scratch_files()) GTEST_SKIP();
  const test::TemporaryFolder folder;
  const PagePool pool = PagePool::make();
  pool.use_folder(folder.path().string());
  for (const size_t bytes : {block, 3 * block + 5}) {
    for (int again = 0; again < 2; ++again) {
      const ZeroedMemory memory = pool.allocate(bytes);
      EXPECT_GE(memory.get_deleter().file, 0);
      EXPECT_EQ(reinterpret_cast<uintptr_t>(memory.get()) % block, 0u);
      EXPECT_TRUE(is_filled(memory, 0, bytes, 0));
      std::memset(memory.get(), 0x5A, bytes);
      EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
    }
  }
  EXPECT_EQ(pool.peak_disk_bytes(), 3 * block + 5);
  EXPECT_LT(pool.allocate(1000).get_deleter().file, 0) << "small arrays stay in memory";
  pool.use_folder({});
  EXPECT_LT(pool.allocate(block).get_deleter().file, 0);
}

TEST(ScratchFiles, KeepWhatIsNeitherReleasedNorRead) {
  if (!has_scratch_files()) GTEST_SKIP();
  const test::TemporaryFolder folder;
  const PagePool pool = PagePool::make();
  const PagePool::Keep keep(pool);
  pool.use_folder(folder.path().string());
  AlignedArray<uint8_t> array(5 * block, pool);
  ASSERT_TRUE(array.on_disk());
  std::memset(array.data(), 7, array.size());
  array.fetch(block, 2 * block);
  array.release_before(block + 12345);
  EXPECT_EQ(std::count(array.data() + block + 12345, array.data() + array.size(), 7),
            static_cast<ptrdiff_t>(4 * block - 12345));
  EXPECT_EQ(array.data()[0], 0) << "released";
  std::memset(array.data(), 1, array.size());  // and it may be written again
  array = {};
  // What was freed gives no pages to arrays in memory.
  pool.use_folder({});
  const ZeroedMemory memory = pool.allocate(5 * block);
  EXPECT_TRUE(is_filled(memory, 0, 5 * block, 0));
}

TEST(ScratchFiles, GiveTheirSpaceBack) {
  if (!has_scratch_files()) GTEST_SKIP();
  const test::TemporaryFolder folder;
  constexpr size_t bytes = 64 * block;
  const PagePool pool = PagePool::make();
  pool.use_folder(folder.path().string());
  const uint64_t before = free_disk_bytes(folder.path().string());
  if (before == UINT64_MAX || before < 4 * bytes) GTEST_SKIP();
  // Others use the disk meanwhile: ten times as much as stays would not be noticed, so it is repeated until it is.
  for (int k = 0; k < 20; ++k) {
    const ZeroedMemory memory = pool.allocate(bytes);
    std::memset(memory.get(), 1, block);
  }
  EXPECT_GT(free_disk_bytes(folder.path().string()) + 10 * bytes, before);
}

TEST(ScratchFiles, AFullDiskIsRefusedBeforeItIsUsed) {
  if (!has_scratch_files()) GTEST_SKIP();
  const test::TemporaryFolder folder;
  const uint64_t free = free_disk_bytes(folder.path().string());
  if (free > uint64_t{1} << 46) GTEST_SKIP() << "more than a process may map";
  const PagePool pool = PagePool::make();
  pool.use_folder(folder.path().string());
  try {
    pool.allocate(2 * free + block);
    FAIL() << "taken";
  } catch (const OutputError& error) {
    const std::string message = error.what();
    EXPECT_NE(message.find(folder.path().string()), std::string::npos) << message;
    EXPECT_NE(message.find(std::to_string(2 * free + block) + " bytes needed"), std::string::npos) << message;
    EXPECT_NE(message.find("free"), std::string::npos) << message;
  }
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

}  // namespace TEST_FILE
}  // namespace soapfilm
