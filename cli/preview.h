// What soapfilm reconstruct does where -o or the resolution is left to it: names of meshes, and --preview.
#pragma once

#include <string>
#include <vector>

#include "soapfilm/cloud.h"
#include "soapfilm/params.h"
#include "soapfilm/progress.h"

namespace soapfilm::cli {

/// NAME.mesh.ply or NAME.preview.ply in the current folder, where NAME is the input's without folder and extension:
/// folders of scans are often shared or read-only, and several inputs may lie in several of them.
std::string default_mesh(const std::string& input, bool preview);

/// Parameters and samples of a first look: cells four times as large, and of many samples a part, so that much of the
/// time goes to reading the file. Tells how many.
void make_preview(ReconstructParams& params, PointCloud& cloud, Progress& progress);

/// The command line of the full run: without --preview.
std::string full_run(const std::vector<std::string>& arguments);

}  // namespace soapfilm::cli
