#include "soapfilm/core/cloud_layout.h"

#include <fmt/format.h>

#include "soapfilm/core/printable.h"
#include "soapfilm/error.h"

namespace soapfilm {

void check_layout(const PointCloud& cloud) {
  const size_t n = cloud.size();
  if (n == 0) throw ParameterError("cloud: 0 samples, must be > 0");
  for (const size_t size : {cloud.normals.size(), cloud.sensors.size(), cloud.weights.size(), cloud.colors.size()})
    if (size != 0 && size != n)
      throw ParameterError(fmt::format("cloud: a column of {}, must be absent or one per sample ({})", size, n));
  for (const Column& column : cloud.columns)
    if (column.values.size() != n)
      throw ParameterError(fmt::format("cloud: column '{}' has {} values, must be one per sample ({})",
                                       printable(column.name), column.values.size(), n));
  size_t covered = 0;
  for (const Scan& scan : cloud.scans) {
    if (scan.begin != covered || scan.end <= scan.begin || scan.end > n)
      throw ParameterError(
          fmt::format("cloud: scan [{}, {}), must begin at {} and hold samples", scan.begin, scan.end, covered));
    covered = scan.end;
    if (!scan.range_grid) continue;
    const RangeGrid& grid = *scan.range_grid;
    if (grid.columns <= 0 || grid.rows <= 0 ||
        grid.sample.size() != static_cast<size_t>(grid.columns) * static_cast<size_t>(grid.rows))
      throw ParameterError(fmt::format("cloud: range grid {} x {} of {} cells, must agree", grid.columns, grid.rows,
                                       grid.sample.size()));
  }
  if (!cloud.scans.empty() && covered != n)
    throw ParameterError(fmt::format("cloud: scans cover {} samples, must cover {}", covered, n));
}

}  // namespace soapfilm
