#include "soapfilm/platform/scratch.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <map>
#include <mutex>
#include <string_view>

#include "soapfilm/error.h"
#include "soapfilm/platform/new_file.h"

namespace soapfilm {

namespace {

[[noreturn]] void fail(const std::string& folder, std::string_view reason) {
  throw OutputError(fmt::format("scratch folder {}: {}", folder, reason));
}

/// Some file systems know no files without a name: theirs is removed at once.
int open_unnamed(const std::string& folder) {
  const int file = open_unnamed_file(folder, 0600);
  if (file >= 0 || errno != EOPNOTSUPP) return file;
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

/// The open ones, and where contents were lost. The system writes pages when it wants to, and says only to those who
/// ask for it that it could not; what is read again then is something else.
class ScratchFiles {
 public:
  static ScratchFiles& all() {
    static auto* const files = new ScratchFiles;  // never freed: arrays may be, after main()
    return *files;
  }

  void add(int file, const std::string& folder) {
    const std::lock_guard lock(mutex_);
    folder_of_[file] = folder;
  }
  void remove(int file) {
    const std::lock_guard lock(mutex_);
    const auto found = folder_of_.find(file);
    look(found->first, found->second);
    folder_of_.erase(found);
  }
  void check(const std::string& folder) {
    const std::lock_guard lock(mutex_);
    for (const auto& [file, its_folder] : folder_of_)
      if (its_folder == folder) look(file, folder);
    check_closed(folder);
  }
  /// Of those that were closed, which costs nothing.
  void check_before_next(const std::string& folder) {
    const std::lock_guard lock(mutex_);
    check_closed(folder);
  }

 private:
  void look(int file, const std::string& folder) {
    if (sync_file_range(file, 0, 0, SYNC_FILE_RANGE_WAIT_BEFORE) != 0 && (errno == EIO || errno == ENOSPC))
      lost_[folder] = errno;
  }
  void check_closed(const std::string& folder) {
    const auto found = lost_.find(folder);
    if (found == lost_.end()) return;
    const int error = found->second;
    lost_.erase(found);
    fail(folder, fmt::format("the disk did not take what was written: {}", std::strerror(error)));
  }

  std::mutex mutex_;
  std::map<int, std::string> folder_of_;
  std::map<std::string, int> lost_;  ///< the error, by folder
};

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
  ScratchFiles::all().check_before_next(folder);
  const int file = open_unnamed(folder);
  if (file < 0) fail(folder, std::strerror(errno));
  const int error = bytes > largest_file()            ? EFBIG
                    : bytes > free_disk_bytes(folder) ? ENOSPC
                                                      : posix_fallocate(file, 0, static_cast<off_t>(bytes));
  if (error == 0) {
    ScratchFiles::all().add(file, folder);
    return file;
  }
  close(file);
  if (error == ENOSPC || error == EDQUOT)
    fail(folder, fmt::format("{} bytes needed, {} free", bytes, free_disk_bytes(folder)));
  if (error == EFBIG)
    fail(folder, fmt::format("a file of {} bytes needed, the largest that may be made has {}", bytes,
                             std::min<uint64_t>(largest_file(), INT64_MAX)));
  fail(folder, fmt::format("{} bytes needed: {}", bytes, std::strerror(error)));
}

void close_scratch_file(int file) {
  ScratchFiles::all().remove(file);
  close(file);
}

void check_scratch_files(const std::string& folder) {
  if (!folder.empty()) ScratchFiles::all().check(folder);
}

}  // namespace soapfilm
