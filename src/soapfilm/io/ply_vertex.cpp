#include "soapfilm/io/ply_vertex.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "soapfilm/error.h"

namespace soapfilm::io {

namespace {

PlyTriple find_triple(const PlyElement& vertex, std::string_view a, std::string_view b, std::string_view c) {
  return {{vertex.find_scalar(a), vertex.find_scalar(b), vertex.find_scalar(c)}};
}

/// Float colors run from 0 to 1, 16-bit ones to 65535, all others to 255.
double color_scale(PlyType type) {
  if (!is_integer(type)) return 255.0;
  return type == PlyType::uint16 ? 1.0 / 257.0 : 1.0;
}

}  // namespace

Rgb8 PlyVertexLayout::read_color(const PlyRows& rows) const {
  Rgb8 rgb{};
  for (size_t c = 0; c < 3; ++c) {
    const double value = rows.scalar(color.index[c]) * color_scale;
    rgb[c] = value > 0 ? static_cast<uint8_t>(std::min(std::lround(std::min(value, 255.0)), 255L)) : uint8_t{0};
  }
  return rgb;
}

PlyVertexLayout find_vertex_layout(const PlyElement& vertex, const std::string& path) {
  PlyVertexLayout layout;
  layout.position = find_triple(vertex, "x", "y", "z");
  if (!layout.position.present())
    throw InputError(fmt::format("{}:{}: element 'vertex' lacks a property, must have x, y and z", path, vertex.line));
  layout.normal = find_triple(vertex, "nx", "ny", "nz");
  layout.sensor = find_triple(vertex, "sensor_x", "sensor_y", "sensor_z");
  layout.color = find_triple(vertex, "red", "green", "blue");
  if (!layout.color.present()) layout.color = find_triple(vertex, "diffuse_red", "diffuse_green", "diffuse_blue");
  if (layout.color.present()) layout.color_scale = color_scale(vertex.properties[layout.color.index[0]].type);
  layout.weight = vertex.find_scalar("weight");

  std::vector<bool> used(vertex.properties.size(), false);
  for (const PlyTriple& triple : {layout.position, layout.normal, layout.sensor, layout.color})
    if (triple.present())
      for (const size_t k : triple.index) used[k] = true;
  if (layout.weight != PlyElement::absent) used[layout.weight] = true;
  for (size_t k = 0; k < vertex.properties.size(); ++k) {
    layout.names.push_back(vertex.properties[k].name);
    if (!used[k] && !vertex.properties[k].is_list()) layout.others.push_back(k);
  }
  return layout;
}

const PlyElement& vertex_element(const PlyHeader& header, const std::string& path) {
  const PlyElement* vertex = header.find("vertex");
  if (vertex == nullptr) throw InputError(path + ": the header has no element 'vertex'");
  if (vertex->count == 0)
    throw InputError(fmt::format("{}:{}: element 'vertex': count = 0, must be > 0", path, vertex->line));
  return *vertex;
}

void check_count(const PlyElement& element, uint64_t most, const std::string& path) {
  if (element.count > most)
    throw InputError(fmt::format("{}:{}: element {}: count = {}, must be at most {}", path, element.line,
                                 in_quotes(element.name), element.count, most));
}

}  // namespace soapfilm::io
