// A point cloud made of one or several scans: the input.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "soapfilm/context.h"
#include "soapfilm/vec.h"

namespace SOAPFILM_API soapfilm {

using Rgb8 = std::array<uint8_t, 3>;

/// Connectivity of a range image: `sample[row * columns + column]` is an index relative to the scan's first sample,
/// -1 where the scanner saw nothing.
struct RangeGrid {
  int columns = 0;
  int rows = 0;
  std::vector<int32_t> sample;
};

/// A contiguous run [begin, end) of a cloud's samples that one scanner position recorded.
struct Scan {
  std::string name;
  size_t begin = 0;
  size_t end = 0;
  std::optional<Vec3d> sensor;          ///< scanner position, input units and frame
  std::optional<Vec3d> view_direction;  ///< unit vector from the surface towards the scanner (parallel rays)
  std::optional<RangeGrid> range_grid;

  size_t size() const { return end - begin; }
};

/// A value of each sample or vertex, such as an intensity; not-a-number where there is none.
struct Column {
  std::string name;
  std::vector<float> values{};
  bool is_label = false;  ///< of several samples the most frequent value counts, else the mean
};

/// Samples in input units and frame. Optional columns are either empty or as long as `positions`.
struct PointCloud {
  std::vector<Vec3d> positions;
  std::vector<Vec3f> normals;  ///< outward, any length; zero means absent for that sample
  std::vector<Vec3d> sensors;  ///< scanner position of each sample
  std::vector<float> weights;  ///< >= 0
  std::vector<Rgb8> colors;
  std::vector<Column> columns;    ///< whatever else a file has; names differ
  std::vector<Scan> scans;        ///< in order, without gaps: together they cover all samples
  std::string coordinate_system;  ///< of a georeferenced file: WKT or "EPSG:NUMBER"; empty if unknown
  bool is_survey = false;  ///< from files of surveys (LAS): z is up, and what scanned it flew, unless it is known

  size_t size() const { return positions.size(); }
  Box3d box(const Context& context = Context(1)) const;

  /// Appends another cloud as further scans. A column that only one of the two has is filled with its neutral
  /// value: zero normal, not-a-number sensor or value, weight 1, gray color.
  void append(PointCloud&& other);

  /// Drops the samples where keep[i] is false, from every column, range grid and scan; empty scans disappear.
  void filter(const std::vector<bool>& keep);
};

}  // namespace soapfilm
