#include "soapfilm/io/pcd/pcd_header.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "soapfilm/error.h"
#include "soapfilm/io/text/number_line.h"
#include "soapfilm/io/text/text.h"

namespace soapfilm::io {

namespace {

constexpr size_t most_pcd_fields = 1024;

/// The words of a line, between blanks or commas; of a longer one than any header has only the first.
std::vector<std::string_view> words_of(std::string_view line) {
  std::vector<std::string_view> words;
  const auto ends = [](char c) { return is_blank(c) || c == ','; };
  while (words.size() <= most_pcd_fields) {
    while (!line.empty() && ends(line.front())) line.remove_prefix(1);
    const auto end = std::find_if(line.begin(), line.end(), ends) - line.begin();
    if (line.empty()) break;
    words.push_back(line.substr(0, static_cast<size_t>(end)));
    line.remove_prefix(static_cast<size_t>(end));
  }
  return words;
}

/// One pass over the header's lines; a member function per kind of keyword.
class PcdHeaderParser {
 public:
  explicit PcdHeaderParser(ByteSource& source) : source_(source), cursor_(source) {}

  PcdHeader parse(ReadReport& report) {
    std::string_view line;
    while (cursor_.next_content_line(line)) {
      std::string_view rest = line;
      std::string_view keyword;
      next_field(rest, keyword);
      if (keyword == "DATA") {
        parse_data(rest);
        finish();
        if (!unknown_.empty())
          report.warnings.push_back(
              fmt::format("{}: header keywords ignored: {}", source_.path(), fmt::join(unknown_, ", ")));
        return std::move(header_);
      }
      parse_line(keyword, rest);
    }
    cursor_.fail("truncated: the header has no DATA line");
  }

 private:
  void parse_line(std::string_view keyword, std::string_view rest) {
    if (keyword == "VERSION") {
      parse_version(rest);
    } else if (keyword == "FIELDS" || keyword == "COLUMNS") {
      parse_fields(rest);
    } else if (keyword == "SIZE") {
      parse_sizes(rest);
    } else if (keyword == "TYPE") {
      parse_types(rest);
    } else if (keyword == "COUNT") {
      parse_counts(rest);
    } else if (keyword == "WIDTH") {
      width_ = parse_number_of("WIDTH", rest, INT32_MAX);
    } else if (keyword == "HEIGHT") {
      height_ = parse_number_of("HEIGHT", rest, INT32_MAX);
    } else if (keyword == "POINTS") {
      points_ = parse_number_of("POINTS", rest, INT64_MAX);
      header_.points_line = cursor_.line();
    } else if (keyword == "VIEWPOINT") {
      parse_viewpoint(rest);
    } else {
      remember_unknown(keyword);
    }
  }

  void parse_version(std::string_view rest) const {
    constexpr std::string_view known[] = {".5", ".6", ".7", "0.5", "0.6", "0.7"};
    const std::vector<std::string_view> words = words_of(rest);
    if (words.size() != 1 || std::find(std::begin(known), std::end(known), words[0]) == std::end(known))
      cursor_.fail("VERSION = " + in_quotes(words.empty() ? std::string_view() : words[0]) +
                   ", must be 0.5, 0.6 or 0.7");
  }

  void parse_fields(std::string_view rest) {
    const std::vector<std::string_view> names = words_of(rest);
    if (!header_.fields.empty()) cursor_.fail("a second FIELDS line");
    if (names.empty() || names.size() > most_pcd_fields)
      cursor_.fail(fmt::format("FIELDS must have from 1 to {} names", most_pcd_fields));
    for (const std::string_view name : names) header_.fields.emplace_back().name = name;
    fields_line_ = cursor_.line();
  }

  /// The words after a keyword, one for each field.
  std::vector<std::string_view> one_per_field(std::string_view keyword, std::string_view rest) const {
    const std::vector<std::string_view> words = words_of(rest);
    if (words.size() != header_.fields.size())
      cursor_.fail(fmt::format("{} has {} values, must have one for each of the {} names after FIELDS", keyword,
                               words.size(), header_.fields.size()));
    return words;
  }

  void parse_sizes(std::string_view rest) {
    const std::vector<std::string_view> words = one_per_field("SIZE", rest);
    for (size_t k = 0; k < words.size(); ++k) header_.fields[k].size = parse_number_of("SIZE", words[k], 8);
  }

  void parse_types(std::string_view rest) {
    const std::vector<std::string_view> words = one_per_field("TYPE", rest);
    for (size_t k = 0; k < words.size(); ++k) {
      if (words[k] != "I" && words[k] != "U" && words[k] != "F")
        cursor_.fail("TYPE " + in_quotes(words[k]) + ", must be I, U or F");
      header_.fields[k].type = words[k][0];
    }
  }

  void parse_counts(std::string_view rest) {
    const std::vector<std::string_view> words = one_per_field("COUNT", rest);
    for (size_t k = 0; k < words.size(); ++k) header_.fields[k].count = parse_number_of("COUNT", words[k], INT32_MAX);
  }

  uint64_t parse_number_of(std::string_view what, std::string_view text, int64_t most) const {
    std::string_view word;
    int64_t value = 0;
    if (!next_field(text, word) || !parse_integer(word, value) || value < 1 || value > most)
      cursor_.fail(fmt::format("{} = {}, must be an integer from 1 to {}", what, in_quotes(word), most));
    return static_cast<uint64_t>(value);
  }

