#include "soapfilm/io/bytes/binary_fields.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "soapfilm/error.h"

namespace soapfilm::io {

namespace {

template <class T>
void read_numbers(const char* at, size_t stride, bool swap, size_t count, double* to) {
  for (size_t i = 0; i < count; ++i) to[i] = static_cast<double>(load<T>(at + i * stride, swap));
}

void read_raw(const char* at, const BinaryField& field, size_t count, double* to) {
  switch (field.type) {
    case NumberType::uint8:
      for (size_t i = 0; i < count; ++i)
        to[i] = (load<uint8_t>(at + i * field.stride, false) >> field.shift) & field.mask;
      break;
    case NumberType::int8:
      return read_numbers<int8_t>(at, field.stride, field.swap, count, to);
    case NumberType::uint16:
      return read_numbers<uint16_t>(at, field.stride, field.swap, count, to);
    case NumberType::int16:
      return read_numbers<int16_t>(at, field.stride, field.swap, count, to);
    case NumberType::uint32:
      return read_numbers<uint32_t>(at, field.stride, field.swap, count, to);
    case NumberType::int32:
      return read_numbers<int32_t>(at, field.stride, field.swap, count, to);
    case NumberType::uint64:
      return read_numbers<uint64_t>(at, field.stride, field.swap, count, to);
    case NumberType::int64:
      return read_numbers<int64_t>(at, field.stride, field.swap, count, to);
    case NumberType::float32:
      return read_numbers<float>(at, field.stride, field.swap, count, to);
    case NumberType::float64:
      return read_numbers<double>(at, field.stride, field.swap, count, to);
  }
}

}  // namespace

void read_field(std::string_view bytes, const BinaryField& field, size_t first, size_t count, double* to) {
  if (count == 0) return;
  read_raw(bytes.data() + field.offset + first * field.stride, field, count, to);
  if (field.no_data) {
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    for (size_t i = 0; i < count; ++i) to[i] = to[i] == *field.no_data ? nan : to[i];
  }
  if (field.scale != 1 || field.add != 0)
    for (size_t i = 0; i < count; ++i) to[i] = to[i] * field.scale + field.add;
}

PointHeader FieldReader::header(uint64_t rows, bool sensors) const {
  const auto is_word = [&](size_t k) {
    const BinaryField& field = fields_[k];
    const bool is_small = field.type == NumberType::uint8 || field.type == NumberType::uint16;
    return is_small && field.scale == 1 && field.add == 0 && !field.no_data;
  };
  PointHeader header{.samples = rows,
                     .normals = meaning_.normal.present(),
                     .sensors = sensors || meaning_.sensor.present(),
                     .weights = meaning_.weight != Triple::absent,
                     .colors = meaning_.color.present(),
                     .columns = {},
                     .colors_in_range_of_all = true};
  const auto& color = meaning_.color.index;
  header.colors_of_16_bits = header.colors && std::all_of(color.begin(), color.end(), is_word);
  for (const size_t k : meaning_.others) header.columns.push_back(fields_[k].name);
  return header;
}

/// Those of the block's rows that are kept; returns how many.
size_t FieldReader::read(size_t field, Block& to) const {
  read_field(bytes_, fields_[field], first_, count_, to.data());
  if (kept_ == nullptr) return count_;
  for (size_t i = 0; i < kept_->size(); ++i) to[i] = to[(*kept_)[i]];
  return kept_->size();
}

size_t FieldReader::read(const Triple& triple) {
  size_t count = 0;
  for (size_t k = 0; k < 3; ++k) count = read(triple[k], block_[k]);
  return count;
}

/// The block's values of the triple, at the end of `column`, which has the room.
template <class T>
void FieldReader::append_triple(const Triple& triple, std::vector<Vec3<T>>& column) {
  const size_t count = read(triple), before = column.size();
  column.resize(before + count);
  Vec3<T>* to = column.data() + before;
  const auto& [x, y, z] = block_;
  for (size_t i = 0; i < count; ++i) to[i] = {static_cast<T>(x[i]), static_cast<T>(y[i]), static_cast<T>(z[i])};
}

void FieldReader::append(size_t first, size_t count, const std::vector<uint32_t>* kept, PointStream& stream) {
  PointCloud& cloud = stream.samples();
  first_ = first;
  count_ = count;
  kept_ = kept;
  const size_t rows_before = cloud.size();
  append_triple(meaning_.position, cloud.positions);
  if (meaning_.normal.present()) append_triple(meaning_.normal, cloud.normals);
  if (meaning_.sensor.present()) append_triple(meaning_.sensor, cloud.sensors);
  if (meaning_.color.present()) append_colors(stream.colors());
  if (meaning_.weight != Triple::absent) append_weights(cloud);
  for (size_t c = 0; c < meaning_.others.size(); ++c) append_column(meaning_.others[c], cloud.columns[c], rows_before);
}

void FieldReader::append_colors(ColorNumbers& colors) {
  constexpr double none = -1;
  const auto& [red, green, blue] = block_;
  for (size_t i = 0, n = read(meaning_.color); i < n; ++i) {
    const bool usable = red[i] >= 0 && green[i] >= 0 && blue[i] >= 0;
    colors.add(usable ? red[i] : none, usable ? green[i] : none, usable ? blue[i] : none);
  }
}

void FieldReader::append_weights(PointCloud& cloud) {
  Block& values = block_[0];
  for (size_t i = 0, n = read(meaning_.weight, values); i < n; ++i) {
    const auto weight = static_cast<float>(values[i]);
    if (!(weight >= 0) || !std::isfinite(weight)) {
      const size_t row = rows_before_ + first_ + (kept_ != nullptr ? (*kept_)[i] : i);
      throw InputError(fmt::format("{}: sample {}: weight = {}, must be finite and >= 0", path_, row, values[i]));
    }
    cloud.weights.push_back(weight);
  }
}

void FieldReader::append_column(size_t field, Column& column, size_t rows_before) {
  Block& values = block_[0];
  const size_t count = read(field, values);
  if (zeros_left_out_ && column.values.empty()) {  // zeros so far: they get memory when another number comes
    if (std::all_of(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(count),
                    [](double v) { return v == 0; }))
      return;
  }
  column.values.resize(rows_before + count, 0.0f);
  float* to = column.values.data() + rows_before;
  for (size_t i = 0; i < count; ++i) to[i] = static_cast<float>(values[i]);
}

}  // namespace soapfilm::io
