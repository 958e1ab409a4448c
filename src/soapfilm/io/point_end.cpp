#include "soapfilm/io/point_end.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <utility>

#include "soapfilm/core/farthest.h"
#include "soapfilm/error.h"

namespace soapfilm::io {

namespace {

/// The distance between neighboring 32-bit numbers at the farthest coordinate.
double float_step(double farthest) { return std::ldexp(1.0, std::ilogb(farthest) - 23); }

void warn_of_steps(const Box3d& box, size_t samples, const std::string& path, ReadReport& report) {
  constexpr double harmless = 0.1;  // of the spacing: rounding is then noise of 0.03 voxels
  const double farthest = farthest_coordinate(box);
  const double spacing = box.diagonal() / std::sqrt(static_cast<double>(samples));
  if (farthest == 0 || spacing == 0 || float_step(farthest) <= harmless * spacing) return;
  report.warnings.push_back(fmt::format(
      "{}: coordinates near {:.6g} are stored as 32-bit numbers, in steps of {:.3g}; samples are about {:.3g} apart: "
      "the surface will have steps (write the file in double precision, or subtract an offset before)",
      path, farthest, float_step(farthest), spacing));
}

}  // namespace

void PointTally::add(PointCloud& samples, size_t begin, size_t end) {
  size_ += end - begin;
  for (size_t i = begin; i < end; ++i) {
    const Vec3d& p = samples.positions[i];
    if (!is_finite(p)) {
      ++non_finite_;
      empty_ += std::isnan(p.x) && std::isnan(p.y) && std::isnan(p.z);
    } else if (p == Vec3d{}) {
      ++zeros_;
    } else {
      box_.extend(p);
    }
  }
  if (!samples.normals.empty())
    for (size_t i = begin; i < end; ++i)
      if (Vec3f& normal = samples.normals[i]; !is_finite(normal)) {
        normal = {};
        ++ignored_normals_;
      }
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  if (!samples.sensors.empty())
    for (size_t i = begin; i < end; ++i)
      if (Vec3d& sensor = samples.sensors[i]; !is_finite(sensor)) sensor = {nan, nan, nan};
}

Box3d PointTally::box(bool with_zeros) const {
  Box3d box = box_;
  if (with_zeros && zeros_ > 0) box.extend(Vec3d{});
  return box;
}

void PointTally::judge(FileReport file, const PointTraits& traits, ReadReport& report, PointEnd& end) const {
  const size_t read = size_ + file.no_return;
  if (read == 0) throw InputError(file.path + ": holds no samples");
  end.drop_zeros = !traits.has_faces && zeros_ >= (traits.zero_is_none ? 1 : 2);
  end.drop_non_finite = non_finite_ > 0;
  const size_t zeros = end.drop_zeros ? zeros_ : 0;
  if (zeros > 0 && !traits.zero_is_none)
    report.warnings.push_back(fmt::format(
        "{}: {} of {} samples are at (0, 0, 0): taken for rays without a return, and dropped", file.path, zeros, read));
  file.ignored_normals += ignored_normals_;
  const size_t empty = traits.nan_is_none ? empty_ : 0;
  file.no_return += zeros + empty;
  file.dropped = non_finite_ - empty;
  file.samples = size_ - zeros - non_finite_;
  if (file.samples == 0)
    throw InputError(fmt::format("{}: none of its {} samples is usable: {} have a non-finite coordinate, {} no return",
                                 file.path, read, file.dropped, file.no_return));
  if (traits.float32) warn_of_steps(box(!end.drop_zeros), file.samples, file.path, report);
  if (traits.closed)
    report.warnings.push_back(file.path +
                              ": a closed mesh, as programs make them of scans; its vertices are read as samples");
  report.files.push_back(std::move(file));
}

void drop_samples(const PointEnd& end, PointCloud& cloud) {
  if (!end.drop_zeros && !end.drop_non_finite) return;
  std::vector<bool> keep(cloud.size());
  for (size_t i = 0; i < keep.size(); ++i) keep[i] = end.keeps(cloud.positions[i]);
  cloud.filter(keep);
}

}  // namespace soapfilm::io
