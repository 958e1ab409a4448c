#include "soapfilm/io/ply/ply_header.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "soapfilm/error.h"
#include "soapfilm/io/text/text.h"

namespace soapfilm::io {

namespace {

struct TypeName {
  std::string_view name;
  PlyType type;
};
constexpr std::array<TypeName, 17> type_names{{{"bool", PlyType::uint8},
                                               {"char", PlyType::int8},
                                               {"int8", PlyType::int8},
                                               {"uchar", PlyType::uint8},
                                               {"uint8", PlyType::uint8},
                                               {"short", PlyType::int16},
                                               {"int16", PlyType::int16},
                                               {"ushort", PlyType::uint16},
                                               {"uint16", PlyType::uint16},
                                               {"int", PlyType::int32},
                                               {"int32", PlyType::int32},
                                               {"uint", PlyType::uint32},
                                               {"uint32", PlyType::uint32},
                                               {"float", PlyType::float32},
                                               {"float32", PlyType::float32},
                                               {"double", PlyType::float64},
                                               {"float64", PlyType::float64}}};

/// The text of a PLY from the end of its first line on; empty if it does not begin with `ply` and perhaps blanks.
std::string_view after_first_line(const ByteSource& source) {
  const std::string_view text = after_byte_order_mark(source.bytes());
  if (text.substr(0, 3) != "ply") return {};
  const size_t end = text.find_first_not_of(" \t", 3);
  if (end == std::string_view::npos || (text[end] != '\n' && text[end] != '\r')) return {};
  return text.substr(end);
}

char line_end_of(const ByteSource& source) {
  const std::string_view rest = after_first_line(source);
  return !rest.empty() && rest[0] == '\r' && rest.substr(0, 2) != "\r\n" ? '\r' : '\n';
}

/// One pass over the header's lines; a member function per keyword.
class HeaderParser {
 public:
  explicit HeaderParser(ByteSource& source) : cursor_(source) {
    header_.line_end = line_end_of(source);
    cursor_.end_lines_with(header_.line_end);
  }

  PlyHeader parse() {
    std::string_view line;
    cursor_.next_line(line);  // "ply", already checked by looks_like_ply()
    while (cursor_.next_line(line)) {
      std::string_view rest = line;
      std::string_view keyword;
      if (!next_field(rest, keyword)) continue;
      if (keyword == "end_header") return finish();
      if (keyword == "format") {
        parse_format(rest);
      } else if (keyword == "element") {
        parse_element(rest);
      } else if (keyword == "property") {
        parse_property(rest);
      } else if (keyword == "comment" || keyword == "obj_info") {
        header_.notes.push_back({std::string(rest), cursor_.line()});
      } else {
        note_stray_line(line, keyword, rest);
      }
    }
    cursor_.fail("truncated: the header has no end_header line");
  }

 private:
  void parse_format(std::string_view rest) {
    const std::string_view name = field(rest, "the format");
    if (name == "ascii") {
      header_.format = PlyFormat::ascii;
    } else if (name == "binary_little_endian") {
      header_.format = PlyFormat::binary_little_endian;
    } else if (name == "binary_big_endian") {
      header_.format = PlyFormat::binary_big_endian;
    } else {
      cursor_.fail("format " + in_quotes(name) + ", must be ascii, binary_little_endian or binary_big_endian");
    }
    format_seen_ = true;
  }

  /// A remark without `comment` before it, but not a misspelled keyword.
  void note_stray_line(std::string_view line, std::string_view keyword, std::string_view rest) {
    constexpr size_t most = 100;
    std::string_view second, third;
    next_field(rest, second);
    next_field(rest, third);
    int64_t count = 0;
    const bool is_type =
        std::any_of(type_names.begin(), type_names.end(), [&](const TypeName& known) { return known.name == second; });
    const bool is_element = parse_integer(third, count) && !next_field(rest, third);
    if (is_type || is_element || second == "list" || second == "ascii" || second.substr(0, 7) == "binary_" ||
        header_.stray.size() == most)
      cursor_.fail("header keyword " + in_quotes(keyword) +
                   ", must be format, element, property, comment, obj_info or end_header");
    header_.stray.push_back({std::string(line), cursor_.line()});
    header_.notes.push_back(header_.stray.back());
  }

