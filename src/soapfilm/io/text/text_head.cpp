#include "soapfilm/io/text/text_head.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "soapfilm/error.h"
#include "soapfilm/io/point_columns.h"
#include "soapfilm/io/text/header_names.h"
#include "soapfilm/io/text/text.h"

namespace soapfilm::io {

namespace {

constexpr size_t most_columns = 1000;
constexpr size_t most_titles = 20;              // lines of text before the first row
constexpr size_t last_header = 1000;            // line
constexpr size_t first_rows = size_t{1} << 16;  // bytes of them, which tell the separators

using HeadFields = std::vector<std::string_view>;

/// The separator of a row; with neither commas nor semicolons: blanks.
char separator_of_row(std::string_view row) {
  HeadFields fields;
  split_fields(row, ';', fields);
  if (fields.size() > 1) return ';';
  split_fields(row, ',', fields);
  const auto has_blank = [](std::string_view field) {
    return std::any_of(field.begin(), field.end(), [](char c) { return is_blank(c); });
  };
  if (fields.size() < 2 || std::count_if(fields.begin(), fields.end(), has_blank) > 0) {
    HeadFields words;
    split_fields(row, ' ', words);
    const auto is_part = [](std::string_view word) { return word.find(',') == std::string_view::npos; };
    if (fields.size() < 2 ||
        std::all_of(words.begin(), words.end(), [&](auto word) { return is_part(word) || has_decimal_comma(word); }))
      return ' ';
  }
  return ',';
}

/// Of the first rows.
struct RowLengths {
  size_t shortest = 0, longest = 0, first = 0, rows = 0, others = 0;

  void add(size_t length) {
    if (length < 2) return;  // a comment or a count
    if (rows++ == 0) shortest = longest = first = length;
    shortest = std::min(shortest, length);
    longest = std::max(longest, length);
    others += length != first;
  }
  /// Not a few broken rows.
  bool are_of_lists() const { return shortest >= 3 && longest > shortest + 1 && others >= 3 && 5 * others >= rows; }
};

struct HeadLine {
  std::string_view text;
  size_t line = 0;
  bool comment = false;
};

class HeadReader {
 public:
  HeadReader(std::string_view text, size_t named, const std::string& path) : text_(text), named_(named), path_(path) {}

  TextHead read() {
    find_first_row();
    find_columns();
    find_names();
    return std::move(head_);
  }

 private:
  [[noreturn]] void fail(size_t line, const std::string& what) const {
    throw InputError(fmt::format("{}:{}: {}", path_, line, what));
  }

  /// Passes comments, titles, header and counts.
  void find_first_row() {
    size_t titles = 0;
    while (head_.offset < text_.size()) {
      const TextLine line = line_at(text_, head_.offset);
      if (is_row(line.text)) return;
      if (std::string_view after; is_comment(line.text, after)) {
        if (head_.line <= last_header && is_header(line.text)) before_.push_back({line.text, head_.line, true});
      } else if (!fields_.empty() && !is_count() && lower_case(line.text.substr(0, 4)) != "sep=") {
        if (lower_case(fields_[0]) == "ncols")
          fail(head_.line,
               "'ncols' begins an ESRI ASCII grid of heights, must be samples as lines x y z: convert it "
               "(gdal_translate -of XYZ)");
        if (++titles > most_titles) break;
        before_.push_back({line.text, head_.line, false});
      }
      if (before_.size() > most_titles + 1) before_.erase(before_.begin());
      head_.offset = line.next;
      ++head_.line;
    }
    for (const HeadLine& line : before_)
      if (!line.comment && !is_header(line.text)) refuse_text(line);
    throw InputError(path_ + ": holds no samples");
  }

