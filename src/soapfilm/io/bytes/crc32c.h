// The checksum of E57 pages.
#pragma once

#include <cstddef>
#include <cstdint>

namespace soapfilm::io {

/// CRC-32C (Castagnoli), as in iSCSI (RFC 3720): of "123456789" it is 0xe3069283.
uint32_t crc32c(const char* bytes, size_t count);

}  // namespace soapfilm::io
