#include "soapfilm/io/formats.h"

#include <array>
#include <filesystem>
#include <vector>

#include "soapfilm/io/e57/e57.h"
#include "soapfilm/io/kitti.h"
#include "soapfilm/io/las/las.h"
#include "soapfilm/io/meshes/gltf.h"
#include "soapfilm/io/meshes/gltf_read.h"
#include "soapfilm/io/meshes/obj.h"
#include "soapfilm/io/meshes/off.h"
#include "soapfilm/io/meshes/stl.h"
#include "soapfilm/io/meshes/vdb.h"
#include "soapfilm/io/npy/npy.h"
#include "soapfilm/io/pcd/pcd.h"
#include "soapfilm/io/pcd/pcd_header.h"
#include "soapfilm/io/ply/ply.h"
#include "soapfilm/io/ply/ply_header.h"
#include "soapfilm/io/ptx.h"
#include "soapfilm/io/sets/meshlab.h"
#include "soapfilm/io/sets/scan_set.h"
#include "soapfilm/io/text/text.h"
#include "soapfilm/io/text/text_points.h"

namespace soapfilm::io {

namespace {

constexpr std::array<Format, 17> table{{
    {.extensions = ".ply",
     .begins = looks_like_ply,
     .has_faces = ply_has_faces,
     .stream_points = read_ply_points,
     .read_mesh = read_ply_mesh,
     .write_points = write_ply_points,
     .write_mesh = write_ply_mesh},
    {.extensions = ".xyz .txt .csv .asc .pts .xyzn .xyzrgb .pwn .npts",
     .uses = "columns",
     .stream_points = read_text_points},
    {.extensions = ".ptx", .uses = "trust_viewpoint", .begins = looks_like_ptx, .read_points = read_ptx},
    {.extensions = ".pcd", .uses = "trust_viewpoint", .begins = looks_like_pcd, .stream_points = read_pcd},
    {.extensions = ".las", .uses = "trajectory", .begins = looks_like_las, .stream_points = read_las},
    {.extensions = ".laz", .uses = "trajectory", .stream_points = read_las},  // the same, but its points are compressed
    {.extensions = ".e57", .uses = "trust_viewpoint", .begins = looks_like_e57, .stream_points = read_e57},
    {.extensions = ".bin", .stream_points = read_kitti},
    {.extensions = ".npy", .begins = looks_like_npy, .stream_points = read_npy},
    {.extensions = ".conf", .uses = "all", .members = scan_set_members, .read_points = read_scan_set_points},
    {.extensions = ".mlp", .uses = "all", .members = mlp_members, .read_points = read_mlp},
    {.extensions = ".aln", .uses = "all", .members = aln_members, .read_points = read_aln},
    {.extensions = ".obj",
     .has_faces = obj_has_faces,
     .read_points = read_obj_points,
     .read_mesh = read_obj,
     .write_mesh = write_obj},
    {.extensions = ".off",
     .has_faces = off_has_faces,
     .read_points = read_off_points,
     .read_mesh = read_off,
     .write_mesh = write_off},
    {.extensions = ".glb",
     .begins = looks_like_glb,
     .has_faces = glb_has_faces,
     .read_points = read_glb_points,
     .read_mesh = read_glb_mesh,
     .write_mesh = write_glb},
    {.extensions = ".vdb", .write_mesh = write_vdb},
    {.extensions = ".stl", .read_mesh = read_stl, .write_mesh = write_stl},
}};

std::vector<std::string> split(std::string_view extensions) {
  std::vector<std::string> all;
  for (size_t begin = 0; begin < extensions.size();) {
    const size_t end = std::min(extensions.find(' ', begin), extensions.size());
    all.emplace_back(extensions.substr(begin, end - begin));
    begin = end + 1;
  }
  return all;
}

std::vector<std::string> all_extensions(bool (*can)(const Format& format)) {
  std::vector<std::string> all;
  for (const Format& format : table)
    if (can(format))
      for (std::string& one : split(format.extensions)) all.push_back(std::move(one));
  return all;
}

}  // namespace

const Format* format_of_extension(const std::string& path) {
  const std::string extension = lower_case(std::filesystem::path(path).extension().string());
  for (const Format& format : table)
    for (const std::string& one : split(format.extensions))
      if (one == extension) return &format;
  return nullptr;
}

const Format* format_of(const ByteSource& source) {
  for (const Format& format : table)
    if (format.begins && format.begins(source)) return &format;
  return format_of_extension(source.path());
}

std::vector<std::string> read_extensions() {
  return all_extensions([](const Format& format) -> bool { return format.reads_points() || format.read_mesh; });
}

std::vector<std::string> readers() {
  std::vector<std::string> first;
  for (const Format& format : table)
    if (format.reads_points() || format.read_mesh) first.push_back(split(format.extensions).front());
  return first;
}

std::string extensions_of(bool (*can)(const Format& format)) {
  const std::vector<std::string> all = all_extensions(can);
  std::string list;
  for (size_t i = 0; i < all.size(); ++i) list += (i == 0 ? "" : i + 1 < all.size() ? ", " : " or ") + all[i];
  return list;
}

}  // namespace soapfilm::io
