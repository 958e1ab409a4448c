#include "soapfilm/io/bytes/byte_source.h"

#include <fmt/format.h>
#include <sys/mman.h>

#include <utility>

#include "soapfilm/error.h"
#include "soapfilm/io/bytes/file_descriptor.h"

namespace soapfilm::io {

namespace {

std::vector<char> read_pipe(int fd, const std::string& path) {
  std::vector<char> bytes;
  size_t size = 0;
  for (;;) {
    bytes.resize(std::max<size_t>(size_t{1} << 16, 2 * size));
    const ssize_t got = ::read(fd, bytes.data() + size, bytes.size() - size);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) throw InputError(path + ": cannot be read: " + error_text(errno));
    if (got == 0) break;
    size += static_cast<size_t>(got);
  }
  bytes.resize(size);
  return bytes;
}

}  // namespace

ByteSource::ByteSource(const std::string& path) : path_(path) {
  const FileDescriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  struct stat status {};
  if (!file.is_open() || ::fstat(file.get(), &status) != 0)
    throw InputError(path + ": cannot be opened: " + error_text(errno));
  if (S_ISDIR(status.st_mode)) throw InputError(path + ": is a directory, must be a file");

  if (S_ISFIFO(status.st_mode)) {
    copy_ = read_pipe(file.get(), path);
    bytes_ = {copy_.data(), copy_.size()};
  } else if (!S_ISREG(status.st_mode)) {
    throw InputError(path + ": is a device, must be a file or a pipe");
  } else if (status.st_size > 0) {
    const size_t size = static_cast<size_t>(status.st_size);
    void* mapping = ::mmap(nullptr, size, PROT_READ, MAP_PRIVATE, file.get(), 0);
    if (mapping == MAP_FAILED) throw InputError(path + ": cannot be mapped: " + error_text(errno));
    ::madvise(mapping, size, MADV_SEQUENTIAL);
    mapping_ = mapping;
    bytes_ = {static_cast<const char*>(mapping), size};
  }
  if (bytes_.empty()) throw InputError(path + ": is empty");
}

ByteSource::ByteSource(std::string path, std::string_view bytes) : path_(std::move(path)), bytes_(bytes) {
  if (bytes_.empty()) throw InputError(path_ + ": is empty");
}

ByteSource::~ByteSource() {
  if (mapping_ != nullptr) ::munmap(mapping_, bytes_.size());
}

void ByteSource::release(size_t offset) {
  const size_t end = offset / release_step * release_step;
  if (mapping_ != nullptr) ::madvise(static_cast<char*>(mapping_) + released_, end - released_, MADV_DONTNEED);
  released_ = end;
  if (progress_) progress_->advance(static_cast<double>(end) / static_cast<double>(bytes_.size()), {});
}

void ByteCursor::fail_truncated(size_t wanted) const {
  throw InputError(fmt::format("{}: byte {}: truncated: {} more bytes needed, {} left", source_.path(), offset_, wanted,
                               remaining()));
}

}  // namespace soapfilm::io
