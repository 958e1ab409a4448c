#include "soapfilm/io/npy/npy_header.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <optional>

#include "soapfilm/error.h"
#include "soapfilm/io/npy/python_literal.h"
#include "soapfilm/io/text/text.h"

namespace soapfilm::io {

namespace {

constexpr size_t most_dimensions = 8;
constexpr int most_nesting = 4;
constexpr size_t most_name_bytes = 256;
constexpr uint64_t most_element_bytes = uint64_t{1} << 30;

/// What a type string such as '<f4' says.
struct NpyType {
  std::optional<NumberType> number{};  ///< none for strings, bytes, times and numbers of other sizes
  size_t bytes = 0;
  bool swap = false;
  bool padding = false;
};

/// The types that are read, with the byte order before them.
std::optional<NumberType> npy_number(char kind, uint64_t bytes) {
  if (kind == 'b' && bytes == 1) return NumberType::uint8;
  if (kind == 'f')
    return bytes == 4   ? std::optional(NumberType::float32)
           : bytes == 8 ? std::optional(NumberType::float64)
                        : std::nullopt;
  if (kind != 'i' && kind != 'u') return std::nullopt;
  const bool is_signed = kind == 'i';
  switch (bytes) {
    case 1:
      return is_signed ? NumberType::int8 : NumberType::uint8;
    case 2:
      return is_signed ? NumberType::int16 : NumberType::uint16;
    case 4:
      return is_signed ? NumberType::int32 : NumberType::uint32;
    case 8:
      return is_signed ? NumberType::int64 : NumberType::uint64;
    default:
      return std::nullopt;
  }
}

NpyType npy_type(const std::string& text, const PythonLiteral& literal) {
  const auto fail = [&] {
    literal.fail("the type before it is " + in_quotes(text) + ", must be like '<f4', '<f8', '<i4' or '|u1'");
  };
  if (text.size() < 2) fail();
  const size_t has_order = std::string_view("<>|=").find(text[0]) != std::string_view::npos ? 1 : 0;
  const char kind = text[has_order];
  if (kind == 'O') literal.fail("the type before it is Python objects: save an array of numbers");
  if (std::string_view("bfiucSUVMm").find(kind) == std::string_view::npos) fail();
  const std::string_view unit_cut = std::string_view(text).substr(has_order + 1);
  const std::string_view digits = unit_cut.substr(0, unit_cut.find('['));  // times have a unit: '<M8[ns]'
  int64_t bytes = 0;
  if (!parse_integer(digits, bytes) || bytes < 0 || static_cast<uint64_t>(bytes) > most_element_bytes) fail();
  NpyType type;
  type.number = npy_number(kind, static_cast<uint64_t>(bytes));
  type.bytes = static_cast<size_t>(bytes) * (kind == 'U' ? 4 : 1);
  const std::endian order = text[0] == '>'   ? std::endian::big
                            : text[0] == '<' ? std::endian::little
                                             : std::endian::native;
  type.swap = order != std::endian::native;
  type.padding = kind == 'V';
  return type;
}

/// Names of the parts of an array field: of three with a name that says what they are together, or numbered.
std::vector<std::string> part_names(const std::string& name, size_t parts) {
  struct Group {
    std::string_view name;
    std::array<std::string_view, 3> parts;
  };
  constexpr std::array<std::string_view, 3> xyz{"x", "y", "z"}, normal{"nx", "ny", "nz"}, rgb{"red", "green", "blue"},
      sensor{"sensor_x", "sensor_y", "sensor_z"};
  constexpr Group groups[] = {
      {"xyz", xyz},    {"position", xyz}, {"positions", xyz}, {"point", xyz},      {"points", xyz},   {"pos", xyz},
      {"coord", xyz},  {"coords", xyz},   {"normal", normal}, {"normals", normal}, {"rgb", rgb},      {"color", rgb},
      {"colors", rgb}, {"colour", rgb},   {"colours", rgb},   {"sensor", sensor},  {"origin", sensor}};
  std::vector<std::string> names;
  if (parts == 1) return {name};
  if (parts == 3)
    for (const Group& group : groups)
      if (lower_case(name) == group.name) return {group.parts.begin(), group.parts.end()};
  for (size_t k = 0; k < parts; ++k) names.push_back(fmt::format("{}_{}", name, k + 1));
  return names;
}

class NpyHeaderReader {
 public:
  NpyHeaderReader(std::string_view text, size_t offset, const std::string& path) : literal_(text, offset, path) {}

  NpyHeader read() {
    bool has_type = false, has_order = false, has_shape = false;
    const auto first_time = [&](bool& seen, const std::string& key) {
      if (seen) literal_.fail(in_quotes(key) + " is there twice");
      seen = true;
    };
    literal_.expect('{');
    while (!literal_.accept('}')) {
      const std::string key = literal_.string();
      literal_.expect(':');
      if (key == "descr") {
        first_time(has_type, key);
        read_type();
      } else if (key == "fortran_order") {
        first_time(has_order, key);
        header_.fortran_order = literal_.boolean();
      } else if (key == "shape") {
        first_time(has_shape, key);
        header_.shape = shape();
      } else {
        literal_.fail("after the key " + in_quotes(key) + ", must be 'descr', 'fortran_order' or 'shape'");
      }
      if (!literal_.accept(',') && literal_.peek() != '}') literal_.fail("must have ',' or '}' here");
    }
    literal_.expect_end();
    if (!has_type || !has_order || !has_shape) literal_.fail("must have 'descr', 'fortran_order' and 'shape'");
    return std::move(header_);
  }

