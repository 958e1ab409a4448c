// Lines of a text as rows of numbers: separators, quotes, comments, decimal commas, absent fields.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace soapfilm::io {

/// A line without its end, and where the next one begins. Lines end with LF, CRLF or CR.
struct TextLine {
  std::string_view text;
  size_t next = 0;
};
TextLine line_at(std::string_view text, size_t offset);

/// The fields of a line up to a comment ('#' or '//' where a field may begin), without blanks and quotes around them.
/// Separator ' ': blanks and tabs; any other: exactly one between two fields, and a field may be empty.
void split_fields(std::string_view line, char separator, std::vector<std::string_view>& fields);

/// Is the line empty but for a comment? `after`: what follows its '#' or '//'.
bool is_comment(std::string_view line, std::string_view& after);

/// A field's number. Absent (empty or a word such as NA): not-a-number. A comma between digits is a point if
/// `decimal_commas`; then there are no points. False for any other text.
bool parse_field(std::string_view field, bool decimal_commas, double& value);

/// A number with one comma between digits, without a point.
bool has_decimal_comma(std::string_view field);

/// What a column's fields must be.
enum class FieldRule : unsigned char { number, any, skipped };  ///< any: text is counted and becomes not-a-number

struct RowRules {
  char separator = ' ';
  bool decimal_commas = false;
  std::vector<FieldRule> fields;            ///< one for each column
  size_t weight = static_cast<size_t>(-1);  ///< of this column, if there is one, numbers must be finite and >= 0
  bool more_columns = false;                ///< rows may go on: what follows is not read
  std::string_view header;                  ///< this line is skipped where it comes again
  std::string expected;                     ///< such as "as in line 2": who says how many columns there are
};

/// A line of one number: so many samples follow.
struct CountLine {
  size_t row = 0;   ///< rows before it
  size_t line = 0;  ///< lines before it
  double count = 0;
};

/// Text in a column of FieldRule::any.
struct TextFields {
  size_t column = 0;
  size_t count = 0;
  size_t line = 0;  ///< lines before the first of them
  std::string first;
};

/// The rows of a part of the text, which begins and ends with whole lines.
struct RowChunk {
  size_t begin = 0;
  size_t end = 0;
  size_t rows = 0;
  std::vector<double> values{};  ///< row by row; longer than that, for the memory is used again and again
  size_t lines = 0;
  std::vector<CountLine> counts{};
  std::vector<TextFields> texts{};
  std::optional<std::string>
      error{};  ///< what is wrong with the line after `lines` ones; nothing is read from there on
};
/// Fills the chunk from `begin` to `end`, whatever it held.
void read_rows(std::string_view text, const RowRules& rules, RowChunk& chunk);

/// "column 3 = 'x6', must be a number", and what else there is to say about it.
std::string not_a_number(size_t column, std::string_view field, bool decimal_commas);

}  // namespace soapfilm::io
