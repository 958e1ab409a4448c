#include "soapfilm/io/point_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "soapfilm/core/farthest.h"
#include "soapfilm/core/memory.h"
#include "soapfilm/core/vec.h"
#include "soapfilm/error.h"
#include "soapfilm/io/point_columns.h"
#include "soapfilm/io/text/text.h"

namespace soapfilm::io {

namespace {

constexpr size_t worth_planning = size_t{64} << 20;

/// The names, a number added to those that are there already, or that PLY gives a meaning.
std::vector<std::string> made_different(const std::vector<std::string>& names) {
  const std::vector<std::string> taken{"x",     "y",    "z",        "nx",       "ny",       "nz",    "red",
                                       "green", "blue", "sensor_x", "sensor_y", "sensor_z", "weight"};
  std::vector<std::string> all = taken;
  for (const std::string& given : names) {
    const std::string name = given.empty() ? "column" : given;
    std::string unused = name;
    for (int k = 2; std::find(all.begin(), all.end(), unused) != all.end(); ++k) unused = fmt::format("{}_{}", name, k);
    all.push_back(std::move(unused));
  }
  all.erase(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(taken.size()));
  return all;
}

}  // namespace

size_t bytes_per_sample(const PointHeader& header) {
  const size_t color = sizeof(Rgb8) + (header.colors_of_16_bits ? sizeof(std::array<uint16_t, 3>) : sizeof(Vec3f));
  return sizeof(Vec3d) + header.normals * sizeof(Vec3f) + header.sensors * sizeof(Vec3d) +
         header.weights * sizeof(float) + header.colors * color + header.columns.size() * sizeof(float);
}

void check_cloud_fits(const PointHeader& header, const std::string& path) {
  if (header.samples > most_cloud_samples)
    throw InputError(fmt::format("{}: holds {} samples, must be at most {}", path, header.samples, most_cloud_samples));
  const auto count = static_cast<size_t>(header.samples);
  const size_t bytes = count * bytes_per_sample(header);
  if (bytes > worth_planning && bytes > available_memory_bytes())
    throw MemoryError(fmt::format("{}: its {} samples need {}, more than the {} that are free", path, count,
                                  format_bytes(bytes), format_bytes(available_memory_bytes())));
}

PointCloud cloud_for(const PointHeader& header, const std::string& path) {
  check_cloud_fits(header, path);
  return cloud_for(header, static_cast<size_t>(header.samples));
}

PointCloud cloud_for(const PointHeader& header, size_t count) {
  PointCloud cloud;
  reserve_many(cloud.positions, count);
  if (header.normals) reserve_many(cloud.normals, count);
  if (header.sensors) reserve_many(cloud.sensors, count);
  if (header.weights) reserve_many(cloud.weights, count);
  if (header.colors && !header.colors_in_range_of_all) reserve_many(cloud.colors, count);
  std::vector<std::string> names;
  for (const std::string& name : header.columns) names.push_back(column_name(name));
  for (std::string& name : made_different(names)) {
    const bool is_label = holds_labels(name);
    cloud.columns.push_back({std::move(name), {}, is_label});
    reserve_many(cloud.columns.back().values, count);
  }
  return cloud;
}

void ColorNumbers::reserve(size_t count, bool of_16_bits) {
  of_16_bits_ = of_16_bits;
  if (of_16_bits_)
    reserve_many(words_, count);
  else
    reserve_many(values_, count);
}

void ColorNumbers::add(double red, double green, double blue) {
  if (of_16_bits_)
    words_.push_back({static_cast<uint16_t>(red), static_cast<uint16_t>(green), static_cast<uint16_t>(blue)});
  else
    values_.push_back({static_cast<float>(red), static_cast<float>(green), static_cast<float>(blue)});
}

float ColorNumbers::largest() const {
  float largest = 0;
  for (const Vec3f& c : values_)
    for (int k = 0; k < 3; ++k)
      if (std::isfinite(c[k])) largest = std::max(largest, c[k]);
  uint16_t largest_word = 0;
  for (const Words& c : words_)
    for (const uint16_t word : c) largest_word = std::max(largest_word, word);
  return std::max(largest, static_cast<float>(largest_word));
}

Rgb8 ColorNumbers::rounded(const Vec3f& color, double scale) {
  Rgb8 rgb{128, 128, 128};  // as PointCloud::append() fills
  if (color.x >= 0 && color.y >= 0 && color.z >= 0 && is_finite(color))
    for (int k = 0; k < 3; ++k)
      rgb[static_cast<size_t>(k)] = static_cast<uint8_t>(std::lround(std::min(color[k] * scale, 255.0)));
  return rgb;
}

void ColorNumbers::append(const ColorNumbers& others, size_t begin, size_t end) {
  const auto part = [&](auto& to, const auto& from) {
    if (from.empty()) return;
    to.insert(to.end(), from.begin() + static_cast<std::ptrdiff_t>(begin),
              from.begin() + static_cast<std::ptrdiff_t>(end));
  };
  of_16_bits_ = others.of_16_bits_;
  part(values_, others.values_);
  part(words_, others.words_);
}

double ColorNumbers::scale(float largest, bool whole) {
  constexpr float a_little_over_one = 2;  // renderers and filters overshoot; of numbers to 255 all would be black
  return !whole && largest < a_little_over_one ? 255.0 : largest <= 255 ? 1.0 : 1.0 / 257;
}

std::vector<Rgb8> ColorNumbers::bytes(double scale) const {
  std::vector<Rgb8> colors;
  reserve_many(colors, values_.size() + words_.size());
  for (const Vec3f& c : values_) colors.push_back(rounded(c, scale));
  for (const auto& [red, green, blue] : words_)
    colors.push_back(rounded({static_cast<float>(red), static_cast<float>(green), static_cast<float>(blue)}, scale));
  return colors;
}

void keep_attributes(const std::vector<std::string>& attributes, PointCloud& cloud) {
  const auto is_named = [&](const std::string& name) {
    return std::find(attributes.begin(), attributes.end(), name) != attributes.end();
  };
  const auto found = std::count_if(cloud.columns.begin(), cloud.columns.end(),
                                   [&](const Column& column) { return is_named(column.name); });
  if (static_cast<size_t>(found) + is_named("color") != attributes.size()) return;
  std::erase_if(cloud.columns, [&](const Column& column) { return !is_named(column.name); });
  if (!is_named("color")) release(cloud.colors);
}

void finish_points(PointCloud& cloud, FileReport file, const PointTraits& traits, ReadReport& report) {
  PointTally tally;
  tally.add(cloud);
  PointEnd end;
  tally.judge(std::move(file), traits, report, end);
  drop_samples(end, cloud);
}

}  // namespace soapfilm::io
