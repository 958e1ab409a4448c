#include "soapfilm/io/sets/set_members.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "soapfilm/core/context_state.h"
#include "soapfilm/core/printable.h"
#include "soapfilm/error.h"
#include "soapfilm/io/formats.h"
#include "soapfilm/io/meshes/face_normals.h"
#include "soapfilm/io/sets/read_each.h"
#include "soapfilm/io/sets/shared_reading.h"
#include "soapfilm/io/text/text.h"

namespace soapfilm::io {

namespace {

bool is_set(const std::string& file) {
  const Format* format = format_of_extension(file);
  return format != nullptr && format->names_files();
}

std::vector<Vec3f> normals_of_faces(const Mesh& mesh) {
  FaceNormals normals(mesh.vertices);
  for (const Triangle& triangle : mesh.triangles) normals.add(triangle);
  return normals.finish();
}

PointCloud member_vertices(const std::string& path, ReadReport& report) {
  Mesh mesh = read_mesh(path, &report);
  PointCloud cloud;
  cloud.normals = mesh.normals.empty() ? normals_of_faces(mesh) : std::move(mesh.normals);
  cloud.positions = std::move(mesh.vertices);
  cloud.colors = std::move(mesh.colors);
  cloud.columns = std::move(mesh.attributes);
  cloud.scans.resize(1);
  cloud.scans[0].name = std::filesystem::path(path).stem().string();
  cloud.scans[0].end = cloud.size();
  FileReport file;
  file.path = path;
  file.format = "mesh";
  file.samples = cloud.size();
  file.properties = {"vertices", "normals"};
  report.files.push_back(std::move(file));
  return cloud;
}

PointCloud read_member(const std::string& path, ReadReport& report, const ReadOptions& options,
                       const Context& context) {
  const Format* format = format_of(ByteSource(path));
  if (format != nullptr && !format->reads_points() && format->read_mesh != nullptr)
    return member_vertices(path, report);
  return read_points(path, &report, context, options);
}

}  // namespace

std::vector<std::string> member_paths(const ByteSource& set, const std::vector<SetMember>& members) {
  const std::filesystem::path folder = std::filesystem::path(set.path()).parent_path();
  std::vector<std::string> paths;
  for (const SetMember& member : members) paths.push_back((folder / member.file).string());
  return paths;
}

PointCloud read_members(const ByteSource& set, std::string_view keyword, const std::vector<SetMember>& members,
                        ReadReport& report, const ReadOptions& options, const Context& context) {
  // They would break the one line of a message.
  for (const SetMember& member : members)
    if (std::any_of(member.file.begin(), member.file.end(), is_control))
      throw InputError(fmt::format("{}: {} names {}, must be a name without control characters", set.path(), keyword,
                                   in_quotes(member.file)));
  const std::vector<std::string> paths = member_paths(set, members);
  const std::vector<uint64_t> file_bytes = agreed_file_bytes(paths, options, context);
  const Context silent = silenced(context);
  return read_each(file_bytes, report, context, [&](size_t i, ReadReport& to) {
    const SetMember& member = members[i];
    if (is_set(member.file))
      throw InputError(
          fmt::format("{}: {} names {}, must be a scan, not a scan set", set.path(), keyword, in_quotes(member.file)));
    PointCloud cloud;
    try {
      cloud = read_member(paths[i], to, options, silent);
    } catch (const InputError& error) {  // the user named the set
      throw InputError(set.path() + ": " + error.what());
    }
    member.place(cloud);
    return cloud;
  });
}

}  // namespace soapfilm::io
