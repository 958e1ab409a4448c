// Checksums of E57: pages of 1024 bytes, the last 4 of them a CRC-32C of the others, big-endian.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>

namespace soapfilm::fuzz {

/// Slow, and written anew: nothing is shared with the reader.
inline uint32_t crc32c(const uint8_t* data, size_t size) {
  uint32_t crc = 0xFFFFFFFFu;
  for (size_t i = 0; i < size; ++i) {
    crc ^= data[i];
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1) ^ ((crc & 1) != 0 ? 0x82F63B78u : 0u);
  }
  return ~crc;
}

/// Of a file that begins as E57; others stay as they are.
inline void mend_page_checksums(uint8_t* data, size_t size) {
  constexpr size_t page = 1024, content = 1020;
  if (size < 8 || std::memcmp(data, "ASTM-E57", 8) != 0) return;
  for (size_t at = 0; at + page <= size; at += page) {
    const uint32_t crc = crc32c(data + at, content);
    for (size_t k = 0; k < 4; ++k) data[at + content + k] = static_cast<uint8_t>(crc >> (24 - 8 * k));
  }
}

}  // namespace soapfilm::fuzz
