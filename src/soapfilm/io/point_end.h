// What no sample tells by itself but only all of a file: which are rays without a return, the range of colors, columns
// that say nothing. It is gathered while the samples pass, and applied to them afterwards.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "soapfilm/cloud.h"
#include "soapfilm/core/vec.h"
#include "soapfilm/io.h"

namespace soapfilm::io {

/// What a format says of the samples in its files.
struct PointTraits {
  bool float32 = false;          ///< coordinates have 24 bits
  bool zero_is_none = false;     ///< (0, 0, 0) is a cell without a return; else it is if several samples are there
  bool nan_is_none = false;      ///< samples without any coordinate are cells without a return
  bool has_faces = false;        ///< vertices of a mesh: one at (0, 0, 0) is as good as any
  bool closed = false;           ///< of a closed mesh: more often a result than a scan
  bool whole_colors = false;     ///< colors are whole numbers: 1 means 1 of 255
  bool leave_out_zeros = false;  ///< columns, and colors, that are zero in all samples are left out
};

struct PointEnd {
  std::vector<Scan> scans;  ///< of the samples as they came, with those that are to be dropped
  std::string coordinate_system{};
  bool is_survey = false;
  double color_scale = 0;         ///< of the blocks' ColorNumbers; 0: they say nothing, or there are none
  std::vector<size_t> without{};  ///< further columns that are dropped, by their indices
  bool drop_zeros = false;        ///< samples at (0, 0, 0) are dropped
  bool drop_non_finite = false;   ///< samples with a coordinate that is not finite are dropped

  bool keeps(const Vec3d& p) const { return !(drop_zeros && p == Vec3d{}) && !(drop_non_finite && !is_finite(p)); }
};

/// Counts of the samples that have passed. It makes normals that are not finite zero, and sensors not-a-number: absent.
class PointTally {
 public:
  /// Samples [begin, end) of a cloud.
  void add(PointCloud& samples, size_t begin, size_t end);
  void add(PointCloud& samples) { add(samples, 0, samples.size()); }

  size_t size() const { return size_; }
  /// Of the finite positions; those at (0, 0, 0) only `with_zeros`.
  Box3d box(bool with_zeros = true) const;
  /// Which samples are dropped; completes and adds `file` to the report, and warns of coordinates whose steps are large
  /// beside the samples' spacing. Throws InputError when no sample is left.
  void judge(FileReport file, const PointTraits& traits, ReadReport& report, PointEnd& end) const;

 private:
  size_t size_ = 0, zeros_ = 0, non_finite_ = 0, empty_ = 0, ignored_normals_ = 0;
  Box3d box_;  // without (0, 0, 0)
};

/// Drops the samples that `end` does not keep; its scans are not used.
void drop_samples(const PointEnd& end, PointCloud& cloud);

}  // namespace soapfilm::io
