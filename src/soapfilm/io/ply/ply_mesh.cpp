#include <fmt/format.h>

#include "soapfilm/core/indices.h"
#include "soapfilm/core/vec.h"
#include "soapfilm/error.h"
#include "soapfilm/io/meshes/polygon.h"
#include "soapfilm/io/ply/ply.h"
#include "soapfilm/io/ply/ply_faces.h"
#include "soapfilm/io/ply/ply_rows.h"
#include "soapfilm/io/ply/ply_vertex.h"

namespace soapfilm::io {

namespace {

void read_vertices(PlyRows& rows, const PlyElement& vertex, const PlyVertexLayout& layout, const std::string& path,
                   Mesh& mesh) {
  rows.begin(vertex);
  check_count(vertex, most_indices, path);
  mesh.vertices.reserve(vertex.count);
  if (layout.normal.present()) mesh.normals.reserve(vertex.count);
  ColorNumbers numbers;
  if (layout.has_number_colors()) numbers.reserve(vertex.count);
  if (layout.has_color() && !layout.has_number_colors()) mesh.colors.reserve(vertex.count);
  std::vector<size_t> extra = layout.others;
  if (layout.weight != Triple::absent) extra.push_back(layout.weight);
  for (const size_t k : extra) {
    mesh.attributes.push_back({vertex.properties[k].name, {}});
    mesh.attributes.back().values.reserve(vertex.count);
  }
  for (uint64_t i = 0; i < vertex.count; ++i) {
    rows.next();
    const Vec3d position = read(rows, layout.position);
    if (!is_finite(position))
      rows.fail(fmt::format("position = ({}, {}, {}), must be finite", position.x, position.y, position.z));
    mesh.vertices.push_back(position);
    if (layout.normal.present()) mesh.normals.push_back(static_cast<Vec3f>(read(rows, layout.normal)));
    add_color(rows, layout, mesh.colors, numbers);
    for (size_t a = 0; a < extra.size(); ++a)
      mesh.attributes[a].values.push_back(static_cast<float>(rows.scalar(extra[a])));
  }
  if (layout.has_number_colors()) mesh.colors = numbers.bytes(layout.whole_colors);
}

void read_faces(PlyRows& rows, const PlyElement& element, size_t list, uint64_t vertices, Mesh& mesh) {
  bool reserved = false;
  read_ply_faces(rows, element, list, vertices, [&](std::span<const uint32_t> corners) {
    if (!reserved && element.name == "face") mesh.triangles.reserve(mesh.triangles.size() + element.count);
    reserved = true;
    if (corners.size() < 3) rows.fail(fmt::format("{} vertices, must be at least 3", corners.size()));
    append_fan(mesh.triangles, corners.size(), [&](size_t c) { return corners[c]; });
  });
}

}  // namespace

bool ply_has_faces(ByteSource& source) {
  for (const PlyElement& element : read_ply_header(source).elements)
    if (element.count > 0 && index_list(element) != PlyElement::absent) return true;
  return false;
}

Mesh read_ply_mesh(ByteSource& source, ReadReport& report) {
  const PlyHeader header = read_ply_header(source);
  const PlyElement& vertex = vertex_element(header, source.path());
  const PlyVertexLayout layout = find_vertex_layout(vertex, source.path());
  warn_of_stray_lines(header, source.path(), report);
  warn_of_color_parts(layout, source.path(), report.warnings);
  Mesh mesh;
  PlyRows rows(source, header);
  for (const PlyElement& element : header.elements) {
    const size_t list = index_list(element);
    if (element.name == "vertex")
      read_vertices(rows, element, layout, source.path(), mesh);
    else if (list == PlyElement::absent)
      rows.skip(element);
    else
      read_faces(rows, element, list, vertex.count, mesh);
  }
  rows.finish(vertex, report);
  if (mesh.triangles.empty()) throw InputError(source.path() + ": holds no faces, must be a mesh");
  return mesh;
}

}  // namespace soapfilm::io
