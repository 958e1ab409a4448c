#include "soapfilm/platform/memory.h"

#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <ctime>
#include <fstream>
#include <limits>
#include <optional>
#include <string_view>

namespace soapfilm {

namespace {

/// The number after `key` at the beginning of a line ("MemAvailable:  123 kB"); nothing if the file has none.
std::optional<uint64_t> read_entry(const std::string& file, std::string_view key) {
  std::ifstream in(file);
  for (std::string name; in >> name; in.ignore(std::numeric_limits<std::streamsize>::max(), '\n')) {
    uint64_t value = 0;
    if (name == key && in >> value) return value;
    in.clear();
  }
  return {};
}

/// The number in a file with one number; nothing if the file is absent or contains "max".
std::optional<uint64_t> read_number(const std::string& file) {
  std::ifstream in(file);
  uint64_t value = 0;
  if (in >> value) return value;
  return {};
}

/// File names with a group's memory, in one version of control groups.
struct GroupFiles {
  const char* mount;
  const char* limit;
  const char* usage;
  std::array<const char*, 2> cache;  ///< entries of memory.stat: file cache, that the system can free
};
constexpr GroupFiles group_v1{"sys/fs/cgroup/memory",
                              "memory.limit_in_bytes",
                              "memory.usage_in_bytes",
                              {"total_inactive_file", "total_active_file"}};
constexpr GroupFiles group_v2{"sys/fs/cgroup", "memory.max", "memory.current", {"inactive_file", "active_file"}};

/// Smallest room in the group `path` and in those above it. A path that the process cannot see (a container's outer
/// one) has no files and sets no limit.
uint64_t room_in_group(const std::string& root, const GroupFiles& files, std::string path) {
  uint64_t room = UINT64_MAX;
  for (;;) {
    const std::string folder = fmt::format("{}/{}{}/", root, files.mount, path);
    const auto limit = read_number(folder + files.limit);
    const auto usage = read_number(folder + files.usage);
    if (limit && usage) {
      uint64_t cache = 0;
      for (const char* entry : files.cache) cache += read_entry(folder + "memory.stat", entry).value_or(0);
      const uint64_t held = *usage - std::min(*usage, cache);
      room = std::min(room, *limit - std::min(*limit, held));
    }
    if (path.empty()) return room;
    path.resize(path.rfind('/'));
  }
}

/// Lines of /proc/self/cgroup: "0::/path" (v2) and "4:memory:/path" (v1).
uint64_t room_in_groups(const std::string& root) {
  uint64_t room = UINT64_MAX;
  std::ifstream in(root + "/proc/self/cgroup");
  for (std::string line; std::getline(in, line);) {
    const size_t first = line.find(':');
    const size_t second = line.find(':', first + 1);
    if (first == std::string::npos || second == std::string::npos) continue;
    const std::string controllers = "," + line.substr(first + 1, second - first - 1) + ",";
    std::string path = line.substr(second + 1);
    if (path.empty() || path.front() != '/' || path == "/") path.clear();
    if (controllers == ",,") room = std::min(room, room_in_group(root, group_v2, path));
    if (controllers.find(",memory,") != std::string::npos) room = std::min(room, room_in_group(root, group_v1, path));
  }
  return room;
}

}  // namespace

int64_t thread_cpu_time() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return int64_t{1'000'000'000} * time.tv_sec + time.tv_nsec;
}

bool knows_cpu_time() { return true; }

void prefer_large_pages(void* memory, size_t bytes) {
  constexpr size_t large_page = size_t{2} << 20;
  if (bytes < large_page) return;
  const auto page = static_cast<uintptr_t>(sysconf(_SC_PAGESIZE));
  const auto begin = reinterpret_cast<uintptr_t>(memory), first = (begin + page - 1) / page * page;
  static_cast<void>(madvise(reinterpret_cast<void*>(first), begin + bytes - first, MADV_HUGEPAGE));
}

size_t peak_memory_bytes() {
  // getrusage's maximum includes that of the program that was replaced by this one (exec), for example a large program
  // that started it.
  if (const auto kilobytes = read_entry("/proc/self/status", "VmHWM:")) return *kilobytes * 1024;
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<size_t>(usage.ru_maxrss) * 1024;
}

size_t held_memory_bytes() {
  std::ifstream in("/proc/self/statm");
  size_t size = 0, resident = 0, shared = 0;  // pages
  if (!(in >> size >> resident >> shared)) return 0;
  return (resident - std::min(resident, shared)) * static_cast<size_t>(sysconf(_SC_PAGESIZE));
}

size_t available_memory_bytes(const std::string& root) {
  const auto kilobytes = read_entry(root + "/proc/meminfo", "MemAvailable:");
  return std::min(kilobytes ? *kilobytes * 1024 : UINT64_MAX, room_in_groups(root));
}

}  // namespace soapfilm
