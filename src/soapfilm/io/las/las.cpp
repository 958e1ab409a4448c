#include "soapfilm/io/las/las.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <optional>

#include "soapfilm/core/memory.h"
#include "soapfilm/error.h"
#include "soapfilm/io/las/las_fields.h"
#include "soapfilm/io/las/las_header.h"
#include "soapfilm/io/las/las_records.h"
#include "soapfilm/io/las/trajectory.h"

namespace soapfilm::io {

namespace {

struct TimeRange {
  double first = std::numeric_limits<double>::infinity();
  double last = -std::numeric_limits<double>::infinity();

  void extend(double time) {
    first = std::min(first, time);
    last = std::max(last, time);
  }
};

/// The clock that times of this size are of.
std::string_view clock_of(const TimeRange& range) {
  constexpr double week = 7 * 24 * 3600;
  if (range.first >= 0 && range.last <= week) return "seconds of the GPS week";
  if (range.first >= 1e9) return "seconds since 1980 (GPS) or 1970 (Unix)";
  return "adjusted standard GPS time (seconds since 1980 less 1e9)";
}

const std::vector<float>* find_values(const PointCloud& cloud, std::string_view name) {
  for (const Column& column : cloud.columns)
    if (column.name == name) return &column.values;
  return nullptr;
}

class LasReader {
 public:
  LasReader(ByteSource& source, ReadReport& report, const Context& context)
      : source_(source), report_(report), context_(context), header_(read_las_header(source, report)) {}

  PointCloud read(const std::string& trajectory) {
    const size_t extra_bytes = header_.record_bytes - standard_bytes(header_.point_format);
    LasRecords records = read_las_records(source_, header_, extra_bytes, report_);
    fields_ = las_fields(source_, header_, records);
    if (!trajectory.empty()) open(trajectory);
    read_points();
    cloud_.coordinate_system = std::move(records.coordinate_system);
    cloud_.is_survey = true;
    warn_of_unread(records);
    warn_of_samples();
    split_into_scans();

    FileReport file;
    file.path = source_.path();
    file.format = fmt::format("LAS 1.{}, point format {}", header_.minor_version, header_.point_format);
    for (const BinaryField& field : fields_.all) file.properties.push_back(field.name);
    finish_points(cloud_, std::move(file), {}, report_);
    return std::move(cloud_);
  }

 private:
  void warn(const std::string& message) { report_.warnings.push_back(source_.path() + ": " + message); }

  void open(const std::string& trajectory) {
    if (fields_.gps_time)
      trajectory_.emplace(trajectory, report_);
    else
      warn(fmt::format("points of format {} have no GPS time: the trajectory {} is of no use for them",
                       header_.point_format, trajectory));
  }

  PointColumns meaning() const {
    std::vector<std::string> names;
    for (const BinaryField& field : fields_.all) names.push_back(field.name);
    PointColumns columns = meaning_of(names);
    if (trajectory_ && columns.sensor.present()) {  // what the user names counts
      columns.others.insert(columns.others.end(), columns.sensor.index.begin(), columns.sensor.index.end());
      columns.sensor = {};
    }
    return columns;
  }

  void read_points() {
    FieldReader rows(source_, fields_.all, meaning());
    rows.leave_out_zeros();
    cloud_ = rows.cloud_for_rows(header_.count, trajectory_.has_value());
    const auto count = static_cast<size_t>(header_.count);
    for (size_t first = 0; first < count; first += FieldReader::block_rows) {
      context_.check();
      const size_t block = std::min(FieldReader::block_rows, count - first);
      const bool all = find_kept(first, block);
      rows.append(first, block, all ? nullptr : &kept_, cloud_);
      if (trajectory_) append_sensors(first, block, all);
      source_.release_before(header_.points_offset + first * header_.record_bytes);
    }
    rows.finish(cloud_);
    if (cloud_.size() == 0)
      throw InputError(fmt::format("{}: all of its {} points are marked as withheld", source_.path(), header_.count));
  }

  /// The block's points that are not marked as withheld; true if these are all.
  bool find_kept(size_t first, size_t count) {
    read_field(source_.bytes(), fields_.withheld, first, count, block_.data());
    kept_.clear();
    for (size_t i = 0; i < count; ++i)
      if (block_[i] == 0) kept_.push_back(static_cast<uint32_t>(i));
    withheld_ += count - kept_.size();
    return kept_.size() == count;
  }

