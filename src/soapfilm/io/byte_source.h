// The one way in: every reader gets its bytes here, bounded and checked.
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <vector>

namespace soapfilm::io {

/// The bytes of a file: mapped when it is a regular file, read whole when it is a pipe.
class ByteSource {
 public:
  /// Throws InputError for a file that is missing, unreadable, empty, a directory or a device.
  explicit ByteSource(const std::string& path);
  ~ByteSource();
  ByteSource(const ByteSource&) = delete;
  ByteSource& operator=(const ByteSource&) = delete;

  const std::string& path() const { return path_; }
  std::string_view bytes() const { return bytes_; }
  bool begins_with(std::string_view head) const { return bytes_.substr(0, head.size()) == head; }

  /// The reader has passed `offset`: what lies before needs no memory any more (it stays readable). Cheap to call.
  void release_before(size_t offset) {
    if (offset - released_ >= release_step) release(offset);
  }

 private:
  static constexpr size_t release_step = size_t{8} << 20;
  void release(size_t offset);

  std::string path_;
  std::string_view bytes_;
  void* mapping_ = nullptr;
  std::vector<char> copy_;
  size_t released_ = 0;  // the mapping before this offset was given back; at a multiple of release_step
};

template <class T>
T swap_bytes(T value) {
  static_assert(sizeof(T) == 1 || sizeof(T) == 2 || sizeof(T) == 4 || sizeof(T) == 8);
  if constexpr (sizeof(T) == 2) return std::bit_cast<T>(__builtin_bswap16(std::bit_cast<uint16_t>(value)));
  if constexpr (sizeof(T) == 4) return std::bit_cast<T>(__builtin_bswap32(std::bit_cast<uint32_t>(value)));
  if constexpr (sizeof(T) == 8) return std::bit_cast<T>(__builtin_bswap64(std::bit_cast<uint64_t>(value)));
  return value;
}

/// Reads binary values in order.
class ByteCursor {
 public:
  explicit ByteCursor(ByteSource& source, size_t offset = 0, std::endian order = std::endian::little)
      : source_(source), offset_(offset), swap_(order != std::endian::native) {}

  size_t offset() const { return offset_; }
  size_t remaining() const { return source_.bytes().size() - offset_; }

  template <class T>
  T read() {
    if (remaining() < sizeof(T)) fail_truncated(sizeof(T));
    T value;
    std::memcpy(&value, source_.bytes().data() + offset_, sizeof(T));
    offset_ += sizeof(T);
    return swap_ ? swap_bytes(value) : value;
  }
  void skip(size_t count) {
    if (remaining() < count) fail_truncated(count);
    offset_ += count;
  }
  void release() { source_.release_before(offset_); }

 private:
  [[noreturn]] void fail_truncated(size_t wanted) const;

  ByteSource& source_;
  size_t offset_;
  bool swap_;
};

}  // namespace soapfilm::io
