// The bytes of NumPy's .npy files.
#pragma once

#include <cstdint>
#include <string>

#include "binary_bytes.h"

namespace soapfilm {

/// What the head says: `type` as Python writes it, quotes included.
inline std::string npy_literal(const std::string& type, const std::string& shape, bool fortran = false) {
  return "{'descr': " + type + ", 'fortran_order': " + (fortran ? "True" : "False") + ", 'shape': " + shape + ", }";
}

/// A file with this literal in its head, which is padded to 64 bytes as NumPy does.
inline std::string npy(const std::string& literal, const std::string& data, int version = 1) {
  std::string head = "\x93NUMPY";
  head += static_cast<char>(version);
  head += '\0';
  const size_t before = head.size() + (version == 1 ? 2 : 4);
  std::string text = literal;
  while ((before + text.size() + 1) % 64 != 0) text += ' ';
  text += '\n';
  return head +
         (version == 1 ? bytes_of(static_cast<uint16_t>(text.size())) : bytes_of(static_cast<uint32_t>(text.size()))) +
         text + data;
}

}  // namespace soapfilm
