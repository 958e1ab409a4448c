// Text to a stream that may be closed or full.
#pragma once

#include <cstdio>
#include <string_view>

namespace soapfilm::cli {

/// What stderr does not take is not told; whether stdout took all is checked when the program ends.
inline void print(std::FILE* out, std::string_view text) noexcept {
  static_cast<void>(std::fwrite(text.data(), 1, text.size(), out));
}

}  // namespace soapfilm::cli
