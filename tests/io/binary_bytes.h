// Bytes of binary files that tests make.
#pragma once

#include <cstring>
#include <initializer_list>
#include <string>

#include "soapfilm/io/bytes/byte_source.h"

namespace soapfilm {

template <class T>
std::string bytes_of(T value, bool big_endian = false) {
  if (big_endian != (std::endian::native == std::endian::big)) value = io::swap_bytes(value);
  return std::string(reinterpret_cast<const char*>(&value), sizeof(T));
}

template <class T>
std::string bytes_of(std::initializer_list<T> values) {
  std::string bytes;
  for (const T value : values) bytes += bytes_of(value);
  return bytes;
}

template <class T>
void put(std::string& bytes, size_t at, T value) {
  bytes.replace(at, sizeof(T), bytes_of(value));
}

}  // namespace soapfilm
