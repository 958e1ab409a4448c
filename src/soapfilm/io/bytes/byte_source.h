// All input files are read here, with bounds checked.
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <vector>

#include "soapfilm/progress.h"

namespace soapfilm::io {

/// The bytes of a file: mapped when it is a regular file, read whole when it is a pipe, or the caller's.
class ByteSource {
 public:
  /// Throws InputError for a file that is missing, unreadable, empty, a directory or a device.
  explicit ByteSource(const std::string& path);
  /// Of a file that is in memory already: `bytes` must outlive it, `path` is for messages and the format. Throws
  /// InputError if there are none.
  ByteSource(std::string path, std::string_view bytes);
  ~ByteSource();
  ByteSource(const ByteSource&) = delete;
  ByteSource& operator=(const ByteSource&) = delete;

  const std::string& path() const { return path_; }
  std::string_view bytes() const { return bytes_; }
  bool begins_with(std::string_view head) const { return bytes_.substr(0, head.size()) == head; }

  /// From now on told what part of the file has been read, on the reading thread.
  void report_to(Progress& progress) { progress_ = &progress; }

  /// The reader has passed `offset`: the memory of what lies before may be released (it stays readable). Cheap to call.
  void release_before(size_t offset) {
    if (offset >= released_ + release_step) release(offset);
  }

 private:
  static constexpr size_t release_step = size_t{8} << 20;
  void release(size_t offset);

  std::string path_;
  Progress* progress_ = nullptr;
  std::string_view bytes_;
  void* mapping_ = nullptr;
  std::vector<char> copy_;
  size_t released_ = 0;  // the mapping before this offset was released; a multiple of release_step
};

template <class T>
T swap_bytes(T value) {
  static_assert(sizeof(T) == 1 || sizeof(T) == 2 || sizeof(T) == 4 || sizeof(T) == 8);
  if constexpr (sizeof(T) == 2) return std::bit_cast<T>(__builtin_bswap16(std::bit_cast<uint16_t>(value)));
  if constexpr (sizeof(T) == 4) return std::bit_cast<T>(__builtin_bswap32(std::bit_cast<uint32_t>(value)));
  if constexpr (sizeof(T) == 8) return std::bit_cast<T>(__builtin_bswap64(std::bit_cast<uint64_t>(value)));
  return value;
}

/// The value at `at`, which need not be aligned.
template <class T>
T load(const char* at, bool swap) {
  T value;
  std::memcpy(&value, at, sizeof(T));
  return swap ? swap_bytes(value) : value;
}

/// The same of a value that is stored little-endian.
template <class T>
T load_little(const char* at) {
  return load<T>(at, std::endian::native != std::endian::little);
}

/// Reads binary values in order.
class ByteCursor {
 public:
  explicit ByteCursor(ByteSource& source, size_t offset = 0, std::endian order = std::endian::little)
      : source_(source), offset_(offset), swap_(order != std::endian::native) {}

  size_t offset() const { return offset_; }
  size_t remaining() const { return source_.bytes().size() - offset_; }

  bool swaps() const { return swap_; }

  /// Returns the next `count` bytes and moves past them.
  const char* take(size_t count) {
    if (remaining() < count) fail_truncated(count);
    const char* at = source_.bytes().data() + offset_;
    offset_ += count;
    return at;
  }
  template <class T>
  T read() {
    return load<T>(take(sizeof(T)), swap_);
  }
  void skip(size_t count) { take(count); }
  void release() { source_.release_before(offset_); }

 private:
  [[noreturn]] void fail_truncated(size_t wanted) const;

  ByteSource& source_;
  size_t offset_;
  bool swap_;
};

}  // namespace soapfilm::io
