// Reading and writing files: the table of formats and the facade.
//
//   extension        read_points  read_mesh  write_points  write_mesh   file
//   .ply                  x           x           x             x       ply_points, ply_mesh
//   .xyz .txt .pts        x                                             xyz
//   .conf                 x                                             scan_set
//   .obj                              x                         x       obj
//   .off                              x                                 off
//   .stl                              x                         x       stl
//
// Extensions are compared without case; a file that begins like a PLY is read as one whatever it is called.
// docs/formats.md describes each format, property by property.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "soapfilm/core/context.h"
#include "soapfilm/core/mesh.h"
#include "soapfilm/core/point_cloud.h"

namespace soapfilm {

/// What reading one file found.
struct FileReport {
  std::string path;
  std::string format;                   ///< such as "PLY, binary little-endian"
  size_t samples = 0;                   ///< kept
  size_t dropped = 0;                   ///< dropped because a coordinate was not finite
  size_t ignored_normals = 0;           ///< normals with a non-finite part, set to zero (absent)
  std::vector<std::string> properties;  ///< names of what each sample carries in the file, used or not
};

/// What reading a list of files found; a scan set has one entry for each of its scans.
struct ReadReport {
  std::vector<FileReport> files;
  std::vector<std::string> warnings;  ///< one line each, naming the file

  size_t samples() const;
  size_t dropped() const;
};

/// Reads a point cloud of one or several scans. Samples with a non-finite coordinate are dropped and counted.
/// The scans of a set are read as many at once as there are threads, the text of a PLY by all of them. Throws
/// InputError for a file that cannot be read to its end, holds no sample or no finite one.
PointCloud read_points(const std::string& path, ReadReport* report = nullptr, const Context& context = Context(1));

/// Reads several files, as many at once, and appends them in order as further scans.
PointCloud read_points(const std::vector<std::string>& paths, ReadReport* report = nullptr,
                       const Context& context = Context(1));

/// Reads a triangle mesh; polygons become fans of triangles. Throws InputError for a file that cannot be read to its
/// end, has no faces, an index out of range or a non-finite coordinate.
Mesh read_mesh(const std::string& path);

/// What `soapfilm info` takes a file for.
enum class FileKind { points, mesh };

/// By extension; a PLY is a mesh when it has faces. Throws InputError for an unknown extension.
FileKind file_kind(const std::string& path);

struct MeshWriteOptions {
  bool ascii = false;                 ///< PLY and STL as text; OBJ always is
  double coordinate_precision = 0;    ///< largest rounding error allowed, input units; 0: 1e-3 of the mean edge
  std::vector<std::string> comments;  ///< lines for the head of a PLY or OBJ file
};

/// What was written.
struct WriteReport {
  std::string format;                 ///< such as "PLY, binary little-endian"
  bool double_coordinates = false;    ///< float would have passed coordinate_precision
  std::vector<std::string> warnings;  ///< STL alone: the detail that its float coordinates lose
};

/// Writes a mesh by extension (.ply, .obj, .stl): first under a temporary name in the same folder, then renamed, so
/// the file is whole or absent. Coordinates are float where that keeps `coordinate_precision`, otherwise double.
/// The rows of a PLY are made on all threads; the bytes are the same for any number of them.
/// Throws ParameterError for an inconsistent mesh, OutputError for an unknown extension or an unwritable file,
/// Cancelled where `context` has a progress that was.
WriteReport write_mesh(const std::string& path, const Mesh& mesh, const MeshWriteOptions& options = {},
                       const Context& context = Context(1));

struct PointWriteOptions {
  bool ascii = false;
  double coordinate_precision = 0;    ///< largest rounding error allowed, input units; 0: none
  std::vector<std::string> comments;  ///< lines for the head of the file
};

/// Writes a cloud (.ply) with all it has: normals, sensor positions, weights, colours, and each scan's name, sensor
/// position, viewing direction and range grid. read_points() gives the same cloud back. Throws as write_mesh().
WriteReport write_points(const std::string& path, const PointCloud& cloud, const PointWriteOptions& options = {},
                         const Context& context = Context(1));

/// Writes text, whole or not at all. Throws OutputError.
void write_text_file(const std::string& path, const std::string& text);

/// Refuse before a long run what could not be written after it: an unwritable place; for meshes an unknown extension
/// too. Throws OutputError; leaves no file.
void check_output(const std::string& path);
void check_mesh_output(const std::string& path);

/// Unlinks the temporary files of writes in progress, in any thread. Async-signal-safe; for the way out of a process.
void remove_temporary_files() noexcept;

}  // namespace soapfilm
