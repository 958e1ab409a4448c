#include "soapfilm/io/las/las.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <optional>

#include "soapfilm/core/memory.h"
#include "soapfilm/error.h"
#include "soapfilm/io/las/copc.h"
#include "soapfilm/io/las/las_fields.h"
#include "soapfilm/io/las/las_header.h"
#include "soapfilm/io/las/las_records.h"
#include "soapfilm/io/las/laz_layout.h"
#include "soapfilm/io/las/laz_reader.h"
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

/// Runs of samples of one source (a flight line).
class SourceRuns {
 public:
  void add(double source, size_t sample) {
    if (sample > 0 && source == last_) return;
    last_ = source;
    if (runs_.size() <= most_runs) runs_.push_back({source, sample});
  }

  /// A scan for each run, unless sources alternate.
  std::vector<Scan> scans(size_t samples, const std::string& stem) const {
    const size_t count = runs_.size();
    const bool splits = count > 1 && count <= most_runs && samples / count >= least_mean_run;
    std::vector<Scan> all(splits ? count : 1);
    for (size_t k = 0; k < all.size(); ++k) {
      Scan& scan = all[k];
      scan.name = splits ? fmt::format("{} {}", stem, runs_[k].source) : stem;
      scan.begin = splits ? runs_[k].begin : 0;
      scan.end = splits && k + 1 < count ? runs_[k + 1].begin : samples;
    }
    return all;
  }

 private:
  static constexpr size_t most_runs = 1000;
  static constexpr size_t least_mean_run = 1000;
  struct Run {
    double source;
    size_t begin;
  };
  double last_ = 0;
  std::vector<Run> runs_;
};

class LasReader {
 public:
  LasReader(ByteSource& source, PointSink& sink, ReadReport& report, const Context& context)
      : source_(source), report_(report), context_(context), header_(read_las_header(source, report)), stream_(sink) {}

  void read(const ReadOptions& options) {
    const size_t extra_bytes = header_.record_bytes - standard_bytes(header_.point_format);
    LasRecords records = read_las_records(source_, header_, extra_bytes, report_);
    FileReport file;
    file.path = source_.path();
    file.format = fmt::format("{} 1.{}, point format {}", header_.compressed ? "LAZ" : "LAS", header_.minor_version,
                              header_.point_format);
    std::optional<LazLayout> layout;
    if (header_.compressed) layout = read_laz_layout(source_, header_, records.laszip);
    if (layout && !records.copc.empty() && options.spacing > 0) keep_levels(records.copc, options.spacing, *layout);
    fields_ = las_fields(first_record(layout), header_, records);
    for (const BinaryField& field : fields_.all) file.properties.push_back(field.name);
    if (!options.trajectory.empty()) open(options.trajectory);
    meaning_ = kept_columns(options.attributes);
    if (layout) laz_.emplace(source_, std::move(*layout), wanted_bytes(), context_);
    const PointTraits traits = read_points();
    warn_of_unread(records);
    warn_of_samples();
    PointEnd end;
    end.scans = runs_.scans(stream_.size(), std::filesystem::path(source_.path()).stem().string());
    end.coordinate_system = std::move(records.coordinate_system);
    end.is_survey = true;
    stream_.finish(std::move(end), std::move(file), traits, report_);
    stream_.close();
  }

 private:
  void warn(const std::string& message) { report_.warnings.push_back(source_.path() + ": " + message); }

  /// The header's number of points becomes that of the levels that are kept.
  void keep_levels(std::string_view copc, double spacing, LazLayout& layout) {
    const std::optional<CopcLevels> levels = keep_copc_levels(source_, copc, spacing, layout);
    if (!levels)
      warn("its octree (COPC) is damaged: all points are read");
    else if (levels->points < header_.count)
      warn(fmt::format("levels 0 to {} of 0 to {} (COPC), {:.4g} apart, are read: {} of {} points", levels->kept - 1,
                       levels->all - 1, levels->spacing, levels->points, header_.count));
    if (levels) header_.count = levels->points;
  }

  /// Also of a compressed file: each chunk begins with a point as it is.
  std::string_view first_record(const std::optional<LazLayout>& layout) const {
    const size_t begin = layout ? static_cast<size_t>(layout->chunks.front().begin) : header_.points_offset;
    return source_.bytes().substr(begin, header_.record_bytes);
  }

  void open(const std::string& trajectory) {
    if (fields_.gps_time)
      trajectory_.emplace(trajectory, report_);
    else
      warn(fmt::format("points of format {} have no GPS time: the trajectory {} is of no use for them",
                       header_.point_format, trajectory));
  }

  PointColumns kept_columns(const std::vector<std::string>& attributes) const {
    std::vector<std::string> names;
    for (const BinaryField& field : fields_.all) names.push_back(field.name);
    PointColumns columns = meaning_of(names);
    if (trajectory_ && columns.sensor.present()) {  // what the user names counts
      columns.others.insert(columns.others.end(), columns.sensor.index.begin(), columns.sensor.index.end());
      columns.sensor = {};
    }
    keep_attributes(attributes, names, columns);
    return columns;
  }

  /// Of each byte of a record: is it read?
  std::vector<bool> wanted_bytes() const {
    std::vector<bool> wanted(header_.record_bytes);
    const auto want = [&](const BinaryField& field) {
      std::fill_n(wanted.begin() + static_cast<std::ptrdiff_t>(field.offset), size_of(field.type), true);
    };
    for (const BinaryField* field : {&fields_.withheld, &fields_.classification, &fields_.source}) want(*field);
    if (trajectory_) want(*fields_.gps_time);
    for (const Triple& triple : {meaning_.position, meaning_.normal, meaning_.sensor, meaning_.color})
      if (triple.present())
        for (const size_t k : triple.index) want(fields_.all[k]);
    if (meaning_.weight != Triple::absent) want(fields_.all[meaning_.weight]);
    for (const size_t k : meaning_.others) want(fields_.all[k]);
    return wanted;
  }

