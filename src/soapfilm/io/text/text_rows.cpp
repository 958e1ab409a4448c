#include "soapfilm/io/text/text_rows.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "soapfilm/io/text/text.h"

namespace soapfilm::io {

namespace {

bool is_end_of_line(char c) { return c == '\n' || c == '\r'; }
bool is_decimal_digit(char c) { return c >= '0' && c <= '9'; }

bool begins_comment(std::string_view text) {
  return !text.empty() && (text.front() == '#' || text.substr(0, 2) == "//");
}

std::string_view without_blanks_around(std::string_view text) {
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return text;
}

/// Takes the field at the front of `line`, which is no blank, off it.
std::string_view take_field(std::string_view& line, char separator) {
  const auto ends = [&](char c) { return c == separator || (separator == ' ' && is_blank(c)); };
  const char quote = line.front();
  if (quote == '"' || quote == '\'') {
    const size_t close = std::min(line.find(quote, 1), line.size() - 1);
    std::string_view rest = line.substr(close + 1);
    const bool blank = !rest.empty() && is_blank(rest.front());
    while (separator != ' ' && !rest.empty() && is_blank(rest.front()) && rest.front() != separator)
      rest.remove_prefix(1);
    if (close > 0 && line[close] == quote && (rest.empty() || ends(rest.front()) || (blank && begins_comment(rest)))) {
      const std::string_view field = line.substr(1, close - 1);
      line = rest;
      return without_blanks_around(field);
    }
  }
  size_t end = 0;
  while (end < line.size() && !ends(line[end])) {
    if (end > 0 && is_blank(line[end - 1]) && begins_comment(line.substr(end))) break;
    ++end;
  }
  const std::string_view field = line.substr(0, end);
  line.remove_prefix(end);
  return without_blanks_around(field);
}

bool is_absent_field(std::string_view field) {
  if (field.empty()) return true;
  if (field.size() > 4) return false;
  const std::string word = lower_case(field);
  return word == "na" || word == "n/a" || word == "null" || word == "none";
}

/// Reads the rows of one chunk.
class RowReader {
 public:
  RowReader(std::string_view text, const RowRules& rules, RowChunk& chunk)
      : text_(text.substr(chunk.begin, chunk.end - chunk.begin)), rules_(rules), chunk_(chunk), numbers_(text_) {
    if (!rules.decimal_commas || rules.separator == ',') return;
    exchanged_ = text_;
    for (char& c : exchanged_) c = c == ',' ? '.' : c == '.' ? ',' : c;
    numbers_ = exchanged_;
  }

  void read() {
    const size_t columns = rules_.fields.size();
    for (size_t at = 0; at < text_.size(); ++chunk_.lines) {
      const size_t first = chunk_.rows * columns;
      if (first + columns > chunk_.values.size()) chunk_.values.resize(std::max(2 * first, first + columns));
      double* const row = chunk_.values.data() + first;
      if (const size_t next = read_usual_row(at, row); next != 0) {
        at = next;
        ++chunk_.rows;
      } else {
        const TextLine line = line_at(text_, at);
        if (read_any_row(line.text, row)) ++chunk_.rows;
        at = line.next;
      }
      if (rules_.weight < columns && chunk_.rows * columns > first) check_weight(row[rules_.weight]);
      if (chunk_.error) return;
    }
  }

 private:
  /// A line of as many numbers as there are columns, in their usual spelling. Returns where the next line begins; 0 for
  /// any other line.
  size_t read_usual_row(size_t offset, double* values) const {
    const char* at = numbers_.data() + offset;
    const char* const end = numbers_.data() + numbers_.size();
    const auto skip = [&] {
      while (at != end && (*at == ' ' || *at == '\t')) ++at;
    };
    const size_t columns = rules_.fields.size();
    const char separator = rules_.separator;
    if (rules_.decimal_commas && separator == ',') return 0;  // "1,5","2,5": commas between quotes
    for (size_t k = 0; k < columns; ++k) {
      skip();
      at = parse_usual_number(at, end, values[k], separator);
      if (at == nullptr) return 0;
      skip();
      if (separator == ' ' || k + 1 == columns) continue;
      if (at == end || *at != separator) return 0;
      ++at;
    }
    if (rules_.more_columns)
      while (at != end && !is_end_of_line(*at)) ++at;
    if (separator != ' ' && at != end && *at == separator) {
      ++at;
      skip();
    }
    if (at == end) return numbers_.size();
    if (!is_end_of_line(*at)) return 0;
    at += *at == '\r' && end - at > 1 && at[1] == '\n' ? 2 : 1;
    return static_cast<size_t>(at - numbers_.data());
  }

  /// Any line; false if it is no row.
  bool read_any_row(std::string_view line, double* row) {
    split_fields(line, rules_.separator, fields_);
    const size_t columns = rules_.fields.size();
    if (fields_.empty() || (!rules_.header.empty() && line == rules_.header)) return false;
    if (fields_.size() == 1) return read_count();
    while (fields_.size() > columns && fields_.back().empty()) fields_.pop_back();
    if (rules_.more_columns && fields_.size() > columns) fields_.resize(columns);
    if (fields_.size() != columns)
      return refuse(fmt::format("{} columns, must be {} {}", fields_.size(), columns, rules_.expected));
    for (size_t k = 0; k < columns; ++k) {
      row[k] = 0;
      if (rules_.fields[k] == FieldRule::skipped || parse_field(fields_[k], rules_.decimal_commas, row[k])) continue;
      if (rules_.fields[k] == FieldRule::number) return refuse(not_a_number(k + 1, fields_[k], rules_.decimal_commas));
      row[k] = std::numeric_limits<double>::quiet_NaN();
      add_text(k, fields_[k]);
    }
    return true;
  }

