// LZF, the compression of PCD (M. Lehmann, liblzf). A control byte c < 32 is followed by c + 1 bytes as they are; else
// c >> 5, of 7 the next byte more, and 2 are the length of a copy from ((c & 31) << 8 | next byte) + 1 bytes back,
// which may overlap itself.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

namespace soapfilm::io {

/// How many bytes it stands for; none if it ends in the middle or copies from before its begin. Allocates nothing.
std::optional<uint64_t> lzf_decoded_size(std::string_view compressed);

/// The decoded bytes in order, of which only the last few are held.
class LzfBytes {
 public:
  static constexpr size_t most_at_once = size_t{1} << 16;

  /// For data of which lzf_decoded_size() gave the size.
  explicit LzfBytes(std::string_view compressed);

  /// The next `count` bytes, at most `most_at_once`, and all together not more than there are; valid until the next
  /// call.
  const char* take(size_t count);

  /// How much of the compressed data was used.
  size_t used() const { return used_; }

 private:
  void decode_one();

  std::string_view compressed_;
  size_t used_ = 0;
  std::vector<char> buffer_;
  size_t taken_ = 0;    // of the buffer's bytes
  size_t decoded_ = 0;  // bytes in the buffer
};

}  // namespace soapfilm::io