 private:
  void read_type() {
    if (literal_.peek() == '[') {
      header_.has_names = true;
      read_fields("", 0);
    } else {
      const std::string text = literal_.string();
      const NpyType type = npy_type(text, literal_);
      if (!type.number)
        literal_.fail("the type before it is " + in_quotes(text) + ", must be f4, f8, or i or u of 1 to 8");
      add("", type, 1);
    }
    if (header_.element_bytes == 0) literal_.fail("the elements have no bytes");
  }

  /// A list of (name, type) or (name, type, shape); a type may be such a list.
  void read_fields(const std::string& prefix, int depth) {
    if (depth > most_nesting) literal_.fail(fmt::format("lists in lists, must be at most {}", most_nesting));
    literal_.expect('[');
    while (!literal_.accept(']')) {
      literal_.expect('(');
      const std::string name = prefix + field_name();
      if (name.size() > most_name_bytes) literal_.fail(fmt::format("a name of more than {} bytes", most_name_bytes));
      literal_.expect(',');
      if (literal_.peek() == '[') {
        read_fields(name.empty() ? name : name + ".", depth + 1);
        if (literal_.accept(',') && literal_.peek() != ')') literal_.fail("an array of lists, which is not read");
      } else {
        const NpyType type = npy_type(literal_.string(), literal_);
        add(name, type, literal_.accept(',') && literal_.peek() != ')' ? parts() : 1);
      }
      literal_.expect(')');
      if (!literal_.accept(',') && literal_.peek() != ']') literal_.fail("must have ',' or ']' here");
    }
  }

  /// A name, or (title, name).
  std::string field_name() {
    if (!literal_.accept('(')) return literal_.string();
    literal_.string();
    literal_.expect(',');
    std::string name = literal_.string();
    literal_.accept(',');
    literal_.expect(')');
    return name;
  }

  uint64_t parts() {
    uint64_t product = 1;
    for (const uint64_t n : literal_.peek() == '(' ? shape() : std::vector<uint64_t>{literal_.number()}) {
      if (n > most_element_bytes || product * n > most_element_bytes)
        literal_.fail(fmt::format("the field before it has too many parts, must be at most {}", most_element_bytes));
      product *= n;
    }
    return product;
  }

  std::vector<uint64_t> shape() {
    std::vector<uint64_t> sizes;
    literal_.expect('(');
    while (!literal_.accept(')')) {
      if (sizes.size() == most_dimensions) literal_.fail(fmt::format("must be at most {} dimensions", most_dimensions));
      sizes.push_back(literal_.number());
      if (!literal_.accept(',') && literal_.peek() != ')') literal_.fail("must have ',' or ')' here");
    }
    return sizes;
  }

  void add(const std::string& name, const NpyType& type, uint64_t parts) {
    if (type.bytes > 0 && parts > (most_element_bytes - header_.element_bytes) / type.bytes)
      literal_.fail(fmt::format("elements of more than {} bytes", most_element_bytes));
    const size_t offset = header_.element_bytes;
    header_.element_bytes += static_cast<size_t>(parts) * type.bytes;
    if (!type.number) {
      if (!(type.padding && name.empty())) header_.unread.push_back(name);
      if (header_.unread.size() > NpyHeader::most_fields) fail_of_fields();
      return;
    }
    if (parts > NpyHeader::most_fields || header_.fields.size() + parts > NpyHeader::most_fields) fail_of_fields();
    if (parts == 1 && type.bytes == 4 && (lower_case(name) == "rgb" || lower_case(name) == "rgba"))
      return add_packed_color(type, offset);
    size_t k = 0;
    for (std::string& part : part_names(name, static_cast<size_t>(parts))) {
      BinaryField field{.name = std::move(part), .type = *type.number};
      field.offset = offset + k++ * type.bytes;
      field.swap = type.swap;
      header_.fields.push_back(std::move(field));
    }
  }

  /// As the Point Cloud Library packs it into a number: bytes blue, green, red from the lowest up.
  void add_packed_color(const NpyType& type, size_t offset) {
    constexpr std::array<std::string_view, 3> from_highest{"red", "green", "blue"};
    const bool big_endian = (std::endian::native == std::endian::big) != type.swap;
    for (size_t k = 0; k < 3; ++k) {
      BinaryField field{.name = std::string(from_highest[k]), .type = NumberType::uint8};
      field.offset = offset + (big_endian ? 1 + k : 2 - k);
      header_.fields.push_back(std::move(field));
    }
  }

  [[noreturn]] void fail_of_fields() {
    literal_.fail(fmt::format("more fields than {}, must be at most that many", NpyHeader::most_fields));
  }

  PythonLiteral literal_;
  NpyHeader header_;
};

}  // namespace

std::string describe_shape(const std::vector<uint64_t>& shape) {
  return fmt::format("({}{})", fmt::join(shape, ", "), shape.size() == 1 ? "," : "");
}

NpyHeader read_npy_header(ByteSource& source) {
  constexpr std::string_view magic = "\x93NUMPY";
  if (!source.begins_with(magic))
    throw InputError(fmt::format("{}: byte 0: first bytes = {}, must be '\\x93NUMPY'", source.path(),
                                 in_quotes(source.bytes().substr(0, magic.size()))));
  ByteCursor cursor(source, magic.size());
  const int version = cursor.read<uint8_t>();
  cursor.skip(1);
  if (version < 1 || version > 3)
    throw InputError(fmt::format("{}: byte {}: version = {}, must be 1 to 3", source.path(), magic.size(), version));
  const size_t length = version == 1 ? cursor.read<uint16_t>() : cursor.read<uint32_t>();
  const size_t begin = cursor.offset();
  const std::string_view text(cursor.take(length), length);
  NpyHeader header = NpyHeaderReader(text, begin, source.path()).read();
  header.data = cursor.offset();
  return header;
}

}  // namespace soapfilm::io
