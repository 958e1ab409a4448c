// The head of a NumPy file (.npy, versions 1 to 3): a Python literal that says what the array's bytes mean.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "soapfilm/io/bytes/binary_fields.h"
#include "soapfilm/io/bytes/byte_source.h"

namespace soapfilm::io {

struct NpyHeader {
  static constexpr size_t most_fields = 256;

  bool fortran_order = false;
  std::vector<uint64_t> shape;
  bool has_names = false;           ///< of a structured array; else its elements are numbers, and `fields` has one
  std::vector<BinaryField> fields;  ///< offsets count from the element's beginning
  std::vector<std::string> unread;  ///< names of fields that are no numbers
  size_t element_bytes = 0;
  size_t data = 0;  ///< where the elements begin
};

/// Throws InputError for a head that is damaged, or describes what this program does not read.
NpyHeader read_npy_header(ByteSource& source);

/// Such as "(5, 3)".
std::string describe_shape(const std::vector<uint64_t>& shape);

}  // namespace soapfilm::io
