// Values in the encoding of files.
#pragma once

#include <bit>
#include <charconv>
#include <cstring>

#include "soapfilm/io/bytes/byte_source.h"

namespace soapfilm::io {

/// The longest text of a number.
inline constexpr size_t longest_number = 32;

/// One value, little-endian; returns its end.
template <class T>
char* put_binary(char* to, T value) {
  if constexpr (std::endian::native != std::endian::little) value = swap_bytes(value);
  std::memcpy(to, &value, sizeof(T));
  return to + sizeof(T);
}

/// One number as the shortest text that reads back as the same value; returns its end.
template <class T>
char* put_text(char* to, T value) {
  return std::to_chars(to, to + longest_number, value).ptr;
}

}  // namespace soapfilm::io
