#include "soapfilm/io/summary.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "soapfilm/core/kd_tree.h"
#include "soapfilm/core/median.h"
#include "soapfilm/core/vec.h"

namespace soapfilm {

namespace {

double spacing_of_places(const std::vector<Vec3d>& positions, size_t queries) {
  constexpr size_t neighbors = 8;
  const size_t k = std::min(neighbors, positions.size() - std::min<size_t>(positions.size(), 1));
  if (k == 0 || queries == 0) return 0;
  const KdTree tree(positions);

  const size_t step = std::max<size_t>(1, positions.size() / queries);
  std::vector<double> areas;
  for (size_t i = 0; i < positions.size(); i += step) {
    const Vec3d& p = positions[i];
    const std::array<double, 3> query{p.x, p.y, p.z};
    std::array<uint32_t, neighbors + 1> index{};  // the sample itself comes first
    std::array<double, neighbors + 1> squared_distance{};
    const size_t found = tree->knnSearch(query.data(), k + 1, index.data(), squared_distance.data());
    const double farthest = squared_distance[found - 1];
    constexpr double pi = 3.141592653589793;
    if (farthest > 0) areas.push_back(pi * farthest / static_cast<double>(found - 1));
  }
  return std::sqrt(median(std::move(areas)));
}

}  // namespace

double sample_spacing(const PointCloud& cloud, size_t queries) { return spacing_of_places(cloud.positions, queries); }

void SummarySink::Counts::add(const PointCloud& cloud, size_t i) {
  ++samples;
  normals += !cloud.normals.empty() && !(cloud.normals[i] == Vec3f{});
  sensors += !cloud.sensors.empty() && is_finite(cloud.sensors[i]);
}

void SummarySink::Counts::add(const Counts& other) {
  samples += other.samples;
  normals += other.normals;
  sensors += other.sensors;
}

void SummarySink::keep_place(const Vec3d& place) {
  if (to_next_-- > 0) return;
  to_next_ = stride_ - 1;
  places_.push_back(place);
  if (places_.size() < most_places_) return;
  const auto thin = [&](size_t begin, size_t to) {
    for (size_t i = begin; i < places_.size(); i += 2) places_[to++] = places_[i];
    return to;
  };
  const size_t last = (places_.size() - 1) % 2;  // is the last one kept?
  first_place_ = (first_place_ + 1) / 2;
  places_.resize(thin(0, 0));
  stride_ *= 2;
  to_next_ = last == 0 ? stride_ - 1 : stride_ / 2 - 1;
}

void SummarySink::keep_run(size_t sample, bool zero) {
  if (!runs_.empty() && runs_.back().end == sample && runs_.back().zeros == zero)
    ++runs_.back().end;
  else
    runs_.push_back({sample, sample + 1, zero});
}

void SummarySink::take(io::PointBlock&& block) {
  const PointCloud& cloud = block.samples;
  for (size_t i = 0; i < cloud.size(); ++i) {
    const Vec3d& p = cloud.positions[i];
    const bool finite = is_finite(p), zero = p == Vec3d{};
    if (!finite || zero) keep_run(size_ + i, zero);
    if (!finite) continue;
    (zero ? zeros_ : others_).add(cloud, i);
    if (!zero) box_.extend(p);
    keep_place(p);
  }
  size_ += cloud.size();
  weights_ = weights_ || !cloud.weights.empty();
  colors_ = colors_ || !cloud.colors.empty();
  if (columns_.empty())
    for (const Column& column : cloud.columns) columns_.push_back(column.name);
  held_ = std::max(held_, places_.capacity() * sizeof(Vec3d) + runs_.capacity() * sizeof(Run));
}

/// How many of the scan's samples are not dropped.
size_t SummarySink::kept_in(const Scan& scan, const io::PointEnd& end) const {
  size_t kept = scan.size();
  for (const Run& run : runs_)
    if (run.zeros ? end.drop_zeros : end.drop_non_finite)
      kept -= std::max(std::min(run.end, scan.end), scan.begin) - std::min(std::max(run.begin, scan.begin), scan.end);
  return kept;
}

void SummarySink::end(io::PointEnd&& end) {
  Counts counts = others_;
  if (end.drop_zeros) {
    const auto first = places_.begin() + static_cast<std::ptrdiff_t>(first_place_);
    places_.erase(std::remove(first, places_.end(), Vec3d{}), places_.end());
  } else {
    counts.add(zeros_);
    if (zeros_.samples > 0) box_.extend(Vec3d{});
  }
  sum_.samples += counts.samples;
  sum_.normals += counts.normals;
  sum_.sensors += counts.sensors;
  sum_.box.extend(box_);
  sum_.weights = sum_.weights || weights_;
  sum_.colors = sum_.colors || colors_ || end.color_scale > 0;
  if (sum_.coordinate_system.empty()) sum_.coordinate_system = std::move(end.coordinate_system);
  add_columns(end);
  for (Scan& scan : end.scans) {
    const size_t kept = kept_in(scan, end);
    if (kept == 0) continue;
    ScanSummary& to = sum_.scans.emplace_back(
        ScanSummary{std::move(scan.name), kept, scan.sensor, scan.view_direction, std::nullopt});
    if (const std::optional<RangeGrid>& grid = scan.range_grid) {
      const auto seen = std::count_if(grid->sample.begin(), grid->sample.end(), [](int32_t s) { return s >= 0; });
      to.grid = {grid->columns, grid->rows, static_cast<size_t>(seen)};
    }
    sum_.scans_with_sensor += to.sensor.has_value();
    sum_.scans_with_view_direction += to.view_direction.has_value();
    sum_.scans_with_range_grid += to.grid.has_value();
  }
  size_ = 0;
  first_place_ = places_.size();
  others_ = zeros_ = {};
  box_ = {};
  runs_.clear();
  weights_ = colors_ = false;
  columns_.clear();
}

void SummarySink::add_columns(const io::PointEnd& end) {
  for (size_t k = 0; k < columns_.size(); ++k) {
    if (std::find(end.without.begin(), end.without.end(), k) != end.without.end()) continue;
    if (std::find(sum_.columns.begin(), sum_.columns.end(), columns_[k]) == sum_.columns.end())
      sum_.columns.push_back(columns_[k]);
  }
}

CloudSummary SummarySink::summary() const {
  constexpr size_t queries = 2000;
  CloudSummary summary = sum_;
  // The area of surface per sample is that of the thinned ones over as many.
  summary.spacing = spacing_of_places(places_, queries) / std::sqrt(static_cast<double>(stride_));
  return summary;
}

CloudSummary summarize(const PointCloud& cloud) {
  SummarySink sink(std::numeric_limits<size_t>::max());
  io::hand_over(cloud, {}, sink);
  return sink.summary();
}

}  // namespace soapfilm
