// Parameters from a file: those of an earlier run.
#pragma once

#include <string>

#include "soapfilm/params.h"

namespace soapfilm::cli {

/// Reads the parameters of a report (--report) or an object of its "parameters" alone. Throws InputError that names the
/// file: it cannot be read, is over 64 MiB or not JSON, has an unknown key or a value out of range.
ReconstructParams read_params(const std::string& path);

}  // namespace soapfilm::cli
