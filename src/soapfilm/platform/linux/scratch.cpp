#include "soapfilm/platform/scratch.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string_view>

#include "soapfilm/error.h"

namespace soapfilm {

namespace {

[[noreturn]] void fail(const std::string& folder, std::string_view reason) {
  throw OutputError(fmt::format("scratch folder {}: {}", folder, reason));
}

/// Some file systems know no files without a name: theirs is removed at once.
int open_unnamed(const std::string& folder) {
  const int file = open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
  if (file >= 0 || (errno != EOPNOTSUPP && errno != EISDIR && errno != ENOENT && errno != EINVAL)) return file;
  if (access(folder.c_str(), F_OK) != 0) return -1;
  std::string name = folder + "/soapfilm-XXXXXX";
  const int named = mkostemp(name.data(), O_CLOEXEC);
  if (named >= 0) unlink(name.c_str());
  return named;
}

/// Files that are larger end the process by a signal.
uint64_t largest_file() {
  rlimit limit{};
  const bool limited = getrlimit(RLIMIT_FSIZE, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY;
  return limited ? limit.rlim_cur : UINT64_MAX;
}

}  // namespace

bool has_scratch_files() { return true; }

uint64_t free_disk_bytes(const std::string& folder) {
  struct statvfs disk {};
  if (statvfs(folder.c_str(), &disk) != 0) return UINT64_MAX;
  return uint64_t{disk.f_bavail} * disk.f_frsize;
}

void check_scratch_folder(const std::string& folder) {
  const int file = open_unnamed(folder);
  if (file < 0) fail(folder, std::strerror(errno));
  close(file);
}

int make_scratch_file(const std::string& folder, size_t bytes) {
  const int file = open_unnamed(folder);
  if (file < 0) fail(folder, std::strerror(errno));
  const int error = bytes > largest_file()            ? EFBIG
                    : bytes > free_disk_bytes(folder) ? ENOSPC
                                                      : posix_fallocate(file, 0, static_cast<off_t>(bytes));
  if (error == 0) return file;
  close(file);
  if (error == ENOSPC || error == EDQUOT)
    fail(folder, fmt::format("{} bytes needed, {} free", bytes, free_disk_bytes(folder)));
  if (error == EFBIG)
    fail(folder, fmt::format("a file of {} bytes needed, the largest that may be made has {}", bytes,
                             std::min<uint64_t>(largest_file(), INT64_MAX)));
  fail(folder, fmt::format("{} bytes needed: {}", bytes, std::strerror(error)));
}

bool replace_file(const std::string& complete, const std::string& name) {
  const int file = open(complete.c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) return false;
  const bool stored = fsync(file) == 0;
  close(file);
  return stored && std::rename(complete.c_str(), name.c_str()) == 0;
}

}  // namespace soapfilm
