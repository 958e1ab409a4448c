// The table of file formats: one row each. Reading, writing, error messages and help pages follow from it.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "soapfilm/io.h"
#include "soapfilm/io/bytes/atomic_file.h"
#include "soapfilm/io/bytes/byte_source.h"
#include "soapfilm/io/point_stream.h"
#include "soapfilm/io/sets/set_members.h"

namespace soapfilm::io {

/// What a format can do; null where it cannot.
struct Format {
  std::string_view extensions;  ///< with dots, separated by spaces; compared without case
  std::string_view uses{};      ///< fields of ReadOptions, or "all"
  std::vector<SetMember> (*members)(ByteSource& source, ReadReport& report) = nullptr;  ///< of a file that names others
  bool (*begins)(const ByteSource& source) = nullptr;  ///< is a file of any name known by how it begins?
  bool (*has_faces)(ByteSource& source) = nullptr;     ///< of a format of clouds and meshes, which is it?
  /// In blocks, without all of the file in memory, as far as a file does not say at its end what its samples are.
  void (*stream_points)(ByteSource& source, PointSink& sink, ReadReport& report, const ReadOptions& options,
                        const Context& context) = nullptr;
  /// Instead, of a format that can only be read whole.
  PointCloud (*read_points)(ByteSource& source, ReadReport& report, const ReadOptions& options,
                            const Context& context) = nullptr;
  Mesh (*read_mesh)(ByteSource& source, ReadReport& report) = nullptr;
  WriteReport (*write_points)(AtomicFile& file, const PointCloud& cloud, const WriteOptions& options,
                              const Context& context) = nullptr;
  WriteReport (*write_mesh)(AtomicFile& file, const Mesh& mesh, const WriteOptions& options,
                            const Context& context) = nullptr;

  bool reads_points() const { return stream_points || read_points; }
  bool takes(std::string_view option) const { return uses == option || uses == "all"; }
  bool names_files() const { return members != nullptr; }
};

/// Null where there is none.
const Format* format_of_extension(const std::string& path);
/// What writes a mesh to a file of this name. Throws OutputError.
const Format& mesh_output_format(const std::string& path);
/// How a file begins counts before its extension.
const Format* format_of(const ByteSource& source);

/// Such as ".ply, .obj or .stl": all extensions of formats for which `can` holds, in the table's order.
std::string extensions_of(bool (*can)(const Format& format));
/// Extensions of all formats that can be read, as a cloud or as a mesh.
std::vector<std::string> read_extensions();
/// The first one of each reader.
std::vector<std::string> readers();

}  // namespace soapfilm::io

namespace soapfilm {

/// Hands the samples of a file over, in blocks. Errors and report are those of read_points().
void stream_points(io::ByteSource& source, io::PointSink& sink, ReadReport& report, const ReadOptions& options,
                   const Context& context);
/// The same of a file, or of those in a folder, one after the other.
void stream_points(const std::string& path, io::PointSink& sink, ReadReport& report, const ReadOptions& options,
                   const Context& context);

/// read_points() and read_mesh() of io.h once the file is open.
PointCloud read_points(io::ByteSource& source, ReadReport& report, const ReadOptions& options, const Context& context);
Mesh read_mesh(io::ByteSource& source, ReadReport& report);

}  // namespace soapfilm
