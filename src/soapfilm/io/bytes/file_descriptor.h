#pragma once

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>

namespace soapfilm::io {

/// Owns an open file.
class FileDescriptor {
 public:
  explicit FileDescriptor(int fd = -1) : fd_(fd) {}
  ~FileDescriptor() { close(); }
  FileDescriptor(const FileDescriptor&) = delete;
  FileDescriptor& operator=(const FileDescriptor&) = delete;

  int get() const { return fd_; }
  bool is_open() const { return fd_ >= 0; }
  void reset(int fd) {
    close();
    fd_ = fd;
  }
  /// 0, or -1 with errno as close(2) left it.
  int close() {
    const int fd = fd_;
    fd_ = -1;
    return fd < 0 ? 0 : ::close(fd);
  }

 private:
  int fd_;
};

/// Writes all of it where the file is, or from an offset on. Returns 0 or an error number.
inline int write_all(int file, std::string_view bytes, std::optional<uint64_t> offset = {}) {
  while (!bytes.empty()) {
    const ssize_t written = offset ? ::pwrite(file, bytes.data(), bytes.size(), static_cast<off_t>(*offset))
                                   : ::write(file, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    // What is written may be an array on a disk that has lost its pages.
    if (written < 0) return errno == EFAULT ? EIO : errno;
    bytes.remove_prefix(static_cast<size_t>(written));
    if (offset) *offset += static_cast<uint64_t>(written);
  }
  return 0;
}

/// The system's text for an errno value; thread-safe, unlike strerror().
inline std::string error_text(int error) { return std::generic_category().message(error); }

}  // namespace soapfilm::io
