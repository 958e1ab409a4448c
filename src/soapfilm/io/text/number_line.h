// A line of numbers, for text whose rows are lines.
#pragma once

#include <span>
#include <string_view>

#include "soapfilm/io/text/text.h"

namespace soapfilm::io {

/// Parses the numbers of the line that `cursor` read last, separated by blanks; returns how many. Throws InputError for
/// more than fit into `values` and for anything else.
size_t parse_number_line(const TextCursor& cursor, std::string_view line, std::span<double> values);

/// The next line that is not blank; false at the end of the file.
bool next_filled_line(TextCursor& cursor, std::string_view& line);

}  // namespace soapfilm::io
