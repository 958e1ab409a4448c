// What soapfilm --version prints.
#pragma once

#include <string>

namespace soapfilm::cli {

/// "soapfilm VERSION" on its first line, then the facts that a report of a fault needs: compiler, SIMD targets that
/// this processor can run, platform, options, libraries, license.
std::string version_page();

}  // namespace soapfilm::cli
