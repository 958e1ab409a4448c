// What a list of files and folders means: the scans in them, in order.
#pragma once

#include <string>
#include <vector>

namespace soapfilm::io {

/// `given`, folders replaced by the scans in them: a scan set, if one is there alone, otherwise all files with the
/// extension of a point format, where numbers in their names count as numbers (scan_9 before scan_10); text only if
/// there is nothing else. Meshes that the program has written itself under its default names are left out with a
/// warning, unless nothing else is given. Throws InputError for a folder without scans.
std::vector<std::string> input_files(const std::vector<std::string>& given, std::vector<std::string>& warnings);

/// Whether it is a mesh under a name as the program gives them: NAME.mesh.ply or NAME.preview.ply.
bool is_own_mesh(const std::string& path);

}  // namespace soapfilm::io