  void parse_element(std::string_view rest) {
    PlyElement element;
    element.name = field(rest, "the element's name");
    element.line = cursor_.line();
    const std::string_view count_text = field(rest, "the element's count");
    int64_t count = 0;
    if (!parse_integer(count_text, count) || count < 0)
      cursor_.fail(fmt::format("element {}: count = {}, must be an integer >= 0", in_quotes(element.name),
                               in_quotes(count_text)));
    element.count = static_cast<uint64_t>(count);
    if (header_.find(element.name) != nullptr) cursor_.fail("element " + in_quotes(element.name) + " appears twice");
    header_.elements.push_back(std::move(element));
  }

  void parse_property(std::string_view rest) {
    if (header_.elements.empty()) cursor_.fail("property before the first element");
    PlyElement& element = header_.elements.back();
    PlyProperty property;
    std::string_view type = field(rest, "the property's type");
    if (type == "list") {
      property.count_type = parse_type(field(rest, "the type of the list's count"));
      if (!is_integer(*property.count_type)) cursor_.fail("the list's count has a float type, must be an integer type");
      type = field(rest, "the type of the list's items");
    }
    property.type = parse_type(type);
    property.name = field(rest, "the property's name");
    for (const PlyProperty& other : element.properties)
      if (other.name == property.name) cursor_.fail("property " + in_quotes(property.name) + " appears twice");
    element.properties.push_back(std::move(property));
  }

  PlyType parse_type(std::string_view name) const {
    for (const TypeName& known : type_names)
      if (known.name == name) return known.type;
    cursor_.fail("type " + in_quotes(name) +
                 ", must be char, uchar, short, ushort, int, uint, float, double or int8 ... float64");
  }

  std::string_view field(std::string_view& rest, std::string_view what) const {
    std::string_view text;
    if (!next_field(rest, text)) cursor_.fail(fmt::format("the line ends where {} must follow", what));
    return text;
  }

  PlyHeader finish() {
    if (!format_seen_) cursor_.fail("the header has no format line");
    header_.body_offset = cursor_.offset();
    header_.body_line = cursor_.line() + 1;
    return std::move(header_);
  }

  TextCursor cursor_;
  PlyHeader header_;
  bool format_seen_ = false;
};

size_t find_property(const PlyElement& element, std::string_view name, bool list) {
  for (size_t k = 0; k < element.properties.size(); ++k)
    if (element.properties[k].name == name && element.properties[k].is_list() == list) return k;
  return PlyElement::absent;
}

}  // namespace

const char* describe(PlyFormat format) {
  switch (format) {
    case PlyFormat::ascii:
      return "PLY, ASCII";
    case PlyFormat::binary_little_endian:
      return "PLY, binary little-endian";
    case PlyFormat::binary_big_endian:
      return "PLY, binary big-endian";
  }
  return "";
}

size_t PlyElement::find_scalar(std::string_view property) const { return find_property(*this, property, false); }
size_t PlyElement::find_list(std::string_view property) const { return find_property(*this, property, true); }

size_t PlyElement::least_row_bytes(PlyFormat format) const {
  if (format == PlyFormat::ascii) return 2 * properties.size();  // a digit and a blank each
  size_t bytes = 0;
  for (const PlyProperty& property : properties) bytes += size_of(property.count_type.value_or(property.type));
  return bytes;
}

const PlyElement* PlyHeader::find(std::string_view element) const {
  const auto found =
      std::find_if(elements.begin(), elements.end(), [&](const PlyElement& other) { return other.name == element; });
  return found == elements.end() ? nullptr : &*found;
}

void warn_of_stray_lines(const PlyHeader& header, const std::string& path, ReadReport& report) {
  if (header.stray.empty()) return;
  const PlyNote& first = header.stray.front();
  report.warnings.push_back(fmt::format(
      "{}:{}: {}{}: no keyword of a PLY header, taken for a comment", path, first.line, in_quotes(first.text),
      header.stray.size() == 1 ? "" : fmt::format(" and {} more lines", header.stray.size() - 1)));
}

bool looks_like_ply(const ByteSource& source) { return !after_first_line(source).empty(); }

PlyHeader read_ply_header(ByteSource& source) {
  if (!looks_like_ply(source))
    throw InputError(fmt::format("{}:1: not a PLY file: begins with {}, must begin with a line 'ply'", source.path(),
                                 in_quotes(source.bytes().substr(0, 8))));
  return HeaderParser(source).parse();
}

}  // namespace soapfilm::io
