#include "soapfilm/io/ply_rows.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "soapfilm/core/error.h"

namespace soapfilm::io {

namespace {

double read_binary(ByteCursor& cursor, PlyType type) {
  switch (type) {
    case PlyType::int8:
      return cursor.read<int8_t>();
    case PlyType::uint8:
      return cursor.read<uint8_t>();
    case PlyType::int16:
      return cursor.read<int16_t>();
    case PlyType::uint16:
      return cursor.read<uint16_t>();
    case PlyType::int32:
      return cursor.read<int32_t>();
    case PlyType::uint32:
      return cursor.read<uint32_t>();
    case PlyType::float32:
      return static_cast<double>(cursor.read<float>());
    case PlyType::float64:
      return cursor.read<double>();
  }
  return 0;
}

}  // namespace

PlyRows::PlyRows(ByteSource& source, const PlyHeader& header) : source_(source), header_(header) {
  if (header.format == PlyFormat::ascii)
    text_.emplace(source, header.body_offset, header.body_line);
  else
    binary_.emplace(source, header.body_offset,
                    header.format == PlyFormat::binary_big_endian ? std::endian::big : std::endian::little);
}

void PlyRows::begin(const PlyElement& element) {
  element_ = &element;
  rows_read_ = row_ = 0;
  values_.assign(element.properties.size(), 0.0);
  lists_.assign(element.properties.size(), List{});
  const size_t row_bytes = element.least_row_bytes(header_.format);
  const size_t remaining = text_ ? text_->remaining() + 1 : binary_->remaining();  // the last blank may be missing
  if (row_bytes > 0 && element.count > remaining / row_bytes)
    throw InputError(fmt::format(
        "{}:{}: element {}: count = {}, but the file is truncated: {} bytes are left and a row needs at least {}",
        source_.path(), element.line, in_quotes(element.name), element.count, remaining, row_bytes));
}

void PlyRows::next() {
  row_ = rows_read_++;
  items_.clear();
  const std::vector<PlyProperty>& properties = element_->properties;
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

double PlyRows::read_value(const PlyProperty& property, PlyType type) {
  return text_ ? text_->number(property.name) : read_binary(*binary_, type);
}

void PlyRows::read_list(size_t index) {
  const PlyProperty& property = element_->properties[index];
  const double count = read_value(property, *property.count_type);
  const double most = text_ ? static_cast<double>(text_->remaining())
                            : static_cast<double>(binary_->remaining() / size_of(property.type));
  if (!(count >= 0) || count != std::floor(count) || count > most)
    fail(fmt::format("list {}: count = {}, must be an integer from 0 to {} (what the rest of the file can hold)",
                     in_quotes(property.name), count, most));
  lists_[index] = {items_.size(), static_cast<size_t>(count)};
  for (size_t i = 0; i < lists_[index].size; ++i) items_.push_back(read_value(property, property.type));
}

void PlyRows::skip(const PlyElement& element) {
  begin(element);
  const bool has_list = std::any_of(element.properties.begin(), element.properties.end(),
                                    [](const PlyProperty& property) { return property.is_list(); });
  if (element.properties.empty()) return;
  if (binary_ && !has_list) return binary_->skip(element.count * element.least_row_bytes(header_.format));
  for (uint64_t i = 0; i < element.count; ++i) next();
}

void PlyRows::finish() {
  if (!text_) return;
  const std::string_view rest = text_->token();
  if (!rest.empty()) text_->fail(in_quotes(rest) + " after the last element, must be the end of the file");
}

void PlyRows::fail(const std::string& message) const {
  const std::string place = text_ ? fmt::format("{}:{}", source_.path(), text_->line())
                                  : fmt::format("{}: byte {}", source_.path(), binary_->offset());
  throw InputError(fmt::format("{}: {} {}: {}", place, element_->name, row_, message));
}

}  // namespace soapfilm::io
