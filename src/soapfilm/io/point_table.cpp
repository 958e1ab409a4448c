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

constexpr uint64_t most_samples = INT32_MAX;  // range grids hold indices of 32 bits
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

/// The distance between neighboring 32-bit numbers at the farthest coordinate.
double float_step(double farthest) { return std::ldexp(1.0, std::ilogb(farthest) - 23); }

void warn_of_steps(const PointCloud& cloud, const std::string& path, ReadReport& report) {
  constexpr double harmless = 0.1;  // of the spacing: rounding is then noise of 0.03 voxels
  const Box3d box = cloud.box();
  const double farthest = farthest_coordinate(box);
  const double spacing = box.diagonal() / std::sqrt(static_cast<double>(cloud.size()));
  if (farthest == 0 || spacing == 0 || float_step(farthest) <= harmless * spacing) return;
  report.warnings.push_back(fmt::format(
      "{}: coordinates near {:.6g} are stored as 32-bit numbers, in steps of {:.3g}; samples are about {:.3g} apart: "
      "the surface will have steps (write the file in double precision, or subtract an offset before)",
      path, farthest, float_step(farthest), spacing));
}

/// Drops the samples at bad positions, if there are at least `least`; returns how many were dropped.
template <class Bad>
size_t drop_where(PointCloud& cloud, size_t least, Bad&& bad) {
  const auto count = static_cast<size_t>(std::count_if(cloud.positions.begin(), cloud.positions.end(), bad));
  if (count < least) return 0;
  std::vector<bool> keep(cloud.size());
  for (size_t i = 0; i < keep.size(); ++i) keep[i] = !bad(cloud.positions[i]);
  cloud.filter(keep);
  return count;
}

}  // namespace

size_t bytes_per_sample(const PointHeader& header) {
  const size_t color = sizeof(Rgb8) + (header.colors_of_16_bits ? sizeof(std::array<uint16_t, 3>) : sizeof(Vec3f));
  return sizeof(Vec3d) + header.normals * sizeof(Vec3f) + header.sensors * sizeof(Vec3d) +
         header.weights * sizeof(float) + header.colors * color + header.columns.size() * sizeof(float);
}

PointCloud cloud_for(const PointHeader& header, const std::string& path) {
  if (header.samples > most_samples)
    throw InputError(fmt::format("{}: holds {} samples, must be at most {}", path, header.samples, most_samples));
  const auto count = static_cast<size_t>(header.samples);
  const size_t bytes = count * bytes_per_sample(header);
  if (bytes > worth_planning && bytes > available_memory_bytes())
    throw MemoryError(fmt::format("{}: its {} samples need {}, more than the {} that are free", path, count,
                                  format_bytes(bytes), format_bytes(available_memory_bytes())));
  PointCloud cloud;
  reserve_many(cloud.positions, count);
  if (header.normals) reserve_many(cloud.normals, count);
  if (header.sensors) reserve_many(cloud.sensors, count);
  if (header.weights) reserve_many(cloud.weights, count);
  if (header.colors) reserve_many(cloud.colors, count);
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

std::vector<Rgb8> ColorNumbers::bytes(bool whole) const {
  constexpr float a_little_over_one = 2;  // renderers and filters overshoot; of numbers to 255 all would be black
  const float range = largest();
  const double scale = !whole && range < a_little_over_one ? 255.0 : range <= 255 ? 1.0 : 1.0 / 257;
  std::vector<Rgb8> colors;
  reserve_many(colors, values_.size() + words_.size());
  for (const Vec3f& c : values_) colors.push_back(rounded(c, scale));
  for (const auto& [red, green, blue] : words_)
    colors.push_back(rounded({static_cast<float>(red), static_cast<float>(green), static_cast<float>(blue)}, scale));
  return colors;
}

void finish_points(PointCloud& cloud, FileReport file, const PointTraits& traits, ReadReport& report) {
  const size_t read = cloud.size() + file.no_return;
  if (read == 0) throw InputError(file.path + ": holds no samples");
  for (Vec3f& normal : cloud.normals) {
    if (is_finite(normal)) continue;
    normal = {};
    ++file.ignored_normals;
  }
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  for (Vec3d& sensor : cloud.sensors)
    if (!is_finite(sensor)) sensor = {nan, nan, nan};

  const auto is_zero = [](const Vec3d& p) { return p == Vec3d{}; };
  const size_t zeros = traits.has_faces ? 0 : drop_where(cloud, traits.zero_is_none ? 1 : 2, is_zero);
  if (zeros > 0 && !traits.zero_is_none)
    report.warnings.push_back(fmt::format(
        "{}: {} of {} samples are at (0, 0, 0): taken for rays without a return, and dropped", file.path, zeros, read));
  file.no_return += zeros;
  file.dropped = drop_where(cloud, 1, [](const Vec3d& p) { return !is_finite(p); });
  file.samples = cloud.size();
  if (file.samples == 0)
    throw InputError(fmt::format("{}: none of its {} samples is usable: {} have a non-finite coordinate, {} no return",
                                 file.path, read, file.dropped, file.no_return));
  if (traits.float32) warn_of_steps(cloud, file.path, report);
  if (traits.closed)
    report.warnings.push_back(file.path +
                              ": a closed mesh, as programs make them of scans; its vertices are read as samples");
  report.files.push_back(std::move(file));
}

}  // namespace soapfilm::io
