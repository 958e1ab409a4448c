// The meaning of the properties of a PLY's vertices; docs/reference/formats.md has the table.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "soapfilm/cloud.h"
#include "soapfilm/io/ply_rows.h"

namespace soapfilm::io {

/// Three scalar properties that belong together; used only if all exist.
struct PlyTriple {
  std::array<size_t, 3> index{PlyElement::absent, PlyElement::absent, PlyElement::absent};

  bool present() const {
    return index[0] != PlyElement::absent && index[1] != PlyElement::absent && index[2] != PlyElement::absent;
  }
  Vec3d read(const PlyRows& rows) const {
    return {rows.scalar(index[0]), rows.scalar(index[1]), rows.scalar(index[2])};
  }
};

struct PlyVertexLayout {
  PlyTriple position;
  PlyTriple normal;
  PlyTriple sensor;
  PlyTriple color;
  size_t weight = PlyElement::absent;
  double color_scale = 1;          ///< maps a stored color to 0 .. 255
  std::vector<size_t> others;      ///< scalar properties without a known meaning
  std::vector<std::string> names;  ///< of all properties, in the file's order

  Rgb8 read_color(const PlyRows& rows) const;
};

/// Throws InputError when x, y or z is missing.
PlyVertexLayout find_vertex_layout(const PlyElement& vertex, const std::string& path);

/// The header's vertex element. Throws InputError when it is missing or has no rows.
const PlyElement& vertex_element(const PlyHeader& header, const std::string& path);

/// Throws InputError when the element has more rows than the caller's index type can address.
void check_count(const PlyElement& element, uint64_t most, const std::string& path);

}  // namespace soapfilm::io
