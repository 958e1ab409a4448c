#include "soapfilm/io/sanitize.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "soapfilm/core/vec.h"
#include "soapfilm/error.h"

namespace soapfilm::io {

void drop_non_finite(PointCloud& cloud, FileReport& report) {
  const size_t read = cloud.size();
  if (read == 0) throw InputError(report.path + ": holds no samples");

  for (Vec3f& normal : cloud.normals) {
    if (is_finite(normal)) continue;
    normal = {};
    ++report.ignored_normals;
  }
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  for (Vec3d& sensor : cloud.sensors)
    if (!is_finite(sensor)) sensor = {nan, nan, nan};

  const auto bad = [](const Vec3d& p) { return !is_finite(p); };
  report.dropped = static_cast<size_t>(std::count_if(cloud.positions.begin(), cloud.positions.end(), bad));
  report.samples = read - report.dropped;
  if (report.samples == 0)
    throw InputError(fmt::format("{}: all of its {} samples have a non-finite coordinate", report.path, read));
  if (report.dropped == 0) return;
  std::vector<bool> keep(read);
  for (size_t i = 0; i < read; ++i) keep[i] = is_finite(cloud.positions[i]);
  cloud.filter(keep);
}

}  // namespace soapfilm::io