  void append_sensors(size_t first, size_t count, bool all) {
    read_field(source_.bytes(), *fields_.gps_time, first, count, block_.data());
    const size_t used = all ? count : kept_.size();
    for (size_t i = 0; i < used; ++i) {
      const double time = block_[all ? i : kept_[i]];
      cloud_.sensors.push_back(trajectory_->at(time));
      times_.extend(time);
      outside_ += !(time >= trajectory_->first_time() && time <= trajectory_->last_time());
    }
  }

  void warn_of_unread(const LasRecords& records) {
    if (withheld_ > 0) warn(fmt::format("{} of {} points are marked as withheld: left out", withheld_, header_.count));
    if (records.undescribed_bytes > 0)
      warn(fmt::format("{} extra bytes of each point are not read: no record describes them as numbers",
                       records.undescribed_bytes));
    if (header_.has_waveforms())
      warn(fmt::format("the waveforms that points of format {} refer to are not read", header_.point_format));
    if (trajectory_ && outside_ > 0) warn_of_times();
  }

  void warn_of_times() {
    const TimeRange way{trajectory_->first_time(), trajectory_->last_time()};
    std::string reason;
    if (outside_ == cloud_.size()) {
      release(cloud_.sensors);
      if (clock_of(times_) != clock_of(way))
        reason = fmt::format(" (the clocks seem to differ: points have {}, the trajectory {})", clock_of(times_),
                             clock_of(way));
    }
    warn(fmt::format(
        "{} of {} samples have no scanner position: their GPS times are from {} to {}, those of "
        "the trajectory {} from {} to {}{}",
        outside_, cloud_.size(), times_.first, times_.last, trajectory_->path(), way.first, way.last, reason));
  }

  void warn_of_samples() {
    if (const std::vector<float>* classes = find_values(cloud_, "classification")) {
      const auto noise = std::count_if(classes->begin(), classes->end(), [](float c) { return c == 7 || c == 18; });
      if (noise > 0)
        warn(fmt::format("{} of {} samples are classified as noise (7 or 18), and used all the same", noise,
                         cloud_.size()));
    }
    const Box3d box = cloud_.box(context_);
    const bool given =
        std::isfinite(header_.box.diagonal()) && !(header_.box.lo == Vec3d{} && header_.box.hi == Vec3d{});
    for (int axis = 0; axis < 3 && given; ++axis) {
      const double step = std::abs(header_.scale[axis]);  // writers round the box, too
      if (box.lo[axis] >= header_.box.lo[axis] - step && box.hi[axis] <= header_.box.hi[axis] + step) continue;
      return warn(fmt::format("{} is from {} to {} in the header, from {} to {} in the points, which count",
                              std::string_view("xyz")[static_cast<size_t>(axis)], header_.box.lo[axis],
                              header_.box.hi[axis], box.lo[axis], box.hi[axis]));
    }
  }

  /// A scan for each run of points of one source (a flight line), unless sources alternate.
  void split_into_scans() {
    constexpr size_t most_runs = 1000;
    constexpr size_t least_mean_run = 1000;
    const std::string stem = std::filesystem::path(source_.path()).stem().string();
    const std::vector<float>* sources = find_values(cloud_, "point_source_id");
    for (size_t i = 0; sources != nullptr && i < cloud_.size(); ++i) {
      if (i > 0 && (*sources)[i] == (*sources)[i - 1]) continue;
      if (!cloud_.scans.empty()) cloud_.scans.back().end = i;
      Scan& scan = cloud_.scans.emplace_back();
      scan.name = fmt::format("{} {}", stem, (*sources)[i]);
      scan.begin = i;
      scan.end = cloud_.size();
      if (cloud_.scans.size() > most_runs) break;
    }
    const size_t runs = cloud_.scans.size();
    if (runs > 1 && runs <= most_runs && cloud_.size() / runs >= least_mean_run) return;
    Scan whole;
    whole.name = stem;
    whole.end = cloud_.size();
    cloud_.scans = {whole};
  }

  ByteSource& source_;
  ReadReport& report_;
  const Context& context_;
  LasHeader header_;
  LasFields fields_;
  std::optional<Trajectory> trajectory_;
  PointCloud cloud_;
  std::array<double, FieldReader::block_rows> block_{};
  std::vector<uint32_t> kept_;  // of the block
  size_t withheld_ = 0;
  size_t outside_ = 0;  // of the trajectory's times
  TimeRange times_;
};

}  // namespace

bool looks_like_las(const ByteSource& source) { return source.begins_with("LASF"); }

PointCloud read_las(ByteSource& source, ReadReport& report, const ReadOptions& options, const Context& context) {
  return LasReader(source, report, context).read(options.trajectory);
}

}  // namespace soapfilm::io
