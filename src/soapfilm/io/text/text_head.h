// What the lines before the first row of a text say, and what the first rows look like.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "soapfilm/io/text/text_rows.h"

namespace soapfilm::io {

struct TextHead {
  char separator = ' ';
  bool decimal_commas = false;
  size_t columns = 0;              ///< that are read
  bool has_lists = false;          ///< rows have further ones, not all as many
  std::vector<std::string> names;  ///< one for each column, x, y and z among them; empty if no line says so
  std::string_view header;         ///< the line of the names
  size_t offset = 0;               ///< of the first row
  size_t line = 1;                 ///< its number
  std::optional<double> count;     ///< before it
  size_t count_line = 0;
  size_t row_bytes = 1;  ///< of a line on average, as far as looked at
  std::vector<std::string> warnings;
};

/// `named`: as many columns are named elsewhere (0: none), so no header is needed. Throws InputError for a text whose
/// first lines are no rows.
TextHead read_text_head(std::string_view text, size_t named, const std::string& path);

}  // namespace soapfilm::io