  void parse_viewpoint(std::string_view rest) {
    std::string buffer;
    const size_t count =
        parse_number_line(cursor_, without_commas(rest, header_.viewpoint.size(), buffer), header_.viewpoint);
    if (count != header_.viewpoint.size() ||
        !std::all_of(header_.viewpoint.begin(), header_.viewpoint.end(), [](double v) { return std::isfinite(v); }))
      cursor_.fail(fmt::format("VIEWPOINT of {} numbers, must be 7 finite ones: tx ty tz qw qx qy qz", count));
  }

  void parse_data(std::string_view rest) {
    const std::vector<std::string_view> words = words_of(rest);
    const std::string name = words.size() == 1 ? lower_case(words[0]) : std::string();
    if (name == "ascii")
      header_.data = PcdData::ascii;
    else if (name == "binary")
      header_.data = PcdData::binary;
    else if (name == "binary_compressed")
      header_.data = PcdData::compressed;
    else
      cursor_.fail("DATA " + in_quotes(words.empty() ? std::string_view() : words[0]) +
                   ", must be ascii, binary or binary_compressed");
  }

  void remember_unknown(std::string_view keyword) {
    constexpr size_t most = 16;
    const bool is_word = std::all_of(keyword.begin(), keyword.end(), [](char c) {
      return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || c == '_';
    });
    if (!is_word || unknown_.size() == most || header_.fields.empty())
      cursor_.fail("not a PCD header: begins with " + in_quotes(keyword) +
                   ", must be VERSION, FIELDS, SIZE, TYPE, COUNT, WIDTH, HEIGHT, VIEWPOINT, POINTS or DATA");
    unknown_.push_back(in_quotes(keyword));
  }

  void finish() {
    if (header_.fields.empty()) cursor_.fail("the header has no FIELDS line");
    for (PcdField& field : header_.fields) {
      const bool fits = field.type == 'F' ? field.size == 4 || field.size == 8
                                          : field.size == 1 || field.size == 2 || field.size == 4 || field.size == 8;
      if (!fits && !field.is_padding())
        throw InputError(
            fmt::format("{}:{}: field {}: TYPE {} of SIZE {}, must be F of 4 or 8, or I or U of 1, 2, 4 "
                        "or 8",
                        source_.path(), fields_line_, in_quotes(field.name), field.type, field.size));
      field.offset = header_.point_bytes;
      field.first_value = header_.point_values;
      header_.point_bytes += field.bytes();
      header_.point_values += field.count;
    }
    count_points();
    header_.body_offset = cursor_.offset();
    header_.body_line = cursor_.line() + 1;
    if (header_.data != PcdData::compressed) check_room();
  }

  void count_points() {
    if (width_ == 0 && points_ == 0) cursor_.fail("the header has neither WIDTH nor POINTS");
    header_.columns = width_ > 0 ? width_ : points_;
    header_.rows = width_ > 0 ? height_ : 1;
    header_.points = width_ > 0 ? width_ * height_ : points_;  // each below 2^31
    if (points_ > 0 && points_ != header_.points)
      throw InputError(fmt::format("{}:{}: POINTS = {}, must be WIDTH * HEIGHT = {} * {}", source_.path(),
                                   header_.points_line, points_, width_, height_));
  }

  void check_room() const {
    const uint64_t left = cursor_.remaining();
    const bool is_text = header_.data == PcdData::ascii;
    const uint64_t least = is_text ? 2 * header_.point_values : header_.point_bytes;  // a digit and a blank
    if (header_.points > (left + is_text) / least)
      throw InputError(fmt::format(
          "{}:{}: {} points, but the file is truncated: {} bytes are left and a point needs {}", source_.path(),
          header_.points_line > 0 ? header_.points_line : cursor_.line(), header_.points, left, least));
  }

  ByteSource& source_;
  TextCursor cursor_;
  PcdHeader header_;
  std::vector<std::string> unknown_;
  size_t fields_line_ = 0;
  uint64_t width_ = 0;  // 0: not given
  uint64_t height_ = 1;
  uint64_t points_ = 0;
};

}  // namespace

const char* describe(PcdData data) {
  switch (data) {
    case PcdData::ascii:
      return "PCD, ASCII";
    case PcdData::binary:
      return "PCD, binary";
    case PcdData::compressed:
      return "PCD, compressed";
  }
  return "";
}

bool looks_like_pcd(const ByteSource& source) {
  constexpr size_t longest = 4096;
  std::string_view text = after_byte_order_mark(source.bytes()).substr(0, longest);
  if (text.substr(0, 6) == "# .PCD") return true;
  while (!text.empty()) {
    const size_t end = std::min(text.find('\n'), text.size());
    std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    std::string_view keyword;
    if (!next_field(line, keyword) || keyword[0] == '#' || keyword == "VERSION") continue;
    return keyword == "FIELDS" || keyword == "COLUMNS";
  }
  return false;
}

PcdHeader read_pcd_header(ByteSource& source, ReadReport& report) { return PcdHeaderParser(source).parse(report); }

}  // namespace soapfilm::io
