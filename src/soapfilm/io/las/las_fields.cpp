#include "soapfilm/io/las/las_fields.h"

#include <array>
#include <bit>
#include <cmath>
#include <string_view>

namespace soapfilm::io {

namespace {

struct LasField {
  std::string_view name;
  NumberType type = NumberType::uint8;
  size_t offset = 0;
  uint8_t shift = 0;
  uint8_t mask = 0xff;
  double scale = 1;
};

// Direction of the scan and edge of the flight line (bits) are not read.
constexpr std::array old_fields{LasField{"intensity", NumberType::uint16, 12},
                                LasField{"return_number", NumberType::uint8, 14, 0, 7},
                                LasField{"number_of_returns", NumberType::uint8, 14, 3, 7},
                                LasField{"classification", NumberType::uint8, 15, 0, 31},
                                LasField{"scan_angle", NumberType::int8, 16},
                                LasField{"user_data", NumberType::uint8, 17},
                                LasField{"point_source_id", NumberType::uint16, 18}};
constexpr LasField old_withheld{"withheld", NumberType::uint8, 15, 7, 1};

constexpr double degrees_of_scan_angle = 0.006;
constexpr std::array new_fields{LasField{"intensity", NumberType::uint16, 12},
                                LasField{"return_number", NumberType::uint8, 14, 0, 15},
                                LasField{"number_of_returns", NumberType::uint8, 14, 4, 15},
                                LasField{"scanner_channel", NumberType::uint8, 15, 4, 3},
                                LasField{"classification", NumberType::uint8, 16},
                                LasField{"user_data", NumberType::uint8, 17},
                                LasField{"scan_angle", NumberType::int16, 18, 0, 0xff, degrees_of_scan_angle},
                                LasField{"point_source_id", NumberType::uint16, 20}};
constexpr LasField new_withheld{"withheld", NumberType::uint8, 15, 2, 1};
constexpr int first_new_format = 6;

/// Where a format has what not all have; 0: nowhere.
struct LasPlaces {
  size_t gps_time = 0;
  size_t color = 0;
  size_t infrared = 0;
};
constexpr std::array<LasPlaces, 11> places_of_format{{{0, 0, 0},
                                                      {20, 0, 0},
                                                      {0, 20, 0},
                                                      {20, 28, 0},
                                                      {20, 0, 0},
                                                      {20, 28, 0},
                                                      {22, 0, 0},
                                                      {22, 30, 0},
                                                      {22, 30, 36},
                                                      {22, 0, 0},
                                                      {22, 30, 36}}};

BinaryField field_of(const LasField& from, const LasHeader& header) {
  BinaryField field{.name = std::string(from.name), .type = from.type};
  field.offset = from.offset;
  field.stride = header.record_bytes;
  field.swap = std::endian::native != std::endian::little;
  field.shift = from.shift;
  field.mask = from.mask;
  field.scale = from.scale;
  return field;
}

}  // namespace

LasFields las_fields(std::string_view first_record, const LasHeader& header, const LasRecords& records) {
  constexpr std::array<std::string_view, 3> axes{"x", "y", "z"};
  constexpr std::array<std::string_view, 3> colors{"red", "green", "blue"};
  const LasPlaces& place = places_of_format[static_cast<size_t>(header.point_format)];
  LasFields fields;
  const auto add = [&](const LasField& field) { fields.all.push_back(field_of(field, header)); };
  for (size_t k = 0; k < 3; ++k) {
    add({axes[k], NumberType::int32, 4 * k});
    fields.all.back().scale = header.scale[static_cast<int>(k)];
    fields.all.back().add = header.offset[static_cast<int>(k)];
  }
  const bool is_new = header.point_format >= first_new_format;
  if (is_new)
    for (const LasField& field : new_fields) add(field);
  else
    for (const LasField& field : old_fields) add(field);
  fields.withheld = field_of(is_new ? new_withheld : old_withheld, header);
  for (const BinaryField& field : fields.all) {
    if (field.name == "classification") fields.classification = field;
    if (field.name == "point_source_id") fields.source = field;
  }
  if (place.gps_time > 0) {
    add({"gps_time", NumberType::float64, place.gps_time});
    fields.gps_time = fields.all.back();
    double first = 0;
    read_field(first_record, *fields.gps_time, 0, 1, &first);
    if (std::isfinite(first)) fields.all.back().add = -first;
  }
  if (place.color > 0)
    for (size_t k = 0; k < 3; ++k) add({colors[k], NumberType::uint16, place.color + 2 * k});
  if (place.infrared > 0) add({"nir", NumberType::uint16, place.infrared});
  for (const BinaryField& extra : records.extra) {
    fields.all.push_back(extra);
    fields.all.back().offset += standard_bytes(header.point_format);
    fields.all.back().stride = header.record_bytes;
  }
  return fields;
}

}  // namespace soapfilm::io
