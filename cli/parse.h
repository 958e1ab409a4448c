// Option texts as numbers, points and lengths. Refusals are ParameterErrors that quote the option and its value.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "soapfilm/core/vec.h"

namespace soapfilm::cli {

/// Numbers separated by `separator`, exactly `count` of them; `form` says what is expected.
std::vector<double> parse_numbers(const char* option, const std::string& text, char separator, size_t count,
                                  const char* form);

/// X,Y,Z.
Vec3d parse_point(const char* option, const std::string& text);

/// A length in input units, or with a percent sign in hundredths of `longest`.
double parse_length(const char* option, const std::string& text, double longest);

}  // namespace soapfilm::cli
