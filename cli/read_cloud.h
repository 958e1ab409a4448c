// Reads the samples of a command; common to all commands.
#pragma once

#include <string>
#include <vector>

#include "soapfilm/cloud.h"
#include "soapfilm/context.h"
#include "soapfilm/io.h"
#include "soapfilm/progress.h"

namespace soapfilm::cli {

/// Several files are several scans. Warns of what was ignored while reading.
PointCloud read_cloud(const std::vector<std::string>& files, const Context& context, ReadReport& read);

}  // namespace soapfilm::cli
