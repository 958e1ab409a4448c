#include "cli/read_cloud.h"

#include <fmt/format.h>

namespace soapfilm::cli {

PointCloud read_cloud(const std::vector<std::string>& files, const Parallel& parallel, Progress& progress,
                      ReadReport& read) {
  PointCloud cloud = read_points(files, &read, parallel);
  for (const std::string& warning : read.warnings) progress.warn(warning);
  if (read.dropped() > 0)
    progress.warn(fmt::format("{} of {} samples dropped: not finite", read.dropped(), read.dropped() + cloud.size()));
  return cloud;
}

}  // namespace soapfilm::cli
