// One surface on several levels of detail.
#pragma once

#include <string>
#include <vector>

#include "soapfilm/io.h"

namespace soapfilm {

struct DetailLevel {
  Mesh mesh;
  double proved = 0;  ///< input units: no point of this mesh or of the full one is farther than this from the other
};

/// The files of `count` levels at `path`, the finest first: a GLB holds all, else "out.ply", "out.1.ply", "out.2.ply".
std::vector<std::string> level_files(const std::string& path, size_t count);

/// Writes levels, the finest first, into level_files(). All of them are written, or none. Throws as write_mesh() does.
WriteReport write_levels(const std::string& path, const std::vector<DetailLevel>& levels, const WriteOptions& options,
                         const Context& context);

}  // namespace soapfilm