  bool read_count() {
    double count = 0;
    if (!parse_field(fields_[0], rules_.decimal_commas, count))
      return refuse(not_a_number(1, fields_[0], rules_.decimal_commas));
    if (!(count >= 0) || !std::isfinite(count) || count != std::floor(count))
      return refuse(
          fmt::format("{} alone on a line, must be a count of samples or at least 3 columns", in_quotes(fields_[0])));
    chunk_.counts.push_back({chunk_.rows, chunk_.lines, count});
    return false;
  }

  void check_weight(double weight) {
    if (!(weight >= 0) || !std::isfinite(weight)) refuse(fmt::format("weight = {}, must be finite and >= 0", weight));
  }

  void add_text(size_t column, std::string_view field) {
    for (TextFields& text : chunk_.texts)
      if (text.column == column) {
        ++text.count;
        return;
      }
    chunk_.texts.push_back({column, 1, chunk_.lines, std::string(field.substr(0, 80))});
  }

  bool refuse(std::string what) {
    chunk_.error = std::move(what);
    return false;
  }

  std::string_view text_;
  const RowRules& rules_;
  RowChunk& chunk_;
  std::string exchanged_;     // the text with ',' and '.' in each other's place
  std::string_view numbers_;  // the text with decimal points
  std::vector<std::string_view> fields_;
};

}  // namespace

TextLine line_at(std::string_view text, size_t offset) {
  size_t end = offset;
  while (end < text.size() && !is_end_of_line(text[end])) ++end;
  const bool two = text.substr(end, 2) == "\r\n";
  return {text.substr(offset, end - offset), std::min(end + (two ? 2 : 1), text.size())};
}

void split_fields(std::string_view line, char separator, std::vector<std::string_view>& fields) {
  constexpr size_t most_fields = 1024;  // more than any table of samples has
  fields.clear();
  bool after_separator = false;
  while (fields.size() < most_fields) {
    while (!line.empty() && is_blank(line.front()) && line.front() != separator) line.remove_prefix(1);
    while (separator == ' ' && !line.empty() && line.front() == ' ') line = without_blanks_around(line);
    if (line.empty() || begins_comment(line)) {
      if (after_separator) fields.emplace_back();
      return;
    }
    fields.push_back(take_field(line, separator));
    if (separator == ' ') continue;
    while (!line.empty() && is_blank(line.front()) && line.front() != separator) line.remove_prefix(1);
    after_separator = !line.empty() && line.front() == separator;
    if (after_separator) line.remove_prefix(1);
  }
}

bool is_comment(std::string_view line, std::string_view& after) {
  line = without_blanks_around(line);
  if (!begins_comment(line)) return false;
  while (!line.empty() && (line.front() == '#' || line.front() == '/')) line.remove_prefix(1);
  after = without_blanks_around(line);
  return true;
}

bool has_decimal_comma(std::string_view field) {
  const size_t comma = field.find(',');
  if (comma == std::string_view::npos || comma == 0 || comma + 1 >= field.size()) return false;
  if (field.find(',', comma + 1) != std::string_view::npos || field.find('.') != std::string_view::npos) return false;
  double value = 0;
  std::string point(field);
  point[comma] = '.';
  return is_decimal_digit(field[comma - 1]) && is_decimal_digit(field[comma + 1]) && parse_number(point, value);
}

bool parse_field(std::string_view field, bool decimal_commas, double& value) {
  if (is_absent_field(field)) {
    value = std::numeric_limits<double>::quiet_NaN();
    return true;
  }
  if (!decimal_commas) return parse_number(field, value);
  if (field.find(',') == std::string_view::npos)
    return field.find('.') == std::string_view::npos && parse_number(field, value);
  if (!has_decimal_comma(field)) return false;
  std::string point(field);
  point[field.find(',')] = '.';
  return parse_number(point, value);
}

void read_rows(std::string_view text, const RowRules& rules, RowChunk& chunk) {
  chunk.rows = chunk.lines = 0;
  chunk.counts.clear();
  chunk.texts.clear();
  chunk.error.reset();
  RowReader(text, rules, chunk).read();
}

std::string not_a_number(size_t column, std::string_view field, bool decimal_commas) {
  std::string text = fmt::format("column {} = {}, must be a number", column, in_quotes(field));
  double value = 0;
  if (decimal_commas && parse_number(field, value))
    text += " with a decimal comma, as others in this file";
  else if (has_decimal_comma(field))
    text += " with a decimal point, as others in this file";
  else if (field.find_first_of(" \t,;") != std::string_view::npos)
    text += ": one kind of separator between columns, blanks or ',' or ';'";
  return text;
}

}  // namespace soapfilm::io
