#include "soapfilm/io/ply/ply_vertex.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "soapfilm/error.h"

namespace soapfilm::io {

namespace {

/// Text may say more than a byte holds.
uint8_t byte_of(double value) { return value > 0 ? static_cast<uint8_t>(std::min(value, 255.0)) : uint8_t{0}; }

/// The color of a 3D Gaussian splat from all sides: the constant spherical harmonic, 1 / sqrt(4 pi) (Kerbl et al.
/// 2023).
uint8_t byte_of_splat(double coefficient) { return byte_of(255 * (0.5 + 0.28209479177387814 * coefficient) + 0.5); }

}  // namespace

void add_color(const PlyRows& rows, const PlyVertexLayout& layout, std::vector<Rgb8>& bytes, ColorNumbers& numbers) {
  if (layout.splats) {
    const Vec3d f = read(rows, layout.splat_color);
    return bytes.push_back({byte_of_splat(f.x), byte_of_splat(f.y), byte_of_splat(f.z)});
  }
  if (!layout.color.present()) return;
  const Vec3d color = read(rows, layout.color);
  if (layout.byte_colors)
    bytes.push_back({byte_of(color.x), byte_of(color.y), byte_of(color.z)});
  else
    numbers.add(color.x, color.y, color.z);
}

PlyVertexLayout find_vertex_layout(const PlyElement& vertex, const std::string& path) {
  PlyVertexLayout layout;
  std::vector<std::string> scalars;  // a list has no meaning here
  for (const PlyProperty& property : vertex.properties) {
    layout.names.push_back(property.name);
    scalars.push_back(property.is_list() ? std::string() : property.name);
  }
  static_cast<PointColumns&>(layout) = meaning_of(scalars);
  std::erase_if(layout.others, [&](size_t k) { return vertex.properties[k].is_list(); });
  if (!layout.position.present())
    throw InputError(fmt::format("{}:{}: element 'vertex' lacks a property, must have x, y and z", path, vertex.line));
  if (layout.color.present()) {
    const PlyType type = vertex.properties[layout.color[0]].type;
    layout.whole_colors = is_integer(type);
    layout.byte_colors = std::all_of(layout.color.index.begin(), layout.color.index.end(),
                                     [&](size_t k) { return vertex.properties[k].type == PlyType::uint8; });
  }
  layout.splats = layout.splat_color.present();
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
