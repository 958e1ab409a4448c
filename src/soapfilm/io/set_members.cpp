#include "soapfilm/io/set_members.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "soapfilm/core/context_state.h"
#include "soapfilm/core/vec.h"
#include "soapfilm/error.h"
#include "soapfilm/io/formats.h"
#include "soapfilm/io/read_each.h"
#include "soapfilm/io/text.h"

namespace soapfilm::io {

namespace {

bool is_set(const std::string& file) {
  const std::string extension = lower_case(std::filesystem::path(file).extension().string());
  return extension == ".conf" || extension == ".mlp" || extension == ".aln";
}

/// Of each vertex the sum of its triangles' normals, times their area; zero where they cancel.
std::vector<Vec3f> member_normals(const Mesh& mesh) {
  std::vector<Vec3d> sums(mesh.vertices.size());
  for (const Triangle& t : mesh.triangles) {
    const Vec3d a = mesh.vertices[t[0]];
    const Vec3d area = cross(mesh.vertices[t[1]] - a, mesh.vertices[t[2]] - a);
    for (const uint32_t v : t) sums[v] += area;
  }
  std::vector<Vec3f> normals;
  normals.reserve(sums.size());
  for (const Vec3d& sum : sums) normals.push_back(static_cast<Vec3f>(normalized(sum)));
  return normals;
}

PointCloud member_vertices(const std::string& path, ReadReport& report) {
  Mesh mesh = read_mesh(path);
  PointCloud cloud;
  cloud.normals = mesh.normals.empty() ? member_normals(mesh) : std::move(mesh.normals);
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
  if (format != nullptr && format->read_points == nullptr && format->read_mesh != nullptr)
    return member_vertices(path, report);
  return read_points(path, &report, context, options);
}

}  // namespace

PointCloud read_members(const ByteSource& set, std::string_view keyword, const std::vector<SetMember>& members,
                        ReadReport& report, const ReadOptions& options, const Context& context) {
  // They would break the one line of a message.
  const auto is_control = [](char c) { return (c >= 0 && c < ' ') || c == '\x7f'; };
  for (const SetMember& member : members)
    if (std::any_of(member.file.begin(), member.file.end(), is_control))
      throw InputError(fmt::format("{}: {} names {}, must be a name without control characters", set.path(), keyword,
                                   in_quotes(member.file)));
  const std::filesystem::path folder = std::filesystem::path(set.path()).parent_path();
  const Context silent = silenced(context);
  return read_each(members.size(), report, context, [&](size_t i, ReadReport& to) {
    const SetMember& member = members[i];
    if (is_set(member.file))
      throw InputError(
          fmt::format("{}: {} names {}, must be a scan, not a scan set", set.path(), keyword, in_quotes(member.file)));
    PointCloud cloud;
    try {
      cloud = read_member((folder / member.file).string(), to, options, silent);
    } catch (const InputError& error) {  // the user named the set
      throw InputError(set.path() + ": " + error.what());
    }
    member.place(cloud);
    return cloud;
  });
}

}  // namespace soapfilm::io
