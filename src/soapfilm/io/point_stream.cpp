#include "soapfilm/io/point_stream.h"

#include <algorithm>
#include <utility>

#include "soapfilm/core/memory.h"

namespace soapfilm::io {

namespace {

template <class T>
std::vector<T> part_of(const std::vector<T>& values, size_t begin, size_t end) {
  if (values.empty()) return {};
  const auto at = [&](size_t i) { return values.begin() + static_cast<std::ptrdiff_t>(i); };
  return std::vector<T>(at(begin), at(end));
}

/// Samples [begin, end), without scans.
PointCloud part_of(const PointCloud& cloud, size_t begin, size_t end) {
  PointCloud part;
  part.positions = part_of(cloud.positions, begin, end);
  part.normals = part_of(cloud.normals, begin, end);
  part.sensors = part_of(cloud.sensors, begin, end);
  part.weights = part_of(cloud.weights, begin, end);
  part.colors = part_of(cloud.colors, begin, end);
  for (const Column& column : cloud.columns)
    part.columns.push_back({column.name, part_of(column.values, begin, end), column.is_label});
  return part;
}

PointBlock part_of(const PointBlock& block, size_t begin, size_t end) {
  PointBlock part{part_of(block.samples, begin, end), {}};
  part.colors.append(block.colors, begin, end);
  return part;
}

template <class T>
void append_values(std::vector<T>& to, const std::vector<T>& from) {
  to.insert(to.end(), from.begin(), from.end());
}

void append_block(PointBlock& to, PointBlock&& from) {
  const size_t before = to.size(), all = before + from.size();
  append_values(to.samples.positions, from.samples.positions);
  append_values(to.samples.normals, from.samples.normals);
  append_values(to.samples.sensors, from.samples.sensors);
  append_values(to.samples.weights, from.samples.weights);
  append_values(to.samples.colors, from.samples.colors);
  for (size_t c = 0; c < to.samples.columns.size(); ++c) {
    std::vector<float>&values = to.samples.columns[c].values, &further = from.samples.columns[c].values;
    if (values.empty() && further.empty()) continue;
    values.resize(before, 0.0f);
    append_values(values, further);
    values.resize(all, 0.0f);
  }
  to.colors.append(from.colors, 0, from.colors.size());
}

/// The samples of a file as they will be, once its end is known.
void apply(PointEnd&& end, PointBlock& block) {
  PointCloud& cloud = block.samples;
  size_t k = 0;
  std::erase_if(cloud.columns, [&](const Column&) {
    return std::find(end.without.begin(), end.without.end(), k++) != end.without.end();
  });
  for (Column& column : cloud.columns) column.values.resize(cloud.size());  // of zeros since it had the last value
  if (end.color_scale > 0) cloud.colors = block.colors.bytes(end.color_scale);
  block.colors = {};
  cloud.scans = std::move(end.scans);
  cloud.coordinate_system = std::move(end.coordinate_system);
  cloud.is_survey = end.is_survey;
  drop_samples(end, cloud);
}

/// A whole cloud in parts.
void take_parts(const PointCloud& cloud, PointSink& sink) {
  const size_t most = sink.block_samples();
  for (size_t at = 0; at < cloud.size(); at += std::min(most, cloud.size() - at))
    sink.take({part_of(cloud, at, at + std::min(most, cloud.size() - at)), {}});
}

void take_parts(PointCloud&& cloud, PointSink& sink) {
  if (cloud.size() > sink.block_samples()) return take_parts(std::as_const(cloud), sink);
  sink.take({std::move(cloud), {}});
}

PointHeader header_of(const PointCloud& cloud) {
  PointHeader header{cloud.size(),           !cloud.normals.empty(), !cloud.sensors.empty(),
                     !cloud.weights.empty(), !cloud.colors.empty(),  {}};
  for (const Column& column : cloud.columns) header.columns.push_back(column.name);
  return header;
}

/// The end of a file whose samples are as they will be.
PointEnd end_of(const PointCloud& cloud) {
  PointEnd end;
  end.scans = cloud.scans;
  end.coordinate_system = cloud.coordinate_system;
  end.is_survey = cloud.is_survey;
  return end;
}

PointEnd take_end(PointCloud& cloud) {
  std::vector<Scan> scans = std::exchange(cloud.scans, {});
  PointEnd end = end_of(cloud);
  end.scans = std::move(scans);
  return end;
}

}  // namespace

void PointStream::begin(const PointHeader& header, const std::string& path) {
  sink_.begin(header, path);
  most_ = std::max(most_, sink_.block_samples());
  if (is_whole()) check_cloud_fits(header, path);
  header_ = header;
  block_ = {};
  constexpr size_t rows_beyond = size_t{1} << 14;  // that a reader adds at once
  const uint64_t room = is_whole() ? header.samples : std::min<uint64_t>(header.samples, most_ + rows_beyond);
  block_.samples = cloud_for(header, static_cast<size_t>(room));
  if (header.colors && header.colors_in_range_of_all)
    block_.colors.reserve(static_cast<size_t>(room), header.colors_of_16_bits);
}

void PointStream::tally_up() {
  tally_.add(block_.samples, tallied_, block_.size());
  tallied_ = block_.size();
  largest_color_ = std::max(largest_color_, block_.colors.largest());
  const std::vector<Column>& columns = block_.samples.columns;
  has_values_.resize(columns.size());
  for (size_t k = 0; k < columns.size(); ++k) has_values_[k] = has_values_[k] || !columns[k].values.empty();
}

void PointStream::pass() {
  if (block_.size() < most_) return;
  tally_up();
  hand_over(false);
}

/// Full blocks; of the rest also, if `all`.
void PointStream::hand_over(bool all) {
  PointBlock block = std::exchange(block_, {});
  block_.samples = cloud_for(header_, 0);
  if (header_.colors_of_16_bits) block_.colors.reserve(0, true);
  const size_t count = block.size(), full = all ? count : count / most_ * most_;
  passed_ += full;
  if (full < count) {
    PointBlock rest = part_of(block, full, count);
    if (rest.colors.size() == 0) rest.colors = std::move(block_.colors);
    block_ = std::move(rest);
  }
  tallied_ = count - full;
  if (full == 0) return;
  if (count <= most_) return sink_.take(std::move(block));
  for (size_t at = 0; at < full; at += most_) sink_.take(part_of(block, at, std::min(at + most_, full)));
}

void PointStream::finish(PointEnd end, FileReport file, const PointTraits& traits, ReadReport& report) {
  end_ = std::move(end);
  tally_up();
  tally_.judge(std::move(file), traits, report, end_);
  for (size_t k = 0; k < has_values_.size() && traits.leave_out_zeros; ++k)
    if (!has_values_[k]) end_.without.push_back(k);
  const bool has_colors =
      header_.colors && header_.colors_in_range_of_all && !(traits.leave_out_zeros && largest_color_ == 0);
  end_.color_scale = has_colors ? ColorNumbers::scale(largest_color_, traits.whole_colors) : 0;
  if (is_whole()) apply(std::move(end_), block_);
}

void PointStream::close() {
  if (is_whole()) {
    PointEnd end = take_end(block_.samples);
    take_parts(std::move(block_.samples), sink_);
    return sink_.end(std::move(end));
  }
  hand_over(true);
  sink_.end(std::move(end_));
}

void CloudSink::take(PointBlock&& block) {
  if (file_.size() == 0)
    file_ = std::move(block);
  else
    append_block(file_, std::move(block));
}

void CloudSink::end(PointEnd&& end) {
  apply(std::move(end), file_);
  cloud_.append(std::move(file_.samples));
  file_ = {};
}

void hand_over(PointCloud&& cloud, const std::string& path, PointSink& sink) {
  sink.begin(header_of(cloud), path);
  PointEnd end = take_end(cloud);
  take_parts(std::move(cloud), sink);
  sink.end(std::move(end));
}

void hand_over(const PointCloud& cloud, const std::string& path, PointSink& sink) {
  sink.begin(header_of(cloud), path);
  take_parts(cloud, sink);
  sink.end(end_of(cloud));
}

}  // namespace soapfilm::io
