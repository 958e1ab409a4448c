// What the fuzzers share: a law that does not hold ends the process, so that libFuzzer keeps the input.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>

namespace soapfilm::fuzz {

inline void require(bool holds, const std::string& law) {
  if (holds) return;
  std::fprintf(stderr, "broken law: %s\n", law.c_str());
  std::abort();
}

/// A message to people: one line that says something.
inline void require_one_line(const std::string& message) {
  require(!message.empty() && message.find_first_of("\r\n") == std::string::npos, "one line: " + message);
}

/// Turns bytes into decisions; after their end all are 0.
class Decisions {
 public:
  Decisions(const uint8_t* data, size_t size) : data_(data), size_(size) {}

  bool at_end() const { return size_ == 0; }
  uint8_t byte() {
    if (size_ == 0) return 0;
    --size_;
    return *data_++;
  }
  /// In [0, count), count at most 256.
  size_t below(size_t count) { return byte() % count; }
  bool one_in(size_t count) { return below(count) == count - 1; }
  std::string text(size_t longest) {
    std::string out;
    for (size_t left = below(longest + 1); left > 0 && size_ > 0; --left) out += static_cast<char>(byte());
    return out;
  }

 private:
  const uint8_t* data_;
  size_t size_;
};

}  // namespace soapfilm::fuzz
