#include "soapfilm/io/bytes/crc32c.h"

#include <array>
#include <bit>

#include "soapfilm/io/bytes/byte_source.h"

namespace soapfilm::io {

namespace {

constexpr size_t crc_slices = 8;
using CrcTables = std::array<std::array<uint32_t, 256>, crc_slices>;

/// Table k: the effect of a byte that k more bytes follow. Eight bytes are then eight independent look-ups (Kounavis
/// and Berry 2005, "A systematic approach to building high performance software-based CRC generators").
constexpr CrcTables make_crc_tables() {
  constexpr uint32_t polynomial = 0x82f63b78;  // 0x1edc6f41, bits reversed
  CrcTables tables{};
  for (uint32_t byte = 0; byte < 256; ++byte) {
    uint32_t crc = byte;
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1) ^ ((crc & 1) != 0 ? polynomial : 0);
    tables[0][byte] = crc;
  }
  for (size_t k = 1; k < crc_slices; ++k)
    for (size_t byte = 0; byte < 256; ++byte) {
      const uint32_t before = tables[k - 1][byte];
      tables[k][byte] = (before >> 8) ^ tables[0][before & 0xff];
    }
  return tables;
}
constexpr CrcTables crc_tables = make_crc_tables();

}  // namespace

uint32_t crc32c(const char* bytes, size_t count) {
  constexpr bool swap = std::endian::native != std::endian::little;
  const CrcTables& t = crc_tables;
  uint32_t crc = 0xffffffff;
  for (; count >= 8; count -= 8, bytes += 8) {
    const uint64_t w = load<uint64_t>(bytes, swap) ^ crc;
    crc = t[7][w & 0xff] ^ t[6][w >> 8 & 0xff] ^ t[5][w >> 16 & 0xff] ^ t[4][w >> 24 & 0xff] ^ t[3][w >> 32 & 0xff] ^
          t[2][w >> 40 & 0xff] ^ t[1][w >> 48 & 0xff] ^ t[0][w >> 56];
  }
  for (; count > 0; --count, ++bytes) crc = (crc >> 8) ^ t[0][(crc ^ static_cast<uint8_t>(*bytes)) & 0xff];
  return ~crc;
}

}  // namespace soapfilm::io
