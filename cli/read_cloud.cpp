#include "cli/read_cloud.h"

#include <fmt/format.h>

namespace soapfilm::cli {

PointCloud read_cloud(const std::vector<std::string>& files, const Context& context, ReadReport& read) {
  PointCloud cloud = read_points(files, &read, context);
  for (const std::string& warning : read.warnings) context.progress().warn(warning);
  if (read.dropped() > 0)
    context.progress().warn(
        fmt::format("{} of {} samples dropped: not finite", read.dropped(), read.dropped() + cloud.size()));
  return cloud;
}

}  // namespace soapfilm::cli
