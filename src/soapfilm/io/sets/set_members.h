// The scans that a set names, read and placed: common to scan sets and MeshLab projects.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "soapfilm/cloud.h"
#include "soapfilm/io.h"
#include "soapfilm/io/bytes/byte_source.h"

namespace soapfilm::io {

struct SetMember {
  std::string file;                        ///< relative to the set's folder, or absolute
  std::function<void(PointCloud&)> place;  ///< moves the scan to its place; called on any thread
};

/// With the set's folder.
std::vector<std::string> member_paths(const ByteSource& set, const std::vector<SetMember>& members);

/// All members as scans of one cloud, in order. Of a file that is only a mesh the vertices are samples. Throws
/// InputError, naming the set, for a member that is a set itself; `keyword` is what names members in it.
PointCloud read_members(const ByteSource& set, std::string_view keyword, const std::vector<SetMember>& members,
                        ReadReport& report, const ReadOptions& options, const Context& context);

}  // namespace soapfilm::io
