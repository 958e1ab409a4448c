#include "soapfilm/core/memory.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <vector>

#include "soapfilm/error.h"

namespace soapfilm {
namespace TEST_FILE {

/// A folder that stands for "/", with the few files that the functions read.
class FakeSystem : public testing::Test {
 protected:
  FakeSystem() {
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    root_ = std::filesystem::temp_directory_path() / ("soapfilm_" + std::string(test->name()));
    std::filesystem::remove_all(root_);
  }
  ~FakeSystem() override { std::filesystem::remove_all(root_); }

  void write(const std::string& name, const std::string& text) {
    const auto path = root_ / name;
    std::filesystem::create_directories(path.parent_path());
    std::ofstream(path) << text;
  }
  void write_meminfo(size_t available_kilobytes) {
    write("proc/meminfo", "MemTotal:  99999999 kB\nMemFree:  17 kB\nMemAvailable:  " +
                              std::to_string(available_kilobytes) + " kB\nBuffers:  1 kB\n");
  }
  size_t available() const { return available_memory_bytes(root_.string()); }

  std::filesystem::path root_;
};

TEST(Vectors, AreFreedAndReserved) {
  constexpr size_t count = 300'000;  // more than a large page
  std::vector<double> values;
  reserve_many(values, count);
  EXPECT_GE(values.capacity(), count);
  EXPECT_TRUE(values.empty());
  values.assign(count, 1.5);
  prefer_large_pages(values.data(), count * sizeof(double));  // what is there stays
  EXPECT_EQ(values, std::vector<double>(count, 1.5));
  release(values);
  EXPECT_EQ(values.capacity(), 0u);
}

TEST_F(FakeSystem, WithoutGroupsTheSystemDecides) {
  write_meminfo(2048);
  EXPECT_EQ(available(), 2048u * 1024);
}

TEST_F(FakeSystem, AnUnlimitedGroupChangesNothing) {
  write_meminfo(2048);
  write("proc/self/cgroup", "0::/job\n");
  write("sys/fs/cgroup/job/memory.max", "max\n");
  write("sys/fs/cgroup/job/memory.current", "5000\n");
  EXPECT_EQ(available(), 2048u * 1024);
}

TEST_F(FakeSystem, Version2LimitLessUsageWithoutCache) {
  write_meminfo(2048);
  write("proc/self/cgroup", "0::/job\n");
  write("sys/fs/cgroup/job/memory.max", "1000000\n");
  write("sys/fs/cgroup/job/memory.current", "300000\n");
  write("sys/fs/cgroup/job/memory.stat", "anon 200000\nfile 100000\ninactive_file 50000\nactive_file 40000\n");
  EXPECT_EQ(available(), 790000u);
}

TEST_F(FakeSystem, AnOuterGroupMayBeTighter) {
  write_meminfo(2048);
  write("proc/self/cgroup", "0::/outer/inner\n");
  write("sys/fs/cgroup/outer/inner/memory.max", "1000000\n");
  write("sys/fs/cgroup/outer/inner/memory.current", "0\n");
  write("sys/fs/cgroup/outer/memory.max", "400000\n");
  write("sys/fs/cgroup/outer/memory.current", "100000\n");
  EXPECT_EQ(available(), 300000u);
}

TEST_F(FakeSystem, Version1GroupAmongOthers) {
  write_meminfo(2048);
  write("proc/self/cgroup", "9:name=systemd:/\n5:cpu,cpuacct:/x\n4:memory:/job\n0::/\n");
  write("sys/fs/cgroup/memory/job/memory.limit_in_bytes", "500000\n");
  write("sys/fs/cgroup/memory/job/memory.usage_in_bytes", "100000\n");
  write("sys/fs/cgroup/memory/job/memory.stat", "inactive_file 9\ntotal_inactive_file 20000\ntotal_active_file 7000\n");
  EXPECT_EQ(available(), 427000u);
}

TEST_F(FakeSystem, AContainerSeesItsLimitAtTheMount) {
  write_meminfo(2048);
  write("proc/self/cgroup", "4:memory:/docker/0123abcd\n");
  write("sys/fs/cgroup/memory/memory.limit_in_bytes", "500000\n");
  write("sys/fs/cgroup/memory/memory.usage_in_bytes", "600000\n");
  EXPECT_EQ(available(), 0u) << "over the limit leaves nothing, not a huge number";
}

TEST_F(FakeSystem, AnUnknownSystemSetsNoLimit) { EXPECT_EQ(available(), SIZE_MAX); }

TEST(Memory, ThisMachineHasSome) {
  EXPECT_GT(available_memory_bytes(), size_t{1} << 20);
  EXPECT_LT(available_memory_bytes(), size_t{1} << 50);
}

TEST(Memory, PeakSeesAnAllocation) {
  const size_t before = peak_memory_bytes();
  const std::vector<char> block(size_t{64} << 20, 'x');
  const volatile char* seen = block.data();  // a block that nobody looks at may never be made
  EXPECT_EQ(seen[block.size() / 2], 'x');
  EXPECT_GE(peak_memory_bytes(), before + (size_t{48} << 20));
}

TEST(Memory, ParsesWhatPeopleWrite) {
  EXPECT_EQ(parse_memory("123456"), 123456u);
  EXPECT_EQ(parse_memory("17B"), 17u);
  EXPECT_EQ(parse_memory("600M"), size_t{600} << 20);
  EXPECT_EQ(parse_memory("2G"), size_t{2} << 30);
  EXPECT_EQ(parse_memory("1.5GiB"), size_t{3} << 29);
  EXPECT_EQ(parse_memory("800 MB"), 800'000'000u);
  EXPECT_EQ(parse_memory("64k"), 65536u);
  EXPECT_EQ(parse_memory("1t"), size_t{1} << 40);
}

TEST(Memory, RefusesWhatIsNoSize) {
  for (const char* text : {"", "M", "-1G", "0", "0.2", "1e3", "nan", "inf", "12X", "12 MiBs", "1GG", "2G ", "1 2",
                           "1e400", "99999999999999999999T"})
    EXPECT_THROW(parse_memory(text), ParameterError) << "'" << text << "'";
}

TEST(Memory, RefusalNamesTheValue) {
  try {
    parse_memory("12X");
    FAIL();
  } catch (const ParameterError& error) {
    EXPECT_NE(std::string(error.what()).find("'12X'"), std::string::npos) << error.what();
  }
}

TEST(Memory, FormatsWithThreeDigits) {
  EXPECT_EQ(format_bytes(0), "0 B");
  EXPECT_EQ(format_bytes(1023), "1023 B");
  EXPECT_EQ(format_bytes(1024), "1.00 KiB");
  EXPECT_EQ(format_bytes(size_t{3} << 29), "1.50 GiB");
  EXPECT_EQ(format_bytes(size_t{613} << 20), "613 MiB");
  EXPECT_EQ(format_bytes((size_t{1} << 30) - 1), "1.00 GiB");
  EXPECT_EQ(format_bytes(size_t{12} << 20), "12.0 MiB");
  EXPECT_EQ(format_bytes(SIZE_MAX), "16.0 EiB");
}

TEST(Memory, FormattedSizesParseBack) {
  for (size_t bytes : {size_t{700}, size_t{5000}, size_t{123456789}, size_t{1} << 40}) {
    const double ratio = static_cast<double>(parse_memory(format_bytes(bytes))) / static_cast<double>(bytes);
    EXPECT_NEAR(ratio, 1.0, 0.005) << format_bytes(bytes);
  }
}

}  // namespace TEST_FILE
}  // namespace soapfilm
