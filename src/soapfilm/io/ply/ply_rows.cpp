#include "soapfilm/io/ply/ply_rows.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "soapfilm/core/parallel.h"
#include "soapfilm/error.h"

namespace soapfilm::io {

namespace {

double load_as_double(const char* at, PlyType type, bool swap) {
  switch (type) {
    case PlyType::int8:
      return load<int8_t>(at, swap);
    case PlyType::uint8:
      return load<uint8_t>(at, swap);
    case PlyType::int16:
      return load<int16_t>(at, swap);
    case PlyType::uint16:
      return load<uint16_t>(at, swap);
    case PlyType::int32:
      return load<int32_t>(at, swap);
    case PlyType::uint32:
      return load<uint32_t>(at, swap);
    case PlyType::float32:
      return static_cast<double>(load<float>(at, swap));
    case PlyType::float64:
      return load<double>(at, swap);
  }
  return 0;
}

/// How much text is read at once: enough to keep some threads busy, and little relative to the cloud, since several
/// files may be read at the same time.
constexpr size_t bytes_at_once = size_t{1} << 17, chunks_at_once = 16;

/// The lines from an offset of a text to a later one, and the rows that they begin with.
struct TextChunk {
  size_t begin = 0;
  size_t end = 0;
  std::vector<double> values;
  bool whole = false;  ///< every line is a row
};

/// A row is a line of `columns` numbers in their usual spelling, with blanks around them.
void read_chunk(std::string_view text, size_t columns, TextChunk& chunk) {
  const char* at = text.data() + chunk.begin;
  const char* const end = text.data() + chunk.end;
  const auto skip = [&] {
    while (at != end && is_blank(*at) && *at != '\n') ++at;
  };
  while (at != end) {
    const size_t row = chunk.values.size();
    chunk.values.resize(row + columns);
    for (size_t k = 0; k < columns; ++k) {
      skip();
      at = parse_usual_number(at, end, chunk.values[row + k]);
      if (at == nullptr) return;
    }
    skip();
    if (at == end || *at != '\n') return;
    ++at;
  }
  chunk.whole = true;
}

/// A `bool` as some programs write it, "True" or "false"; else none, and the token is not consumed.
std::optional<bool> take_truth(TextCursor& text) {
  text.skip_blanks();
  const size_t offset = text.offset(), line = text.line();
  const std::string word = lower_case(text.token().substr(0, 8));
  if (word == "true" || word == "false") return word == "true";
  text.jump(offset, line);
  return std::nullopt;
}

}  // namespace

PlyRows::PlyRows(ByteSource& source, const PlyHeader& header, const Context* context)
    : source_(source), header_(header), context_(context) {
  if (header.format == PlyFormat::ascii) {
    text_.emplace(source, header.body_offset, header.body_line);
    text_->end_lines_with(header.line_end);
    return;
  }
  binary_.emplace(source, header.body_offset,
                  header.format == PlyFormat::binary_big_endian ? std::endian::big : std::endian::little);
}

void PlyRows::begin(const PlyElement& element) {
  element_ = &element;
  rows_read_ = row_ = 0;
  values_.assign(element.properties.size(), 0.0);
  lists_.assign(element.properties.size(), List{});
  row_bytes_ = element.least_row_bytes(header_.format);
  has_lists_ = std::any_of(element.properties.begin(), element.properties.end(),
                           [](const PlyProperty& property) { return property.is_list(); });
  reads_ahead_ =
      text_ && !has_lists_ && element.count * row_bytes_ > bytes_at_once && context_ && context_->threads() > 1;
  ahead_ = {};
  plain_floats_ = binary_ && !binary_->swaps() &&
                  std::all_of(element.properties.begin(), element.properties.end(), [](const PlyProperty& property) {
                    return !property.is_list() && property.type == PlyType::float32;
                  });
  const size_t remaining = text_ ? text_->remaining() + 1 : binary_->remaining();  // the last blank may be missing
  if (row_bytes_ > 0 && element.count > remaining / row_bytes_)
    throw InputError(fmt::format(
        "{}:{}: element {}: count = {}, but the file is truncated: {} bytes are left and a row needs at least {}",
        source_.path(), element.line, in_quotes(element.name), element.count, remaining, row_bytes_));
}

void PlyRows::next() {
  row_ = rows_read_++;
  const std::vector<PlyProperty>& properties = element_->properties;
  if (binary_ && !has_lists_) {  // the usual case, with one check of the bounds per row
    const char* at = binary_->take(row_bytes_);
    for (size_t k = 0; k < properties.size(); at += size_of(properties[k++].type))
      values_[k] = load_as_double(at, properties[k].type, binary_->swaps());
    return binary_->release();
  }
  if (reads_ahead_ && ahead_.taken == ahead_.rows) read_ahead();
  if (ahead_.taken < ahead_.rows) {
    std::copy_n(ahead_.values.data() + ahead_.taken++ * values_.size(), values_.size(), values_.data());
    return;
  }
  ahead_.rows = ahead_.taken = 0;
  items_.clear();
  for (size_t k = 0; k < properties.size(); ++k) {
    if (properties[k].is_list())
      read_list(k);
    else
      values_[k] = read_value(properties[k], properties[k].type);
  }
  if (text_)
    text_->release();
  else
    binary_->release();
}

/// If a chunk's lines are not all rows of this element, the rest of it is read value by value: that code knows every
/// spelling, and reports errors.
void PlyRows::read_ahead() {
  text_->skip_blanks();
  const std::string_view text = source_.bytes();
  std::vector<TextChunk> chunks;
  const size_t most_chunks = std::min(chunks_at_once, 2 * static_cast<size_t>(context_->threads()));
  for (size_t begin = text_->offset(); begin < text.size() && chunks.size() < most_chunks;) {
    const size_t last = text.find('\n', std::min(begin + bytes_at_once, text.size()) - 1);
    if (last == std::string_view::npos) break;
    chunks.push_back({begin, last + 1, {}, false});
    begin = last + 1;
  }
  parallel_for(*context_, chunks.size(), 1, [&](size_t k) { read_chunk(text, values_.size(), chunks[k]); });

  ahead_ = {{}, 0, 0, text_->line()};
  reads_ahead_ = chunks.size() == most_chunks;
  for (const TextChunk& chunk : chunks) {
    const size_t rows = chunk.values.size() / values_.size();
    if (!chunk.whole || rows > element_->count - row_ - ahead_.rows) {
      reads_ahead_ = false;
      break;
    }
    ahead_.values.insert(ahead_.values.end(), chunk.values.begin(), chunk.values.end());
    ahead_.rows += rows;
    text_->jump(chunk.end, ahead_.first_line + ahead_.rows);
  }
  text_->release();
}

const char* PlyRows::take_floats(size_t count) {
  const char* at = binary_->take(count * row_bytes_);
  rows_read_ += count;
  row_ = rows_read_ - 1;
  binary_->release();
  return at;
}

double PlyRows::read_value(const PlyProperty& property, PlyType type) {
  if (!text_) return load_as_double(binary_->take(size_of(type)), type, binary_->swaps());
  if (is_integer(type))
    if (const std::optional<uint32_t> count = text_->small_count()) return *count;
  if (type == PlyType::uint8)
    if (const std::optional<bool> truth = take_truth(*text_)) return *truth;
  return text_->number(property.name);
}

void PlyRows::read_list(size_t index) {
  const PlyProperty& property = element_->properties[index];
  const double count = read_value(property, *property.count_type);
  const double most = text_ ? static_cast<double>(text_->remaining())
                            : static_cast<double>(binary_->remaining() / size_of(property.type));
  if (!(count >= 0) || count != std::floor(count))
    fail(fmt::format("list {}: count = {}, must be an integer >= 0", in_quotes(property.name), count));
  if (count > most)
    fail(fmt::format("truncated: list {}: count = {}, but the rest of the file holds at most {}",
                     in_quotes(property.name), count, most));
  lists_[index] = {items_.size(), static_cast<size_t>(count)};
  for (size_t i = 0; i < lists_[index].size; ++i) items_.push_back(read_value(property, property.type));
}

void PlyRows::skip(const PlyElement& element) {
  begin(element);
  if (element.properties.empty()) return;
  if (binary_ && !has_lists_) return binary_->skip(element.count * row_bytes_);
  for (uint64_t i = 0; i < element.count; ++i) next();
}

void PlyRows::finish(const PlyElement& vertex, ReadReport& report) {
  if (!text_) {
    if (const size_t rest = binary_->remaining(); rest > 0)
      report.warnings.push_back(
          fmt::format("{}: {} bytes after the last element are not read: the header's counts, such as {} vertices, may "
                      "be too small",
                      source_.path(), rest, vertex.count));
    return;
  }
  const std::string_view rest = text_->token();
  if (!rest.empty()) text_->fail(in_quotes(rest) + " after the last element, must be the end of the file");
}

void PlyRows::fail(const std::string& message) const {
  const size_t line = ahead_.taken > 0 ? ahead_.first_line + ahead_.taken - 1 : text_ ? text_->line() : 0;
  const std::string place = text_ ? fmt::format("{}:{}", source_.path(), line)
                                  : fmt::format("{}: byte {}", source_.path(), binary_->offset());
  throw InputError(fmt::format("{}: {} {}: {}", place, element_->name, row_, message));
}

}  // namespace soapfilm::io
