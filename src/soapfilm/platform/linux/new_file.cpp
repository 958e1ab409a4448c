#include "soapfilm/platform/new_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <utility>

namespace soapfilm {

namespace {

/// Another name of an open file, which has none in a folder.
std::string path_of(int file) { return fmt::format("/proc/self/fd/{}", file); }

bool link_file(int file, const std::string& name) {
  return linkat(AT_FDCWD, path_of(file).c_str(), AT_FDCWD, name.c_str(), AT_SYMLINK_FOLLOW) == 0;
}

}  // namespace

int open_unnamed_file(const std::string& folder, unsigned mode) {
  const char* const place = folder.empty() ? "." : folder.c_str();
  const int file = open(place, O_TMPFILE | O_RDWR | O_CLOEXEC, mode);
  if (file < 0) {
    // A file system or a kernel that has no such files takes this for an attempt to open the folder itself.
    if ((errno == EISDIR || errno == EINVAL || errno == ENOENT) && access(place, F_OK) == 0) errno = EOPNOTSUPP;
    return -1;
  }
  if (access(path_of(file).c_str(), F_OK) == 0) return file;
  close(file);  // without /proc it could not be named
  errno = EOPNOTSUPP;
  return -1;
}

std::string name_for_others(int file) { return fmt::format("/proc/{}/fd/{}", getpid(), file); }

int name_file(int file, const std::string& name) {
  if (link_file(file, name)) return 0;
  if (errno != EEXIST) return errno;
  // A link does not replace a file, a rename does. Between these two calls the file has another name.
  const std::filesystem::path folder = std::filesystem::path(name).parent_path();
  constexpr int attempts = 1000;
  for (int attempt = 0; attempt < attempts; ++attempt) {
    const std::string between = (folder / fmt::format(".soapfilm-{}-{}", getpid(), attempt)).string();
    if (!link_file(file, between)) {
      if (errno == EEXIST) continue;
      return errno;
    }
    if (std::rename(between.c_str(), name.c_str()) == 0) return 0;
    const int error = errno;
    unlink(between.c_str());
    return error;
  }
  return EEXIST;
}

int store_file(int file) { return fsync(file) == 0 || errno == EINVAL ? 0 : errno; }

NewFile::NewFile(std::string name) : name_(std::move(name)), path_(name_ + "-part") {
  file_ = open_unnamed_file(std::filesystem::path(name_).parent_path().string(), 0600);
  if (file_ >= 0) path_ = path_of(file_);
}

NewFile::~NewFile() {
  if (file_ >= 0)
    close(file_);
  else if (!path_.empty())
    unlink(path_.c_str());
}

bool NewFile::complete() {
  if (file_ >= 0) return store_file(file_) == 0 && name_file(file_, name_) == 0;
  const int written = open(path_.c_str(), O_RDONLY | O_CLOEXEC);
  if (written < 0) return false;
  const bool stored = store_file(written) == 0;
  close(written);
  if (!stored || std::rename(path_.c_str(), name_.c_str()) != 0) return false;
  path_.clear();
  return true;
}

}  // namespace soapfilm
