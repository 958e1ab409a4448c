#include "soapfilm/io/e57/e57_scan.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "soapfilm/io/grid_view.h"

namespace soapfilm::io {

namespace {

constexpr float e57_no_value = std::numeric_limits<float>::quiet_NaN();

bool has_e57_field(size_t field) { return field != Triple::absent; }

/// From where to where colors go: as colorLimits say, or the smallest and largest value that the fields can have.
std::optional<std::array<double, 2>> e57_color_limits(const E57Scan& scan, const E57Layout& layout) {
  if (!layout.color.present()) return std::nullopt;
  std::optional<std::array<double, 2>> limits = scan.color_limits;
  if (!limits) {
    limits = {HUGE_VAL, -HUGE_VAL};
    for (const size_t k : layout.color.index) {
      const auto& range = scan.fields[k].range;
      if (!range) return std::nullopt;
      limits = {std::min((*limits)[0], (*range)[0]), std::max((*limits)[1], (*range)[1])};
    }
  }
  const double length = (*limits)[1] - (*limits)[0];
  constexpr double longest = 1e10;  // more are not limits, but all that the type can hold
  return length > 0 && length <= longest ? limits : std::nullopt;
}

template <class T>
void keep_in_scan(std::vector<T>& values, size_t begin, const std::vector<bool>& keep) {
  if (values.empty()) return;
  size_t kept = begin;
  for (size_t i = 0; i < keep.size(); ++i)
    if (keep[i]) values[kept++] = values[begin + i];
  values.resize(kept);
}

}  // namespace

E57ScanReader::E57ScanReader(const E57Scan& scan, const E57Layout& layout, const std::vector<size_t>& column_of,
                             const PointHeader& header, PointCloud& cloud)
    : scan_(scan),
      layout_(layout),
      column_of_(column_of),
      header_(header),
      cloud_(cloud),
      begin_(cloud.size()),
      color_limits_(e57_color_limits(scan, layout)),
      first_time_(layout.further.size(), std::numeric_limits<double>::quiet_NaN()) {
  kept_.reserve(E57Records::block);
  if (layout.has_cells()) cells_.reserve(scan.records);
  if (layout.color.present() && !color_limits_) colors_.reserve(scan.records);
}

void E57ScanReader::read(E57Records& records, const Context& context, size_t& no_return) {
  while (const size_t count = records.next()) {
    context.check();
    append_block(records, count);
  }
  const size_t samples = cloud_.size();
  if (layout_.color.present() && !color_limits_) {
    const bool whole = scan_.fields[layout_.color[0]].kind == E57Field::Kind::integer;
    const std::vector<Rgb8> colors = colors_.bytes(whole);
    cloud_.colors.insert(cloud_.colors.end(), colors.begin(), colors.end());
    colors_ = {};
  }
  if (header_.normals) cloud_.normals.resize(samples);
  if (header_.sensors) {
    constexpr double none = std::numeric_limits<double>::quiet_NaN();
    cloud_.sensors.resize(samples, {none, none, none});
  }
  if (header_.weights) cloud_.weights.resize(samples, 1.0f);
  if (header_.colors) cloud_.colors.resize(samples, {128, 128, 128});
  for (Column& column : cloud_.columns) column.values.resize(samples, e57_no_value);
  if (at_origin_ > 1) drop_origins();
  no_return += no_return_;
}

void E57ScanReader::append_block(const E57Records& records, size_t count) {
  const auto valid = [](const double* state, size_t i) { return state == nullptr || state[i] == 0; };
  const double* state = has_e57_field(layout_.position_state) ? records.values(layout_.position_state) : nullptr;
  const double* range = layout_.spherical ? records.values(layout_.position[0]) : nullptr;
  kept_.clear();
  for (size_t i = 0; i < count; ++i)
    if (valid(state, i) && !(range != nullptr && range[i] <= 0)) kept_.push_back(static_cast<uint16_t>(i));
  no_return_ += count - kept_.size();
  all_kept_ = kept_.size() == count;

  append_positions(records);
  append(records, layout_.normal, cloud_.normals);
  append(records, layout_.sensor, cloud_.sensors);
  append_colors(records);
  append_further(records);
  if (has_e57_field(layout_.weight)) {
    const double* weights = records.values(layout_.weight);
    for (const size_t i : kept_) {
      const auto weight = static_cast<float>(weights[i]);
      if (!(weight >= 0) || !std::isfinite(weight))
        records.fail(fmt::format("weight = {}, must be finite and >= 0", weights[i]));
      cloud_.weights.push_back(weight);
    }
  }
  if (!layout_.has_cells()) return;
  const double* rows = records.values(layout_.row);
  const double* columns = records.values(layout_.column);
  const double* order = has_e57_field(layout_.return_index) ? records.values(layout_.return_index) : nullptr;
  for (const size_t i : kept_) cells_.add(rows[i], columns[i], order != nullptr ? order[i] : 0);
}

/// use(k, i) for the k-th of the block's samples, which is record i. Blocks without gaps are made of longer loops that
/// the compiler can vectorize.
template <class Use>
void E57ScanReader::for_kept(Use&& use) const {
  const size_t count = kept_.size();
  if (all_kept_)
    for (size_t k = 0; k < count; ++k) use(k, k);
  else
    for (size_t k = 0; k < count; ++k) use(k, kept_[k]);
}

template <class T>
void E57ScanReader::append(const E57Records& records, const Triple& fields, std::vector<Vec3<T>>& to) {
  if (!fields.present()) return;
  const double* x = records.values(fields[0]);
  const double* y = records.values(fields[1]);
  const double* z = records.values(fields[2]);
  to.resize(to.size() + kept_.size());
  Vec3<T>* out = to.data() + (to.size() - kept_.size());
  for_kept([&](size_t k, size_t i) { out[k] = {static_cast<T>(x[i]), static_cast<T>(y[i]), static_cast<T>(z[i])}; });
}

void E57ScanReader::append_positions(const E57Records& records) {
  const size_t first = cloud_.size();
  append(records, layout_.position, cloud_.positions);
  if (layout_.spherical) {
    for (size_t k = first; k < cloud_.size(); ++k) {
      const auto [range, azimuth, elevation] = cloud_.positions[k];
      const double flat = range * std::cos(elevation);
      cloud_.positions[k] = {flat * std::cos(azimuth), flat * std::sin(azimuth), range * std::sin(elevation)};
    }
  } else {
    for (size_t k = first; k < cloud_.size(); ++k) at_origin_ += cloud_.positions[k] == Vec3d{};
  }
}

void E57ScanReader::append_colors(const E57Records& records) {
  if (!layout_.color.present()) return;
  const double* state = has_e57_field(layout_.color_state) ? records.values(layout_.color_state) : nullptr;
  std::array<const double*, 3> channels{};
  for (size_t c = 0; c < 3; ++c) channels[c] = records.values(layout_.color[c]);
  const auto& [r, g, b] = channels;
  if (!color_limits_) {
    for (const size_t i : kept_)
      if (state != nullptr && state[i] != 0)
        colors_.add(-1, -1, -1);
      else
        colors_.add(r[i], g[i], b[i]);
    return;
  }
  const double low = (*color_limits_)[0];
  const double scale = 255 / ((*color_limits_)[1] - low);
  cloud_.colors.resize(cloud_.size(), {128, 128, 128});
  Rgb8* out = cloud_.colors.data() + (cloud_.size() - kept_.size());
  for (size_t c = 0; c < 3; ++c)
    for_kept([&, values = channels[c]](size_t k, size_t i) {
      const double value = (values[i] - low) * scale;  // may be not-a-number
      if (state == nullptr || state[i] == 0)
        out[k][c] = static_cast<uint8_t>(value > 0 ? std::min(value, 255.0) + 0.5 : 0.0);
    });
}

void E57ScanReader::append_further(const E57Records& records) {
  for (size_t f = 0; f < layout_.further.size(); ++f) {
    const E57Layout::Further& further = layout_.further[f];
    const double* values = records.values(further.field);
    const double* state = has_e57_field(further.state) ? records.values(further.state) : nullptr;
    std::vector<float>& to = cloud_.columns[column_of_[f]].values;
    to.resize(cloud_.size());
    float* out = to.data() + (cloud_.size() - kept_.size());
    if (state == nullptr && !further.from_first) {
      for_kept([&](size_t k, size_t i) { out[k] = static_cast<float>(values[i]); });
      continue;
    }
    double& first = first_time_[f];
    for_kept([&](size_t k, size_t i) {
      const bool none = state != nullptr && state[i] != 0;
      if (!none && further.from_first && std::isnan(first)) first = values[i];
      out[k] = none ? e57_no_value : static_cast<float>(further.from_first ? values[i] - first : values[i]);
    });
  }
}

/// One sample alone may lie at the origin; of several, no ray has met a thing there.
void E57ScanReader::drop_origins() {
  std::vector<bool> keep(cloud_.size() - begin_);
  for (size_t i = 0; i < keep.size(); ++i) keep[i] = !(cloud_.positions[begin_ + i] == Vec3d{});
  keep_in_scan(cloud_.positions, begin_, keep);
  keep_in_scan(cloud_.normals, begin_, keep);
  keep_in_scan(cloud_.sensors, begin_, keep);
  keep_in_scan(cloud_.weights, begin_, keep);
  keep_in_scan(cloud_.colors, begin_, keep);
  for (Column& column : cloud_.columns) keep_in_scan(column.values, begin_, keep);
  if (layout_.has_cells()) cells_.filter(keep);
  no_return_ += at_origin_;
}

namespace {

/// Programs that keep coordinates small move them by round numbers, and write these as a pose.
bool is_shift_of_coordinates(const Placement& pose) {
  constexpr double far = 1e4, round = 10;
  const Vec3d t = pose.translation;
  return pose.linear == Placement{}.linear && std::max({std::abs(t.x), std::abs(t.y), std::abs(t.z)}) >= far &&
         std::fmod(t.x, round) == 0 && std::fmod(t.y, round) == 0 && std::fmod(t.z, round) == 0;
}

}  // namespace

/// Merged and exported clouds lie at the origin of their coordinates, too, but no scanner stood there.
bool E57ScanReader::tells_of_scanner(const Scan& scan) const {
  constexpr double not_far = 10;  // diagonals
  if (scan.range_grid) return is_scanner_place(cloud_.positions, scan, {}, true);
  return scan_.names_scanner && is_near_samples(cloud_.positions, scan, {}, not_far);
}

bool E57ScanReader::contradicts_scanner(const Scan& scan) const {
  constexpr double far = 30;  // diagonals
  return !is_near_samples(cloud_.positions, scan, {}, far) ||
         judge_view(cloud_.positions, scan, {}) == GridView::not_from;
}

std::string E57ScanReader::finish(bool trust_origin) {
  Scan scan;
  scan.name = scan_.name;
  scan.begin = begin_;
  scan.end = cloud_.size();
  if (scan.size() == 0) return {};
  std::string why_no_grid;
  if (layout_.has_cells()) why_no_grid = cells_.give_to(scan);
  const Placement pose = scan_.pose.value_or(Placement{});
  const bool moved = !(pose == Placement{});
  const bool of_scanner = trust_origin || layout_.spherical || tells_of_scanner(scan);
  const bool turned = !(pose.linear == Placement{}.linear);
  unseen_ = !moved && !of_scanner && (scan.range_grid || scan_.names_scanner);
  shifted_ = moved && !turned && !of_scanner && (is_shift_of_coordinates(pose) || contradicts_scanner(scan));
  if (of_scanner || (moved && !shifted_)) scan.sensor = pose.translation;
  if (moved) place_samples(pose, cloud_, scan.begin, scan.end);
  cloud_.scans.push_back(std::move(scan));
  return why_no_grid;
}

}  // namespace soapfilm::io
