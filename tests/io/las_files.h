// LAS files that tests make.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "binary_bytes.h"
#include "soapfilm/vec.h"

namespace soapfilm {

/// A point with the fields that all formats have.
struct LasPoint {
  std::array<int32_t, 3> xyz{};
  uint16_t intensity = 0;
  uint8_t classification = 2;
  uint16_t source = 0;
  bool withheld = false;
  double time = 0;
  std::array<uint16_t, 3> rgb{};
  uint16_t infrared = 0;
  std::string extra{};
};

struct LasFile {
  int minor = 2;
  int format = 0;
  Vec3d scale{0.001, 0.001, 0.001};
  Vec3d offset{500000, 4649000, 0};
  uint16_t global_encoding = 0;
  std::vector<std::string> records{};           // variable length, whole
  std::vector<std::string> extended_records{};  // of 1.4, whole
  std::vector<LasPoint> points{};

  static constexpr std::array<size_t, 11> lengths{20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67};

  size_t header_bytes() const { return minor >= 4 ? 375 : minor == 3 ? 235 : 227; }
  size_t points_offset() const {
    size_t sum = header_bytes();
    for (const std::string& one : records) sum += one.size();
    return sum;
  }
  size_t record_bytes() const {
    return lengths[static_cast<size_t>(format)] + (points.empty() ? 0 : points[0].extra.size());
  }
  std::string bytes() const;

  static std::string record(const std::string& user, uint16_t id, const std::string& content, bool extended = false) {
    std::string head(extended ? 60 : 54, '\0');
    head.replace(2, user.size(), user);
    put(head, 18, id);
    if (extended)
      put(head, 20, uint64_t{content.size()});
    else
      put(head, 20, static_cast<uint16_t>(content.size()));
    return head + content;
  }

  /// A description of extra bytes; `type` as LAS counts them.
  static std::string extra(const std::string& name, uint8_t type, uint8_t options = 0, double scale = 0,
                           double add = 0) {
    std::string description(192, '\0');
    description[2] = static_cast<char>(type);
    description[3] = static_cast<char>(options);
    description.replace(4, name.size(), name);
    put(description, 112, scale);
    put(description, 136, add);
    return description;
  }

 private:
  std::string point_bytes(const LasPoint& point) const;
};

inline std::string LasFile::point_bytes(const LasPoint& point) const {
  std::string record(lengths[static_cast<size_t>(format)], '\0');
  for (size_t k = 0; k < 3; ++k) put(record, 4 * k, point.xyz[k]);
  put(record, 12, point.intensity);
  const bool is_new = format >= 6;
  record[14] = static_cast<char>(is_new ? 2 | 3 << 4 : 2 | 3 << 3);  // the second of three returns
  record[15] = static_cast<char>(is_new ? point.withheld << 2 : point.classification | point.withheld << 7);
  if (is_new) record[16] = static_cast<char>(point.classification);
  if (is_new)
    put(record, 18, int16_t{-1500});
  else
    record[16] = static_cast<char>(-9);
  put(record, is_new ? 20 : 18, point.source);
  const size_t time = is_new ? 22 : format == 0 || format == 2 ? 0 : 20;
  if (time > 0) put(record, time, point.time);
  const size_t color = format == 2                            ? 20
                       : format == 3 || format == 5           ? 28
                       : is_new && format != 6 && format != 9 ? 30
                                                              : 0;
  for (size_t k = 0; k < 3 && color > 0; ++k) put(record, color + 2 * k, point.rgb[k]);
  if (format == 8 || format == 10) put(record, 36, point.infrared);
  return record + point.extra;
}

inline std::string LasFile::bytes() const {
  std::string file(header_bytes(), '\0');
  file.replace(0, 4, "LASF");
  put(file, 6, global_encoding);
  file[24] = 1;
  file[25] = static_cast<char>(minor);
  put(file, 94, static_cast<uint16_t>(header_bytes()));
  put(file, 96, static_cast<uint32_t>(points_offset()));
  put(file, 100, static_cast<uint32_t>(records.size()));
  file[104] = static_cast<char>(format);
  put(file, 105, static_cast<uint16_t>(record_bytes()));
  put(file, 107, static_cast<uint32_t>(format < 6 ? points.size() : 0));
  for (int axis = 0; axis < 3; ++axis) {
    const auto k = static_cast<size_t>(axis);
    put(file, 131 + 8 * k, scale[axis]);
    put(file, 155 + 8 * k, offset[axis]);
  }
  for (const std::string& record : records) file += record;
  for (const LasPoint& point : points) file += point_bytes(point);
  if (minor >= 4) {
    put(file, 247, uint64_t{points.size()});
    if (!extended_records.empty()) put(file, 235, uint64_t{file.size()});
    put(file, 243, static_cast<uint32_t>(extended_records.size()));
    for (const std::string& record : extended_records) file += record;
  }
  return file;
}

}  // namespace soapfilm
