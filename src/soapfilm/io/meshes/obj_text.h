// What readers of OBJ as a mesh and as a cloud share.
#pragma once

#include <optional>
#include <string_view>

#include "soapfilm/io/text/text.h"

namespace soapfilm::io {

/// A corner of a face, counted from 0.
struct ObjCorner {
  uint32_t vertex = 0;
  std::optional<uint32_t> normal;
};

/// "v", "v/vt", "v//vn" or "v/vt/vn", with indices from 1 up, or from -1 (the last one so far) down. Throws InputError
/// at the line that `cursor` read last.
ObjCorner parse_obj_corner(const TextCursor& cursor, std::string_view field, size_t vertices_so_far,
                           size_t normals_so_far);

}  // namespace soapfilm::io