  /// A line of numbers. Once names are known one number is enough: others may be text. Fills fields_.
  bool is_row(std::string_view line) {
    const char separator = separator_of_row(line);
    split_fields(line, separator, fields_);
    if (fields_.size() < 2) return false;
    const auto is_number = [](std::string_view field) {
      double value = 0;
      return !field.empty() && (parse_field(field, false, value) || has_decimal_comma(field));
    };
    const auto numbers = static_cast<size_t>(std::count_if(fields_.begin(), fields_.end(), is_number));
    const bool is_known =
        named_ > 0 || std::any_of(before_.begin(), before_.end(), [](const HeadLine& l) { return is_header(l.text); });
    if (is_known ? numbers == 0 : !is_number(fields_[0]) && !(fields_[0].empty() && numbers > 1)) return false;
    head_.separator = separator;
    return true;
  }

  static bool is_header(std::string_view line) {
    std::string_view after;
    if (is_comment(line, after)) line = after;
    for (const char separator : {';', ',', '\t', ' '})
      if (names_positions(split_names(line, separator))) return true;
    return false;
  }

  /// Takes a count if fields_ is one.
  bool is_count() {
    double count = 0;
    if (fields_.size() != 1 || !parse_number(fields_[0], count)) return false;
    if (!(count >= 0) || !std::isfinite(count) || count != std::floor(count))
      fail(head_.line,
           fmt::format("{} alone on a line, must be a count of samples or at least 3 columns", in_quotes(fields_[0])));
    if (head_.count.value_or(0) > 0)
      fail(head_.line,
           fmt::format("0 samples, must be {} as the count in line {} says", *head_.count, head_.count_line));
    head_.count = count;
    head_.count_line = head_.line;
    return true;
  }

  [[noreturn]] void refuse_text(const HeadLine& line) {
    split_fields(line.text, separator_of_row(line.text), fields_);
    fail(line.line, not_a_number(1, fields_.empty() ? line.text : fields_[0], false) +
                        ", or the name of a column (--columns says what columns are: -,x,y,z)");
  }

  /// The number of columns is the first row's; if that ends with absent values, the longest of the first rows'.
  void find_columns() {
    HeadFields first;
    split_fields(line_at(text_, head_.offset).text, head_.separator, first);
    const bool wide = first.size() > most_columns;
    if (wide && named_ == 0)
      fail(head_.line,
           fmt::format("more than {} columns, must be at most as many (--columns x,y,z may name the first ones "
                       "alone)",
                       most_columns));
    size_t given = 0, lines = 0, offset = head_.offset;
    bool whole_pairs = head_.separator == ',' && named_ == 0, leading_zero = false;
    for (; offset < text_.size() && offset - head_.offset < first_rows; ++lines) {
      const TextLine line = line_at(text_, offset);
      offset = line.next;
      split_fields(line.text, head_.separator, fields_);
      lengths_.add(fields_.size());
      while (!fields_.empty() && fields_.back().empty()) fields_.pop_back();
      if (fields_.size() <= first.size()) given = std::max(given, fields_.size());
      head_.decimal_commas |= std::any_of(fields_.begin(), fields_.end(), has_decimal_comma);
      if (head_.separator == ',' && !head_.decimal_commas) refuse_blank_after_comma(line.text, head_.line + lines);
      if (fields_.size() > 1) whole_pairs = whole_pairs && are_whole_pairs(leading_zero);
    }
    head_.row_bytes = std::max<size_t>((offset - head_.offset) / std::max<size_t>(lines, 1), 1);
    if (whole_pairs && leading_zero)
      fail(head_.line,
           "whole numbers in pairs, the second with zeros before it: decimal commas with commas between "
           "columns; write points, or ';' between columns");
    head_.columns = given;
    if (named_ > given && named_ <= first.size()) head_.columns = named_;
    find_leading(wide);
    if (head_.columns < 3) fail(head_.line, fmt::format("{} columns, must be at least 3 (x y z)", head_.columns));
  }

