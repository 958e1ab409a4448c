// Is somebody looking?
#pragma once

#include <cstddef>
#include <cstdio>

namespace soapfilm {

/// A terminal that can redraw its lines; never where the system does not say.
bool is_terminal(std::FILE* out);

/// Columns of the terminal; 80 where it does not say.
size_t terminal_columns(std::FILE* out);

}  // namespace soapfilm
