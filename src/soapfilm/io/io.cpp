// The table of formats and the facade of include/soapfilm/io.h.
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
#include "soapfilm/io.h"

#include <filesystem>

#include "soapfilm/error.h"
#include "soapfilm/io/files.h"
#include "soapfilm/io/obj.h"
#include "soapfilm/io/off.h"
#include "soapfilm/io/ply.h"
#include "soapfilm/io/ply_header.h"
#include "soapfilm/io/read_each.h"
#include "soapfilm/io/scan_set.h"
#include "soapfilm/io/stl.h"
#include "soapfilm/io/text.h"
#include "soapfilm/io/xyz.h"

namespace soapfilm {

namespace {

enum class Format { ply, xyz, scan_set, obj, off, stl, unknown };

std::string extension_of(const std::string& path) {
  return io::lower_case(std::filesystem::path(path).extension().string());
}

Format format_of(const std::string& extension) {
  if (extension == ".ply") return Format::ply;
  if (extension == ".xyz" || extension == ".txt" || extension == ".pts") return Format::xyz;
  if (extension == ".conf") return Format::scan_set;
  if (extension == ".obj") return Format::obj;
  if (extension == ".off") return Format::off;
  if (extension == ".stl") return Format::stl;
  return Format::unknown;
}

/// A PLY is recognized by its first line.
Format format_of(const io::ByteSource& source) {
  return io::looks_like_ply(source) ? Format::ply : format_of(extension_of(source.path()));
}

template <class Error>
[[noreturn]] void refuse_extension(const std::string& path, const char* supported) {
  throw Error(path + ": extension " + io::in_quotes(extension_of(path)) + ", must be " + supported);
}

constexpr const char* mesh_outputs = ".ply, .obj or .stl";

}  // namespace

size_t ReadReport::samples() const {
  size_t sum = 0;
  for (const FileReport& file : files) sum += file.samples;
  return sum;
}

size_t ReadReport::dropped() const {
  size_t sum = 0;
  for (const FileReport& file : files) sum += file.dropped;
  return sum;
}

PointCloud read_points(const std::string& path, ReadReport* report, const Context& context) {
  ReadReport unused;
  ReadReport& to = report != nullptr ? *report : unused;
  io::ByteSource source(path);
  switch (format_of(source)) {
    case Format::ply:
      return io::read_ply_points(source, to, context);
    case Format::xyz:
      return io::read_xyz(source, to);
    case Format::scan_set:
      return io::read_scan_set_points(source, to, context);
    default:
      refuse_extension<InputError>(path, ".ply, .xyz, .txt, .pts or .conf to be read as points");
  }
}

PointCloud read_points(const std::vector<std::string>& paths, ReadReport* report, const Context& context) {
  if (paths.empty()) throw ParameterError("0 input files, must be > 0");
  if (paths.size() == 1) return read_points(paths.front(), report, context);
  ReadReport unused;
  return io::read_each(paths.size(), report != nullptr ? *report : unused, context,
                       [&](size_t i, ReadReport& to) { return read_points(paths[i], &to, context); });
}

Mesh read_mesh(const std::string& path) {
  io::ByteSource source(path);
  switch (format_of(source)) {
    case Format::ply:
      return io::read_ply_mesh(source);
    case Format::obj:
      return io::read_obj(source);
    case Format::off:
      return io::read_off(source);
    case Format::stl:
      return io::read_stl(source);
    default:
      refuse_extension<InputError>(path, ".ply, .obj, .off or .stl to be read as a mesh");
  }
}

FileKind file_kind(const std::string& path) {
  io::ByteSource source(path);
  switch (format_of(source)) {
    case Format::ply:
      return io::ply_has_faces(source) ? FileKind::mesh : FileKind::points;
    case Format::xyz:
    case Format::scan_set:
      return FileKind::points;
    case Format::obj:
    case Format::off:
    case Format::stl:
      return FileKind::mesh;
    case Format::unknown:
      break;
  }
  refuse_extension<InputError>(path, ".ply, .xyz, .txt, .pts, .conf, .obj, .off or .stl");
}

WriteReport write_mesh(const std::string& path, const Mesh& mesh, const WriteOptions& options, const Context& context) {
  switch (format_of(extension_of(path))) {
    case Format::ply:
      return io::write_ply_mesh(path, mesh, options, context);
    case Format::obj:
      return io::write_obj(path, mesh, options);
    case Format::stl:
      return io::write_stl(path, mesh, options);
    default:
      refuse_extension<OutputError>(path, mesh_outputs);
  }
}

WriteReport write_points(const std::string& path, const PointCloud& cloud, const WriteOptions& options,
                         const Context& context) {
  if (format_of(extension_of(path)) != Format::ply) refuse_extension<OutputError>(path, ".ply");
  return io::write_ply_points(path, cloud, options, context);
}

void check_mesh_output(const std::string& path) {
  const Format format = format_of(extension_of(path));
  if (format != Format::ply && format != Format::obj && format != Format::stl)
    refuse_extension<OutputError>(path, mesh_outputs);
  check_output(path);
}

}  // namespace soapfilm
