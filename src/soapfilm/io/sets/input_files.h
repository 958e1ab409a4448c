// What a list of files, folders and patterns means: the scans in them, in order.
#pragma once

#include <string>
#include <vector>

namespace soapfilm::io {

/// Whether a name stands for the scans in it: a folder, or a pattern that no shell has replaced.
bool is_folder_or_pattern(const std::string& path);

/// `given`, patterns (file_pattern.h) replaced by the files that they name and that end as those of a format that can
/// be read, in order; where there are none, by the folders that they name. Throws InputError for one that names
/// nothing.
std::vector<std::string> without_patterns(const std::vector<std::string>& given);

/// `given`, patterns replaced, and folders by the scans in them: a scan set, if one is there alone, otherwise all files
/// with the extension of a point format, in the order of comes_before(): clouds, or else text with an extension of
/// points, or else meshes, which have faces, or else other text (.txt, .csv). Meshes that the program has written
/// itself under its default names are left out, of the list given too unless nothing else is in it. A file that is
/// named twice, by whatever names, stays where it is first. What is left out is warned of. Throws InputError for a
/// folder without scans.
std::vector<std::string> input_files(const std::vector<std::string>& given, std::vector<std::string>& warnings);

/// Whether it is a mesh under a name as the program gives them: NAME.mesh.ply or NAME.preview.ply, or a part of one.
bool is_own_mesh(const std::string& path);

}  // namespace soapfilm::io
