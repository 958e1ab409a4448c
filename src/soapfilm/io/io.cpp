// The facade of include/soapfilm/io.h: finds the row of the table of formats.
#include "soapfilm/io.h"

#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <system_error>

#include "soapfilm/core/context_state.h"
#include "soapfilm/error.h"
#include "soapfilm/io/files.h"
#include "soapfilm/io/formats.h"
#include "soapfilm/io/sets/input_files.h"
#include "soapfilm/io/sets/read_each.h"
#include "soapfilm/io/sets/shared_reading.h"
#include "soapfilm/io/text/text.h"
#include "soapfilm/platform/scratch.h"

namespace soapfilm {

namespace {

using io::Format;

/// `format`, if it can; else throws Error. `purpose` ends the message.
template <class Error>
const Format& require(const std::string& path, const Format* format, bool (*can)(const Format& format),
                      const char* purpose) {
  if (format && can(*format)) return *format;
  throw Error(path + ": extension " + io::in_quotes(io::lower_case(std::filesystem::path(path).extension().string())) +
              ", must be " + io::extensions_of(can) + purpose);
}

bool reads_points(const Format& format) { return format.reads_points(); }
bool reads_meshes(const Format& format) { return format.read_mesh; }
bool writes_points(const Format& format) { return format.write_points; }
bool writes_meshes(const Format& format) { return format.write_mesh; }

}  // namespace

std::string point_extensions() { return io::extensions_of(reads_points); }
std::string mesh_extensions() { return io::extensions_of(reads_meshes); }
std::string mesh_output_extensions() { return io::extensions_of(writes_meshes); }

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

void stream_points(io::ByteSource& source, io::PointSink& sink, ReadReport& report, const ReadOptions& options,
                   const Context& context) {
  const Format& format =
      require<InputError>(source.path(), io::format_of(source), reads_points, " to be read as points");
  source.report_to(context.progress());
  if (format.stream_points) return format.stream_points(source, sink, report, options, context);
  PointCloud cloud = format.read_points(source, report, options, context);
  io::keep_attributes(options.attributes, cloud);
  io::hand_over(std::move(cloud), source.path(), sink);
}

PointCloud read_points(io::ByteSource& source, ReadReport& report, const ReadOptions& options, const Context& context) {
  io::CloudSink sink;
  stream_points(source, sink, report, options, context);
  return std::move(sink.cloud());
}

PointCloud read_points(const std::string& path, ReadReport* report, const Context& context,
                       const ReadOptions& options) {
  if (io::is_folder_or_pattern(path)) return read_points(std::vector{path}, report, context, options);
  ReadReport unused;
  io::ByteSource source(path);
  return read_points(source, report != nullptr ? *report : unused, options, context);
}

namespace {

/// An option that no file has a use for is an error.
void refuse_unused(const std::vector<std::string>& paths, const ReadOptions& options) {
  const auto require_use = [&](const char* name, bool given) {
    const auto uses = [&](const std::string& path) {
      const Format* format = io::format_of(io::ByteSource(path));
      return !format || format->takes(name);
    };
    if (given && std::none_of(paths.begin(), paths.end(), uses))
      throw ParameterError(fmt::format("{}: none of the input files takes it, such as {}", name, paths.front()));
  };
  require_use("columns", !options.columns.empty());
  require_use("trajectory", !options.trajectory.empty());
  require_use("trust_viewpoint", options.trust_viewpoint);
}

}  // namespace

PointCloud read_points(const std::vector<std::string>& given, ReadReport* report, const Context& context,
                       const ReadOptions& options) {
  if (given.empty()) throw ParameterError("0 input files, must be > 0");
  ReadReport unused;
  ReadReport& to_all = report != nullptr ? *report : unused;
  const std::vector<std::string> paths = io::input_files(given, to_all.warnings);
  refuse_unused(paths, options);
  const std::vector<uint64_t> file_bytes = io::agreed_file_bytes(paths, options, context);
  if (paths.size() == 1) return read_points(paths.front(), report, context, options);
  const Context silent = silenced(context);
  return io::read_each(file_bytes, to_all, context,
                       [&](size_t i, ReadReport& to) { return read_points(paths[i], &to, silent, options); });
}

void stream_points(const std::string& given, io::PointSink& sink, ReadReport& report, const ReadOptions& options,
                   const Context& context) {
  std::vector<std::string> paths{given};
  if (io::is_folder_or_pattern(given)) {
    paths = io::input_files(paths, report.warnings);
    refuse_unused(paths, options);
  }
  for (const std::string& path : paths) {
    io::ByteSource source(path);
    stream_points(source, sink, report, options, context);
  }
}

Mesh read_mesh(io::ByteSource& source, ReadReport& report) {
  const Format& format =
      require<InputError>(source.path(), io::format_of(source), reads_meshes, " to be read as a mesh");
  return format.read_mesh(source, report);
}

Mesh read_mesh(const std::string& path, ReadReport* report) {
  ReadReport unused;
  io::ByteSource source(path);
  return read_mesh(source, report != nullptr ? *report : unused);
}

FileKind file_kind(const std::string& path) {
  if (std::error_code error; std::filesystem::is_directory(path, error)) return FileKind::points;
  io::ByteSource source(path);
  const Format& format = require<InputError>(
      path, io::format_of(source), [](const Format& f) -> bool { return f.reads_points() || f.read_mesh; }, "");
  const bool is_mesh = format.has_faces ? format.has_faces(source) : format.read_mesh != nullptr;
  return is_mesh ? FileKind::mesh : FileKind::points;
}

const Format& io::mesh_output_format(const std::string& path) {
  return require<OutputError>(path, format_of_extension(path), writes_meshes, "");
}

namespace {

/// A file whose contents write(file) gives.
template <class Write>
WriteReport write_whole(const std::string& path, const Context& context, Write&& write) {
  io::AtomicFile file(path, ranks_of(context));
  WriteReport report = write(file);
  file.commit();
  return report;
}

}  // namespace

WriteReport write_mesh(const std::string& path, const Mesh& mesh, const WriteOptions& options, const Context& context) {
  const Format& format = io::mesh_output_format(path);
  return write_whole(path, context, [&](io::AtomicFile& file) {
    WriteReport report = format.write_mesh(file, mesh, options, context);
    check_scratch_files(context.state().scratch_folder);
    return report;
  });
}

WriteReport write_points(const std::string& path, const PointCloud& cloud, const WriteOptions& options,
                         const Context& context) {
  const Format& format = require<OutputError>(path, io::format_of_extension(path), writes_points, "");
  return write_whole(path, context,
                     [&](io::AtomicFile& file) { return format.write_points(file, cloud, options, context); });
}

void check_mesh_output(const std::string& path) {
  io::mesh_output_format(path);
  check_output(path);
}

}  // namespace soapfilm
