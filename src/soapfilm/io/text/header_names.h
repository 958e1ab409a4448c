// Names of columns in a line before the first row of a text.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace soapfilm::io {

/// The names in a line, with units in brackets at the end of theirs.
std::vector<std::string> split_names(std::string_view line, char separator);

/// The names in a header line, as many as `columns` if some separator gives so many; else as the first one that is in
/// the line gives them.
std::vector<std::string> header_names(std::string_view line, size_t columns);

/// The names of a header line with x, y and z before one of a list, such as TRACK[]; all of them if `whole` and there
/// is none. Empty for other lines.
std::vector<std::string> names_before_list(std::string_view line, bool whole);

bool names_positions(const std::vector<std::string>& names);
/// Latitude and longitude?
bool names_degrees(const std::vector<std::string>& names);

/// Does the name say that a column is something else, such as a number, a time, a color?
bool means_no_position(const std::string& name);

}  // namespace soapfilm::io
