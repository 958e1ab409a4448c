#pragma once

#include <cstdint>

namespace soapfilm {

/// std::popcount, but without a function call where the processor's instruction may be missing.
constexpr int count_bits(uint64_t bits) {
  bits -= bits >> 1 & 0x5555555555555555;
  bits = (bits & 0x3333333333333333) + (bits >> 2 & 0x3333333333333333);
  return static_cast<int>(((bits + (bits >> 4)) & 0x0F0F0F0F0F0F0F0F) * 0x0101010101010101 >> 56);
}

}  // namespace soapfilm
