// The samples of a file on their way into a cloud: memory is planned before a row is read; what no row can tell by
// itself (the range of colors, rows without a return) is judged once all are read. Common to all readers.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "soapfilm/cloud.h"
#include "soapfilm/io.h"

namespace soapfilm::io {

/// What the head of a file, or its first row, says of its samples.
struct PointHeader {
  uint64_t samples = 0;  ///< at most; a count that the rest of the file cannot hold is for the reader to refuse
  bool normals = false;
  bool sensors = false;
  bool weights = false;
  bool colors = false;
  std::vector<std::string> columns;  ///< further ones, by their names in the file; made different where they are equal
  bool colors_of_16_bits = false;    ///< whole numbers to 65535: while they are read they take half the memory
};

/// The memory that each sample needs while it is read.
size_t bytes_per_sample(const PointHeader& header);

/// An empty cloud with room for the samples, and with the further columns. Throws InputError for more than 2^31 - 1 of
/// them, MemoryError if they do not fit into the free memory; nothing large is allocated then.
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
  /// As bytes. `whole`: 1 means 1 of 255.
  std::vector<Rgb8> bytes(bool whole) const;

 private:
  using Words = std::array<uint16_t, 3>;

  static Rgb8 rounded(const Vec3f& color, double scale);

  bool of_16_bits_ = false;
  std::vector<Vec3f> values_;
  std::vector<Words> words_;  // instead, if they are of 16 bits
};

/// What a format says of the samples in its files.
struct PointTraits {
  bool float32 = false;       ///< coordinates have 24 bits
  bool zero_is_none = false;  ///< (0, 0, 0) is a cell without a return; else it is if several samples are there
  bool has_faces = false;     ///< vertices of a mesh: one at (0, 0, 0) is as good as any
  bool closed = false;        ///< of a closed mesh: more often a result than a scan
};

/// The end of every reader. Drops and counts samples without a return and those with a non-finite coordinate; replaces
/// non-finite normals and sensor positions by their values for absent (zero, not-a-number). Warns of coordinates whose
/// steps are large beside the samples' spacing. Adds `file` to the report. Throws InputError when no sample is left.
void finish_points(PointCloud& cloud, FileReport file, const PointTraits& traits, ReadReport& report);

}  // namespace soapfilm::io