  PointTraits read_points() {
    FieldReader rows(source_, fields_.all, meaning_);
    rows.leave_out_zeros();
    const PointHeader header = rows.header(header_.count, trajectory_.has_value());
    if (header_.compressed) check_growth(bytes_per_sample(header));
    if (trajectory_) stream_.keep_whole();
    stream_.begin(header, source_.path());
    if (laz_) {
      size_t done = 0;
      laz_->read([&](std::string_view records) {
        read_records(rows, records, done);
        done += records.size() / header_.record_bytes;
      });
    } else {
      const size_t bytes = header_.end_of_points() - header_.points_offset;
      read_records(rows, source_.bytes().substr(header_.points_offset, bytes), 0);
    }
    if (stream_.size() == 0)
      throw InputError(fmt::format("{}: all of its {} points are marked as withheld", source_.path(), header_.count));
    return rows.traits();
  }

  /// A few bits of a file can be a point; far more than real files have of this would be an attack.
  void check_growth(size_t bytes_per_row) const {
    constexpr uint64_t most_growth = 256, always = uint64_t{32} << 20;
    const uint64_t each = bytes_per_row + header_.record_bytes;
    const uint64_t most = (most_growth * source_.bytes().size() + always) / each;
    if (header_.count > most)
      throw InputError(
          fmt::format("{}: number of points = {}, must be at most {}: {} bytes each from a file of {} bytes",
                      source_.path(), header_.count, most, each, source_.bytes().size()));
  }

  /// `first`: how many of the file's points were before these.
  void read_records(FieldReader& rows, std::string_view records, size_t first) {
    records_ = records;
    rows.read_from(records, first);
    const size_t count = records.size() / header_.record_bytes;
    for (size_t begin = 0; begin < count; begin += FieldReader::block_rows) {
      context_.check();
      const size_t block = std::min(FieldReader::block_rows, count - begin);
      const bool all = find_kept(begin, block);
      rows.append(begin, block, all ? nullptr : &kept_, stream_);
      note_samples(begin, block, all);
      stream_.pass();
      if (!laz_) source_.release_before(header_.points_offset + begin * header_.record_bytes);
    }
  }

  /// The block's points that are not marked as withheld; true if these are all.
  bool find_kept(size_t first, size_t count) {
    read_field(records_, fields_.withheld, first, count, block_.data());
    kept_.clear();
    for (size_t i = 0; i < count; ++i)
      if (block_[i] == 0) kept_.push_back(static_cast<uint32_t>(i));
    withheld_ += count - kept_.size();
    return kept_.size() == count;
  }

  /// What is told of the samples, kept or not as columns.
  void note_samples(size_t first, size_t count, bool all) {
    const size_t used = all ? count : kept_.size();
    const auto value = [&](size_t i) { return block_[all ? i : kept_[i]]; };
    read_field(records_, fields_.classification, first, count, block_.data());
    for (size_t i = 0; i < used; ++i) noise_ += value(i) == 7 || value(i) == 18;
    read_field(records_, fields_.source, first, count, block_.data());
    for (size_t i = 0; i < used; ++i) runs_.add(value(i), stream_.size() - used + i);
    if (trajectory_) append_sensors(first, count, all);
  }

  void append_sensors(size_t first, size_t count, bool all) {
    read_field(records_, *fields_.gps_time, first, count, block_.data());
    const size_t used = all ? count : kept_.size();
    for (size_t i = 0; i < used; ++i) {
      const double time = block_[all ? i : kept_[i]];
      stream_.samples().sensors.push_back(trajectory_->at(time));
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
    if (outside_ == stream_.size()) {
      release(stream_.samples().sensors);
      if (clock_of(times_) != clock_of(way))
        reason = fmt::format(" (the clocks seem to differ: points have {}, the trajectory {})", clock_of(times_),
                             clock_of(way));
    }
    warn(fmt::format(
        "{} of {} samples have no scanner position: their GPS times are from {} to {}, those of "
        "the trajectory {} from {} to {}{}",
        outside_, stream_.size(), times_.first, times_.last, trajectory_->path(), way.first, way.last, reason));
  }

  void warn_of_samples() {
    if (noise_ > 0)
      warn(fmt::format("{} of {} samples are classified as noise (7 or 18), and used all the same", noise_,
                       stream_.size()));
    const Box3d box = stream_.box();
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

  ByteSource& source_;
  ReadReport& report_;
  const Context& context_;
  LasHeader header_;
  LasFields fields_;
  std::optional<Trajectory> trajectory_;
  PointColumns meaning_;
  std::optional<LazReader> laz_;  // of a compressed file
  std::string_view records_;      // that are being read
  PointStream stream_;
  std::array<double, FieldReader::block_rows> block_{};
  std::vector<uint32_t> kept_;  // of the block
  size_t withheld_ = 0;
  size_t noise_ = 0;
  SourceRuns runs_;
  size_t outside_ = 0;  // of the trajectory's times
  TimeRange times_;
};

}  // namespace

bool looks_like_las(const ByteSource& source) { return source.begins_with("LASF"); }

void read_las(ByteSource& source, PointSink& sink, ReadReport& report, const ReadOptions& options,
              const Context& context) {
  LasReader(source, sink, report, context).read(options);
}

}  // namespace soapfilm::io
