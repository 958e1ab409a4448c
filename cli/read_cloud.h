// The samples of a command, read in one way by all of them.
#pragma once

#include <string>
#include <vector>

#include "soapfilm/cloud.h"
#include "soapfilm/context.h"
#include "soapfilm/io.h"
#include "soapfilm/progress.h"

namespace soapfilm::cli {

/// Several files are several scans. What reading them left out is a warning.
PointCloud read_cloud(const std::vector<std::string>& files, const Context& context, ReadReport& read);

}  // namespace soapfilm::cli
