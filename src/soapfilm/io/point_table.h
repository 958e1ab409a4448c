// The samples of a file on their way into a cloud: memory is planned before a row is read; what no row can tell by
// itself (the range of colors, rows without a return) is judged once all are read. Common to all readers.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "soapfilm/cloud.h"
#include "soapfilm/io.h"
#include "soapfilm/io/point_end.h"

namespace soapfilm::io {

/// Limit on the samples of a file that becomes a cloud: range grids hold their indices in 32 bits.
inline constexpr size_t most_cloud_samples = INT32_MAX;

/// What the head of a file, or its first row, says of its samples.
struct PointHeader {
  uint64_t samples = 0;  ///< at most; a count that the rest of the file cannot hold is for the reader to refuse
  bool normals = false;
  bool sensors = false;
  bool weights = false;
  bool colors = false;
  std::vector<std::string> columns;  ///< further ones, by their names in the file; made different where they are equal
  bool colors_of_16_bits = false;    ///< whole numbers to 65535: while they are read they take half the memory
  bool colors_in_range_of_all = false;  ///< numbers of a range that only all of them tell: ColorNumbers
};

/// The memory that each sample needs while it is read.
size_t bytes_per_sample(const PointHeader& header);

/// Throws InputError for more than most_cloud_samples, MemoryError if they do not fit into the free memory.
void check_cloud_fits(const PointHeader& header, const std::string& path);

/// An empty cloud with room for so many samples, and with the further columns.
PointCloud cloud_for(const PointHeader& header, size_t room);
/// The same with room for all of them, checked.
PointCloud cloud_for(const PointHeader& header, const std::string& path);

/// Colors as numbers of a range that only all of them tell: to 1 (only numbers that need not be whole), to 255 or to
/// 65535. A negative or not finite number is no color: gray.
class ColorNumbers {
 public:
  /// `of_16_bits`: all will be whole numbers to 65535.
  void reserve(size_t count, bool of_16_bits = false);
  void add(double red, double green, double blue);
  /// The largest number that was added; 0 if there is none.
  float largest() const;
  size_t size() const { return values_.size() + words_.size(); }
  /// Those of [begin, end) of others of the same bits.
  void append(const ColorNumbers& others, size_t begin, size_t end);
  /// What numbers up to `largest` are multiplied by to reach 255. `whole`: 1 means 1 of 255.
  static double scale(float largest, bool whole);
  std::vector<Rgb8> bytes(double scale) const;
  std::vector<Rgb8> bytes(bool whole) const { return bytes(scale(largest(), whole)); }

 private:
  using Words = std::array<uint16_t, 3>;

  static Rgb8 rounded(const Vec3f& color, double scale);

  bool of_16_bits_ = false;
  std::vector<Vec3f> values_;
  std::vector<Words> words_;  // instead, if they are of 16 bits
};

/// Drops the further columns and the colors that `attributes` does not name, as keep_attributes() of point_columns.h.
void keep_attributes(const std::vector<std::string>& attributes, PointCloud& cloud);

/// The end of a reader that has the whole cloud: what PointTally finds is applied to it, and reported.
void finish_points(PointCloud& cloud, FileReport file, const PointTraits& traits, ReadReport& report);

}  // namespace soapfilm::io
