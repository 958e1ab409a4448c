// The properties of a point cloud that `soapfilm info` prints, counted while its samples pass: a file may be larger
// than the memory.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "soapfilm/cloud.h"
#include "soapfilm/io/point_stream.h"

namespace soapfilm {

struct ScanSummary {
  struct Grid {
    int columns = 0, rows = 0;
    size_t samples = 0;
  };
  std::string name;
  size_t samples = 0;
  std::optional<Vec3d> sensor, view_direction;
  std::optional<Grid> grid;
};

struct CloudSummary {
  size_t samples = 0;
  Box3d box;
  double spacing = 0;  ///< see sample_spacing()
  size_t normals = 0;  ///< samples with a normal that is not zero
  size_t sensors = 0;  ///< samples with a sensor position of their own
  bool weights = false, colors = false;
  std::vector<std::string> columns;  ///< further ones
  std::vector<ScanSummary> scans;
  std::string coordinate_system;
  size_t scans_with_sensor = 0;  ///< scans with one sensor position for all
  size_t scans_with_view_direction = 0;
  size_t scans_with_range_grid = 0;
};

CloudSummary summarize(const PointCloud& cloud);

/// Of the samples of all files, as of the cloud that they would be. Of more samples than `most_places` it keeps the
/// places of every second one, every fourth, and so on: only the spacing is estimated from them.
class SummarySink : public io::PointSink {
 public:
  explicit SummarySink(size_t most_places = size_t{1} << 22) : most_places_(most_places) {}

  void take(io::PointBlock&& block) override;
  void end(io::PointEnd&& end) override;
  CloudSummary summary() const;

  /// Bytes that it holds at most until now.
  size_t held_bytes() const { return held_; }

 private:
  /// Of samples that are kept or dropped together.
  struct Counts {
    size_t samples = 0, normals = 0, sensors = 0;

    void add(const PointCloud& cloud, size_t i);
    void add(const Counts& other);
  };
  /// Samples [begin, end) of the file, which may be dropped.
  struct Run {
    size_t begin, end;
    bool zeros;
  };

  void keep_place(const Vec3d& place);
  void keep_run(size_t sample, bool zero);
  size_t kept_in(const Scan& scan, const io::PointEnd& end) const;
  void add_columns(const io::PointEnd& end);

  size_t most_places_;
  CloudSummary sum_;
  std::vector<Vec3d> places_;  // of every stride_-th sample
  size_t stride_ = 1, to_next_ = 0;
  size_t held_ = 0;
  // Of the file:
  size_t size_ = 0, first_place_ = 0;
  Counts others_, zeros_;
  Box3d box_;
  std::vector<Run> runs_;
  bool weights_ = false, colors_ = false;
  std::vector<std::string> columns_;
};

/// Estimated distance of neighboring samples, input units: the side of a square with the area of surface per sample,
/// sqrt(pi / k) r_k with r_k the distance to the k-th neighbor, k = 8; the median over at most `queries` samples taken
/// at equal steps. 0 when there are fewer than two different positions.
double sample_spacing(const PointCloud& cloud, size_t queries = 2000);

}  // namespace soapfilm
