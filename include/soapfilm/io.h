// Reading and writing files, by how they begin or by their extension (docs/reference/formats.md).
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "soapfilm/mesh.h"
#include "soapfilm/params.h"

namespace SOAPFILM_API soapfilm {

/// What reading one file found.
struct FileReport {
  std::string path;
  std::string format;                   ///< such as "PLY, binary little-endian"
  size_t samples = 0;                   ///< kept
  size_t dropped = 0;                   ///< because a coordinate was not finite
  size_t no_return = 0;                 ///< dropped rows or cells of rays that met nothing
  size_t ignored_normals = 0;           ///< normals with a non-finite part, set to zero (absent)
  std::vector<std::string> properties;  ///< names of what each sample carries in the file, used or not
};

struct ReadReport {
  std::vector<FileReport> files;      ///< of a scan set: one for each of its scans
  std::vector<std::string> warnings;  ///< one line each, naming the file

  size_t samples() const;
  size_t dropped() const;
};

/// What a file cannot say by itself.
struct ReadOptions {
  std::string columns;           ///< of text, such as "x,y,z,-,nx,ny,nz" ("-": skipped); empty: by header or values
  std::string trajectory;        ///< of LAS: a text file `time x y z`, the scanner's way; empty: none
  bool trust_viewpoint = false;  ///< of PCD, PTX, E57: a default or contradicted place is the scanner's, too
  std::vector<std::string> attributes{"all"};  ///< columns that are kept, by name, "color", or "all"
  double spacing = 0;  ///< of COPC: levels are read until points are this near, input units; 0: all
};

/// Reads a point cloud of one or several scans. Samples with a non-finite coordinate are dropped and counted. As many
/// scans of a set are read at once as there are threads; the text of a PLY is read by all threads. Throws InputError
/// for a file that cannot be read to its end, or holds no finite sample; MemoryError before large ones are read.
PointCloud read_points(const std::string& path, ReadReport* report = nullptr, const Context& context = Context(1),
                       const ReadOptions& options = {});

/// Several files at once, as further scans in order. Throws ParameterError for an option that none of them takes.
PointCloud read_points(const std::vector<std::string>& paths, ReadReport* report = nullptr,
                       const Context& context = Context(1), const ReadOptions& options = {});

/// Reads a triangle mesh; polygons become fans of triangles. Throws InputError for a file that cannot be read to its
/// end, has no faces, an index out of range or a non-finite coordinate. The report gets warnings alone.
Mesh read_mesh(const std::string& path, ReadReport* report = nullptr);

struct WriteOptions {
  bool ascii = false;                 ///< PLY and STL as text; OBJ always is
  double coordinate_precision = 0;    ///< rounding error allowed, input units; 0: 1e-3 mean edges of a mesh, else none
  std::vector<std::string> comments;  ///< lines for the head of a PLY or OBJ file
  double voxel = 0;                   ///< of .vdb: edge of a cell, input units; 0: the mesh's mean edge
  Axis up = Axis::z;                  ///< of .glb: what is upright; turned to glTF's y, and back by read_mesh()
};

struct WriteReport {
  std::string format;                 ///< such as "PLY, binary little-endian"
  bool double_coordinates = false;    ///< because float would have exceeded coordinate_precision
  std::vector<std::string> warnings;  ///< only for STL: the detail that its float coordinates lose
};

/// Writes a mesh: first under a temporary name in the same folder, then renamed, so the file is complete or absent.
/// Coordinates are float where that keeps `coordinate_precision`, otherwise double. The bytes are the same for any
/// number of threads. Throws ParameterError for an inconsistent mesh, OutputError for an unknown extension or an
/// unwritable file, Cancelled.
WriteReport write_mesh(const std::string& path, const Mesh& mesh, const WriteOptions& options = {},
                       const Context& context = Context(1));

/// The same for a cloud, with all its columns: normals, sensor positions, weights, colors, and each scan's name, sensor
/// position, view direction and range grid. read_points() gives the same cloud back.
WriteReport write_points(const std::string& path, const PointCloud& cloud, const WriteOptions& options = {},
                         const Context& context = Context(1));

}  // namespace soapfilm
