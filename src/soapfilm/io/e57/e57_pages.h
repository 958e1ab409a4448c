// The bytes of an E57 file behind its checksums.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "soapfilm/io/bytes/byte_source.h"

namespace soapfilm::io {

/// An E57 file is pages of 1020 bytes and their CRC-32C. Its own offsets are physical: they count the checksums, too;
/// what it stores runs over logical bytes, without them. Every page is checked before its bytes are used.
class E57Pages {
 public:
  /// Reads the header. Throws InputError for a file that is not an E57 of version 1, or too short.
  explicit E57Pages(ByteSource& source);

  const std::string& path() const { return source_.path(); }
  size_t file_size() const { return source_.bytes().size(); }
  /// Number of logical bytes.
  uint64_t size() const { return pages_ * payload; }
  uint64_t xml_offset() const { return xml_offset_; }  ///< logical
  uint64_t xml_length() const { return xml_length_; }
  /// Bytes after the end that the header gives.
  uint64_t left_over() const { return file_size() - pages_ * page; }

  uint64_t physical(uint64_t logical) const { return logical / payload * page + logical % payload; }
  /// Throws InputError, naming `what`, for an offset outside of the pages or in a checksum.
  uint64_t logical(uint64_t physical, std::string_view what) const;

  /// Copies logical bytes, which must exist.
  void read(uint64_t offset, char* to, size_t count);
  template <class T>
  T read(uint64_t offset) {
    char bytes[sizeof(T)];
    read(offset, bytes, sizeof(T));
    return load_little<T>(bytes);
  }
  /// All before this logical offset has been read; offsets may go back.
  void release_before(uint64_t offset);

  /// Throws InputError "path: byte N: message", N being physical.
  [[noreturn]] void fail(uint64_t logical_offset, const std::string& message) const;

 private:
  static constexpr uint64_t page = 1024;
  static constexpr uint64_t payload = 1020;

  void check(uint64_t index);

  ByteSource& source_;
  uint64_t pages_ = 0;
  uint64_t xml_offset_ = 0;
  uint64_t xml_length_ = 0;
  uint64_t checked_ = UINT64_MAX;  // the page that was checked last
  uint64_t released_ = 0;
};

}  // namespace soapfilm::io
