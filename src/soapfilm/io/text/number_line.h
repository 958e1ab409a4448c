// A line of numbers, for text whose rows are lines.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "soapfilm/io/text/text.h"

namespace soapfilm::io {

/// Parses the numbers of the line that `cursor` read last, separated by blanks; returns how many. Throws InputError for
/// more than fit into `values` and for anything else.
size_t parse_number_line(const TextCursor& cursor, std::string_view line, std::span<double> values);

/// A line in which commas separate numbers, or are their decimal points if blanks alone separate `count` of them,
/// without commas; `buffer` holds it if there are some.
std::string_view without_commas(std::string_view line, size_t count, std::string& buffer);

/// The next line that is not blank; false at the end of the file.
bool next_filled_line(TextCursor& cursor, std::string_view& line);

}  // namespace soapfilm::io
