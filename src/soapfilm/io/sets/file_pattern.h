// Names as people order them and as shells match them: the same everywhere, whatever the locale and the file system.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace soapfilm::io {

/// Bytes in their order, but numbers count as numbers: scan_9 before scan_10.
bool comes_before(const std::string& a, const std::string& b);

/// Whether `name` is as the pattern of a shell says: * is any text, ? any character, [a-z_] one of these, [!a-z] none
/// of them. A point that begins a name is met by a point alone.
bool matches(std::string_view name, std::string_view pattern);

/// Whether `path` has one of *, ? and [, and is not the name of a file or folder that exists.
bool is_pattern(const std::string& path);

/// Files and folders that the pattern of a path names, in order. A part of the path that exists is no pattern. Throws
/// InputError for a folder that cannot be read.
std::vector<std::string> paths_of_pattern(const std::string& pattern);

}  // namespace soapfilm::io
