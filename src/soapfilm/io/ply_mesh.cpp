#include <fmt/format.h>

#include "soapfilm/core/vec.h"
#include "soapfilm/error.h"
#include "soapfilm/io/ply.h"
#include "soapfilm/io/ply_rows.h"
#include "soapfilm/io/ply_vertex.h"
#include "soapfilm/io/polygon.h"

namespace soapfilm::io {

namespace {

/// The list of vertex indices, by either of its two names; `absent` if the element is not a face.
size_t index_list(const PlyElement& element) {
  if (element.name != "face" && element.name != "tristrips") return PlyElement::absent;
  const size_t plural = element.find_list("vertex_indices");
  return plural != PlyElement::absent ? plural : element.find_list("vertex_index");
}

void read_vertices(PlyRows& rows, const PlyElement& vertex, const PlyVertexLayout& layout, const std::string& path,
                   Mesh& mesh) {
  rows.begin(vertex);
  check_count(vertex, UINT32_MAX, path);  // triangles hold indices of 32 bits
  mesh.vertices.reserve(vertex.count);
  if (layout.normal.present()) mesh.normals.reserve(vertex.count);
  PlyColors colors(layout, vertex.count);
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
    colors.add(rows);
    for (size_t a = 0; a < extra.size(); ++a)
      mesh.attributes[a].values.push_back(static_cast<float>(rows.scalar(extra[a])));
  }
  mesh.colors = colors.finish();
}

uint32_t vertex_index(const PlyRows& rows, double value, uint64_t vertices) {
  if (!(value >= 0) || value >= static_cast<double>(vertices) || value != std::floor(value))
    rows.fail(fmt::format("vertex index = {}, must be an integer from 0 to {}", value, vertices - 1));
  return static_cast<uint32_t>(value);
}

void read_faces(PlyRows& rows, const PlyElement& face, size_t list, uint64_t vertices, Mesh& mesh) {
  rows.begin(face);
  mesh.triangles.reserve(mesh.triangles.size() + face.count);
  for (uint64_t i = 0; i < face.count; ++i) {
    rows.next();
    const std::span<const double> corners = rows.list(list);
    if (corners.size() < 3) rows.fail(fmt::format("{} vertices, must be at least 3", corners.size()));
    append_fan(mesh.triangles, corners.size(), [&](size_t c) { return vertex_index(rows, corners[c], vertices); });
  }
}

/// Strips as in Stanford's volumetric merges: -1 begins a new strip, every second triangle has the opposite
/// orientation.
void read_strips(PlyRows& rows, const PlyElement& strips, size_t list, uint64_t vertices, Mesh& mesh) {
  rows.begin(strips);
  for (uint64_t i = 0; i < strips.count; ++i) {
    rows.next();
    Triangle last{};
    size_t length = 0;
    for (const double value : rows.list(list)) {
      if (value == -1) {
        length = 0;
        continue;
      }
      last = {last[1], last[2], vertex_index(rows, value, vertices)};
      ++length;
      if (length < 3) continue;
      mesh.triangles.push_back(length % 2 == 1 ? last : Triangle{last[1], last[0], last[2]});
    }
  }
}

}  // namespace

bool ply_has_faces(ByteSource& source) {
  for (const PlyElement& element : read_ply_header(source).elements)
    if (element.count > 0 && index_list(element) != PlyElement::absent) return true;
  return false;
}

Mesh read_ply_mesh(ByteSource& source) {
  const PlyHeader header = read_ply_header(source);
  const PlyElement& vertex = vertex_element(header, source.path());
  const PlyVertexLayout layout = find_vertex_layout(vertex, source.path());
  Mesh mesh;
  PlyRows rows(source, header);
  for (const PlyElement& element : header.elements) {
    const size_t list = index_list(element);
    if (element.name == "vertex")
      read_vertices(rows, element, layout, source.path(), mesh);
    else if (list == PlyElement::absent)
      rows.skip(element);
    else if (element.name == "face")
      read_faces(rows, element, list, vertex.count, mesh);
    else
      read_strips(rows, element, list, vertex.count, mesh);
  }
  rows.finish();
  if (mesh.triangles.empty()) throw InputError(source.path() + ": holds no faces, must be a mesh");
  return mesh;
}

}  // namespace soapfilm::io
