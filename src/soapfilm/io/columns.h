// Which columns of a file hold labels, whatever its format.
#pragma once

#include <algorithm>
#include <array>
#include <string_view>

#include "soapfilm/io/text.h"

namespace soapfilm::io {

/// Do the values of a column of this name say what a sample is, so that a mean of them means nothing?
inline bool holds_labels(std::string_view name) {
  constexpr std::array<std::string_view, 8> names = {"label",    "classification", "class",   "category",
                                                     "instance", "segment",        "scan_id", "object"};
  return std::find(names.begin(), names.end(), lower_case(std::string(name))) != names.end();
}

}  // namespace soapfilm::io
