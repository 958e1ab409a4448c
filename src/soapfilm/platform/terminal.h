// Properties of the terminal.
#pragma once

#include <cstddef>
#include <cstdio>

namespace soapfilm {

/// Whether it is a terminal that can redraw its lines; false if unknown.
bool is_terminal(std::FILE* out);

/// Columns of the terminal; 80 if unknown.
size_t terminal_columns(std::FILE* out);

}  // namespace soapfilm
