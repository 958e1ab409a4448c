// A mesh in several files: blocks of space, and an index of them.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "soapfilm/io.h"

namespace soapfilm {

struct PartsParams {
  size_t triangles = 20'000'000;    ///< of a part at most; > 0
  std::string coordinate_system{};  ///< of the mesh, for the index: WKT or EPSG:NUMBER; empty: not known
  std::string unit{};               ///< of its coordinates, for the index; empty: not known
};

struct WrittenPart {
  std::string file;
  size_t triangles = 0;
  size_t vertices = 0;
  Box3d box;  ///< of the coordinates as they are written
};

struct WrittenParts {
  std::string index;  ///< the file
  std::vector<WrittenPart> parts;
  WriteReport report;
};

/// Of the mesh "city.ply": "city.part_001.ply" and so on, of more digits where there are more parts.
std::string part_file(const std::string& path, size_t number, size_t count);
/// Of the mesh "city.ply": "city.parts.json".
std::string parts_index(const std::string& path);
/// Whether `file` has a name that part_file() gives to some part of the mesh `path`, in the same folder.
bool is_part_file(const std::string& path, const std::string& file);
/// check_mesh_output() of the parts, as far as they are known before, and of the index. Throws OutputError for files of
/// closed surfaces too: they cannot hold a part.
void check_parts_output(const std::string& path);

/// Writes the mesh as parts of at most so many triangles (io/meshes/mesh_blocks.h says how it is cut) and their index
/// (docs/reference/formats.md). Vertices at the cuts are in all parts that have them, with equal coordinates, to the
/// bit, and equal normals, colors and attributes; coordinates are those that write_mesh() would write. All files are
/// written, or none: the index appears last. The same bytes for any number of threads. Throws as write_mesh() does.
WrittenParts write_parts(const std::string& path, const Mesh& mesh, const PartsParams& params,
                         const WriteOptions& options, const Context& context);

}  // namespace soapfilm