  /// Rows that end with lists have a leading part in common: as long as the option or the header says, else as the
  /// shortest row.
  void find_leading(bool wide) {
    const size_t shortest = lengths_.shortest, longest = lengths_.longest;
    if (named_ > 0) {
      head_.has_lists =
          (named_ < shortest && (wide || shortest != longest)) || (named_ == shortest && lengths_.are_of_lists());
      if (head_.has_lists) head_.columns = named_;
      return;
    }
    std::optional<size_t> fixed;
    for (const HeadLine& line : before_)
      if (const std::vector<std::string> names = names_before_list(line.text, lengths_.are_of_lists());
          !names.empty() && names.size() <= shortest)
        fixed = names.size();
    if (!fixed && !lengths_.are_of_lists()) return;
    head_.has_lists = true;
    head_.columns = fixed.value_or(shortest);
    head_.warnings.push_back(
        fmt::format("{}: rows of {} to {} columns: the first {} of them are read (--columns may name them)", path_,
                    shortest, longest, head_.columns));
  }

  /// "1,5, 2,25, 3,125": are these three columns or six?
  void refuse_blank_after_comma(std::string_view line, size_t number) const {
    size_t with_blank = 0, decimal = 0, others = 0;
    for (size_t at = line.find(','); at != std::string_view::npos; at = line.find(',', at + 1)) {
      const bool blank = at + 1 < line.size() && is_blank(line[at + 1]);
      ++(blank ? with_blank : others);
    }
    if (with_blank < 2 || others == 0) return;
    for (std::string_view field; next_field(line, field);) {
      if (!field.empty() && field.back() == ',') field.remove_suffix(1);
      decimal += has_decimal_comma(field);
    }
    if (decimal >= with_blank)
      throw InputError(
          fmt::format("{}:{}: a blank after some commas and none after others: decimal commas? Write "
                      "points, or ';' between columns",
                      path_, number));
  }

  /// Do fields_ look like numbers with decimal commas, cut at them?
  bool are_whole_pairs(bool& leading_zero) const {
    if (fields_.size() < 6 || fields_.size() % 2 != 0) return false;
    for (size_t k = 0; k < fields_.size(); ++k) {
      int64_t value = 0;
      if (!parse_integer(fields_[k], value) || (k % 2 == 1 && fields_[k].front() == '-')) return false;
      if (k % 2 == 1) leading_zero = leading_zero || (fields_[k].size() > 1 && fields_[k].front() == '0');
    }
    return true;
  }

  /// The last line with names for all columns is the header.
  void find_names() {
    if (named_ > 0) return;
    HeadFields first;
    split_fields(line_at(text_, head_.offset).text, head_.separator, first);
    const HeadLine* header = nullptr;
    for (const HeadLine& line : before_)
      for (size_t columns = head_.columns; columns <= (head_.has_lists ? head_.columns : first.size()); ++columns) {
        std::vector<std::string> names =
            head_.has_lists ? names_before_list(line.text, true) : header_names(line.text, columns);
        if (names.size() != columns || !names_positions(names)) continue;
        head_.columns = columns;
        head_.names = std::move(names);
        header = &line;
        break;
      }
    if (header) head_.header = header->text;
    for (const HeadLine& line : before_)
      if (&line != header) judge_title(line);
    warn_of_repeated_names();
  }

