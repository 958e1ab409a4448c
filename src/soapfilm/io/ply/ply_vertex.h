// The meaning of the properties of a PLY's vertices; docs/reference/formats.md has the table.
#pragma once

#include <string>
#include <vector>

#include "soapfilm/cloud.h"
#include "soapfilm/io/ply/ply_rows.h"
#include "soapfilm/io/point_columns.h"
#include "soapfilm/io/point_stream.h"

namespace soapfilm::io {

struct PlyVertexLayout : PointColumns {
  bool whole_colors = false;  ///< of an integer type
  bool byte_colors = false;   ///< from 0 to 255 whatever their values
  bool splats = false;        ///< colors are those of splat_color

  bool has_color() const { return color.present() || splats; }
  bool has_number_colors() const { return color.present() && !byte_colors; }
  std::vector<std::string> names;  ///< of all properties, in the file's order
};

inline Vec3d read(const PlyRows& rows, const Triple& triple) {
  return {rows.scalar(triple[0]), rows.scalar(triple[1]), rows.scalar(triple[2])};
}

/// Adds the color of a vertex, if it has one: bytes as they are, others until their range is known.
void add_color(const PlyRows& rows, const PlyVertexLayout& layout, std::vector<Rgb8>& bytes, ColorNumbers& numbers);

/// Throws InputError when x, y or z is missing.
PlyVertexLayout find_vertex_layout(const PlyElement& vertex, const std::string& path);

/// The header's vertex element. Throws InputError when it is missing or has no rows.
const PlyElement& vertex_element(const PlyHeader& header, const std::string& path);

/// Throws InputError when the element has more rows than the caller's index type can address.
void check_count(const PlyElement& element, uint64_t most, const std::string& path);

}  // namespace soapfilm::io
