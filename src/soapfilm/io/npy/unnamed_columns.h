// What columns after x, y and z mean, judged by their values: for arrays of numbers without names.
#pragma once

#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "soapfilm/io/bytes/binary_fields.h"

namespace soapfilm::io {

struct JudgedColumns {
  std::vector<std::string> names;  ///< as meaning_of() knows them; of others "column 4" and so on, from 1
  double largest_color = std::numeric_limits<double>::infinity();  ///< numbers beyond it are no colors
  std::vector<std::string> warnings{};                             ///< what is not sure, without the file's name
};

/// Looks at some thousand rows, spread evenly. Three columns are normals if most rows have length 1, colors if most are
/// from 0 to 1 or whole and to 255; the odd one of four or seven further columns is an intensity if it is the first.
JudgedColumns judge_columns(std::string_view bytes, const std::vector<BinaryField>& fields, size_t rows);

}  // namespace soapfilm::io