  /// A line before the first row that is not the header.
  void judge_title(const HeadLine& line) {
    const std::vector<std::string> names = header_names(line.text, head_.columns);
    if (names_positions(names)) {
      const auto known = std::count_if(names.begin(), names.end(), is_known_column);
      if (line.comment && 2 * static_cast<size_t>(known) < names.size()) return;  // a sentence
      if (head_.names.empty()) use_names_in_part(line, names);
      return;
    }
    if (line.comment) return;
    if (head_.names.empty() && names_degrees(names))
      fail(line.line,
           "latitude and longitude are angles, must be lengths: project them to meters first (or say with "
           "--columns which columns are x, y and z)");
    double value = 0;
    HeadFields row;
    split_fields(line.text, head_.separator, row);
    const auto numbers = std::count_if(row.begin(), row.end(),
                                       [&](std::string_view f) { return parse_field(f, head_.decimal_commas, value); });
    if (row.size() == head_.columns && static_cast<size_t>(numbers) + 1 >= row.size()) refuse_text(line);
    if (head_.names.empty() && names.size() == head_.columns && use_names_without_positions(line, names)) return;
    const bool may_be_names = names.size() == head_.columns && head_.names.empty();
    head_.warnings.push_back(fmt::format("{}:{}: {} {}", path_, line.line, in_quotes(line.text),
                                         may_be_names
                                             ? "does not say which columns are x, y and z: they are judged by their "
                                               "values (--columns says what they are)"
                                             : "is passed over: no numbers, and not one name for each column"));
  }

  /// More or fewer names than columns, x, y and z among them. Of x, y and z alone values tell what follows them.
  void use_names_in_part(const HeadLine& line, std::vector<std::string> names) {
    const size_t given = names.size();
    names.resize(std::min(given, head_.columns));
    const bool used = names_positions(names) && names.size() > 3;
    if (used) {
      for (size_t k = names.size() + 1; k <= head_.columns; ++k) names.push_back(fmt::format("column_{}", k));
      head_.names = std::move(names);
      head_.header = line.text;
    }
    head_.warnings.push_back(fmt::format("{}:{}: {} names for {} columns: {} (--columns says what they are)", path_,
                                         line.line, given, head_.columns,
                                         used ? "used for the first ones" : "columns are judged by their values"));
  }

  /// A name for each column, but none that says where x, y and z are: they are the first three numbers whose names mean
  /// nothing else. The other columns keep their names: what they are is said. False if the line may be a title.
  bool use_names_without_positions(const HeadLine& line, std::vector<std::string> names) {
    const bool is_title = line.text.find_first_of(",;\t\"") == std::string_view::npos &&
                          std::none_of(names.begin(), names.end(), is_known_column);
    HeadFields row;
    split_fields(line_at(text_, head_.offset).text, head_.separator, row);
    const auto may_be_position = [&](size_t k) {
      double value = 0;
      return k < row.size() && !row[k].empty() && parse_field(row[k], head_.decimal_commas, value) &&
             !means_no_position(names[k]);
    };
    size_t first = 0;
    while (first + 3 <= names.size() &&
           !(may_be_position(first) && may_be_position(first + 1) && may_be_position(first + 2)))
      ++first;
    if (is_title || first + 3 > names.size()) return false;
    for (size_t k = 0; k < 3; ++k) names[first + k] = std::string(1, "xyz"[k]);
    head_.names = std::move(names);
    head_.header = line.text;
    head_.warnings.push_back(fmt::format(
        "{}:{}: {} does not say which columns are x, y and z: {} to {} are taken for them (--columns says what they "
        "are)",
        path_, line.line, in_quotes(line.text), first + 1, first + 3));
    return true;
  }

  void warn_of_repeated_names() {
    std::vector<std::string> seen;
    std::string repeated;
    for (const std::string& name : head_.names) {
      const std::string lower = lower_case(name);
      if (!lower.empty() && std::find(seen.begin(), seen.end(), lower) != seen.end())
        repeated += (repeated.empty() ? "" : ", ") + in_quotes(name);
      seen.push_back(lower);
    }
    if (!repeated.empty())
      head_.warnings.push_back(
          fmt::format("{}: the header names {} more than once: the first of them counts", path_, repeated));
  }

  std::string_view text_;
  size_t named_;
  const std::string& path_;
  TextHead head_;
  HeadFields fields_;
  RowLengths lengths_;
  std::vector<HeadLine> before_;  // the last lines that are neither rows nor counts
};

}  // namespace

TextHead read_text_head(std::string_view text, size_t named, const std::string& path) {
  return HeadReader(text, named, path).read();
}

}  // namespace soapfilm::io
