// A scan set as files that reconstruct reads: one PLY per scan in the scanner's own frame, and a .conf with the poses.
#pragma once

#include <string>

#include "soapfilm/context.h"
#include "tools/scanner/virtual_scan.h"

namespace soapfilm {

/// Writes NAME.ply for each scan in its own frame, the scanner at the origin, looking along -z: a central scan with the
/// sensor position (0, 0, 0), a parallel one with the viewing direction (0, 0, 1). Writes `conf_name`, which lists
/// them, last: if it exists all of its scans do. The folder must exist; files of the same names are replaced.
/// Coordinates are doubles: reading the set restores the scans up to rounding. Throws OutputError.
void write_scans(const std::string& folder, const std::string& conf_name, const ScanSet& set, const Context& context);

}  // namespace soapfilm
