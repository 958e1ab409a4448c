#include "soapfilm/cloud.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "soapfilm/core/gather.h"

namespace soapfilm {

namespace {

/// Appends `from` to `to`; if one of the two is absent its part is filled with `neutral`.
template <class T>
void append_column(std::vector<T>& to, size_t to_size, std::vector<T>&& from, size_t from_size, T neutral) {
  if (to.empty() && from.empty()) return;
  if (to.empty()) to.assign(to_size, neutral);
  if (from.empty()) from.assign(from_size, neutral);
  to.insert(to.end(), from.begin(), from.end());
}

/// Columns of the same name are joined.
void append_columns(std::vector<Column>& to, size_t to_size, std::vector<Column>&& from, size_t from_size) {
  constexpr float none = std::numeric_limits<float>::quiet_NaN();
  for (Column& column : from) {
    const auto same = std::find_if(to.begin(), to.end(), [&](const Column& c) { return c.name == column.name; });
    Column& into = same != to.end() ? *same : to.emplace_back(Column{column.name, {}, column.is_label});
    append_column(into.values, to_size, std::move(column.values), from_size, none);
  }
  for (Column& column : to) column.values.resize(to_size + from_size, none);
}

template <class T>
void filter_column(std::vector<T>& column, const std::vector<bool>& keep) {
  if (column.empty()) return;
  size_t kept = 0;
  for (size_t i = 0; i < column.size(); ++i)
    if (keep[i]) column[kept++] = column[i];
  column.resize(kept);
}

}  // namespace

Box3d PointCloud::box(const Context& context) const {
  constexpr size_t grain = size_t{1} << 15;
  const auto part = [&](size_t begin, size_t end) {
    Box3d box;
    for (size_t i = begin; i < end; ++i) box.extend(positions[i]);
    return box;
  };
  return join_chunks<Box3d>(size(), grain, context, part, [](Box3d& whole, const Box3d& p) { whole.extend(p); });
}

void PointCloud::append(PointCloud&& other) {
  if (size() == 0 && scans.empty()) {
    *this = std::exchange(other, {});
    return;
  }
  const size_t n = size();
  const size_t m = other.size();
  is_survey = is_survey && other.is_survey;
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  append_column(normals, n, std::move(other.normals), m, Vec3f{});
  append_column(sensors, n, std::move(other.sensors), m, Vec3d{nan, nan, nan});
  append_column(weights, n, std::move(other.weights), m, 1.0f);
  append_column(colors, n, std::move(other.colors), m, Rgb8{128, 128, 128});
  append_columns(columns, n, std::move(other.columns), m);
  if (coordinate_system.empty()) coordinate_system = std::move(other.coordinate_system);
  positions.insert(positions.end(), other.positions.begin(), other.positions.end());
  for (Scan& scan : other.scans) {
    scan.begin += n;
    scan.end += n;
    scans.push_back(std::move(scan));
  }
  other = {};
}

void PointCloud::filter(const std::vector<bool>& keep) {
  std::vector<int64_t> new_index(size(), -1);
  int64_t kept = 0;
  for (size_t i = 0; i < size(); ++i)
    if (keep[i]) new_index[i] = kept++;

  std::vector<Scan> kept_scans;
  size_t scan_begin = 0;
  for (Scan& scan : scans) {
    size_t count = 0;
    for (size_t i = scan.begin; i < scan.end; ++i) count += keep[i];
    if (scan.range_grid) {
      for (int32_t& s : scan.range_grid->sample) {
        if (s < 0) continue;
        const int64_t moved = new_index[scan.begin + static_cast<size_t>(s)];
        s = moved < 0 ? -1 : static_cast<int32_t>(moved - static_cast<int64_t>(scan_begin));
      }
    }
    scan.begin = scan_begin;
    scan.end = scan_begin += count;
    if (count > 0) kept_scans.push_back(std::move(scan));
  }
  scans = std::move(kept_scans);

  filter_column(positions, keep);
  filter_column(normals, keep);
  filter_column(sensors, keep);
  filter_column(weights, keep);
  filter_column(colors, keep);
  for (Column& column : columns) filter_column(column.values, keep);
}

}  // namespace soapfilm
