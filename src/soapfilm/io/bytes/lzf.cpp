#include "soapfilm/io/bytes/lzf.h"

#include <algorithm>
#include <cstring>
#include <stdexcept>

namespace soapfilm::io {

namespace {

constexpr size_t lzf_farthest = 8192, lzf_longest = 264;  // copies

/// One control byte with what follows it.
struct LzfStep {
  size_t literals = 0;  ///< bytes as they are, or else
  size_t length = 0;    ///< a copy
  size_t distance = 0;
};

/// Moves `at` past the step's control bytes; its literals, if any, lie there. False at a broken end.
bool read_step(std::string_view compressed, size_t& at, LzfStep& step) {
  const auto byte = [&](size_t i) { return static_cast<size_t>(static_cast<unsigned char>(compressed[i])); };
  const size_t control = byte(at++);
  step = {};
  if (control < 32) {
    step.literals = control + 1;
    return compressed.size() - at >= step.literals;
  }
  step.length = (control >> 5) + 2;
  const bool is_long = control >> 5 == 7;
  if (compressed.size() - at < (is_long ? 2u : 1u)) return false;
  if (is_long) step.length += byte(at++);
  step.distance = ((control & 31) << 8 | byte(at++)) + 1;
  return true;
}

}  // namespace

std::optional<uint64_t> lzf_decoded_size(std::string_view compressed) {
  uint64_t size = 0;
  LzfStep step;
  for (size_t at = 0; at < compressed.size(); at += step.literals) {
    if (!read_step(compressed, at, step) || step.distance > size) return std::nullopt;
    size += step.literals + step.length;
  }
  return size;
}

LzfBytes::LzfBytes(std::string_view compressed)
    : compressed_(compressed), buffer_(lzf_farthest + most_at_once + lzf_longest) {}

const char* LzfBytes::take(size_t count) {
  if (decoded_ - taken_ < count && taken_ > lzf_farthest) {  // keep what may be copied
    const size_t drop = std::min(taken_, decoded_ - std::min(decoded_, lzf_farthest));
    std::memmove(buffer_.data(), buffer_.data() + drop, decoded_ - drop);
    taken_ -= drop;
    decoded_ -= drop;
  }
  while (decoded_ - taken_ < count) decode_one();
  const char* at = buffer_.data() + taken_;
  taken_ += count;
  return at;
}

void LzfBytes::decode_one() {
  LzfStep step;
  if (used_ >= compressed_.size() || !read_step(compressed_, used_, step) || step.distance > decoded_ ||
      buffer_.size() - decoded_ < lzf_longest)
    throw std::logic_error("LzfBytes::take() of more bytes than there are");
  char* to = buffer_.data() + decoded_;
  decoded_ += step.literals + step.length;
  if (step.length == 0) {
    std::memcpy(to, compressed_.data() + used_, step.literals);
    used_ += step.literals;
    return;
  }
  const char* from = to - step.distance;
  if (step.distance >= step.length)
    std::memcpy(to, from, step.length);
  else
    for (size_t i = 0; i < step.length; ++i) to[i] = from[i];
}

}  // namespace soapfilm::io
