// What readers of OBJ as a mesh and as a cloud share.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "soapfilm/io/bytes/byte_source.h"
#include "soapfilm/io/text/text.h"

namespace soapfilm::io {

/// An OBJ file as plain lines of UTF-8: UTF-16 is converted, and a line that ends with '\\' goes on in the next one
/// (empty lines follow then, so that lines keep their numbers).
class ObjSource {
 public:
  explicit ObjSource(ByteSource& source);
  ByteSource& plain() { return plain_ ? *plain_ : source_; }

 private:
  ByteSource& source_;
  std::string text_;
  std::optional<ByteSource> plain_;  // of text_, if that differs from the file
};

/// A corner of a face, counted from 0.
struct ObjCorner {
  uint32_t vertex = 0;
  std::optional<uint32_t> normal;
};

/// "v", "v/vt", "v//vn" or "v/vt/vn" (vt and vn may be empty), with indices from 1 up, or from -1 (the last one so far)
/// down. Throws InputError at the line that `cursor` read last.
ObjCorner parse_obj_corner(const TextCursor& cursor, std::string_view field, size_t vertices_so_far,
                           size_t normals_so_far);

}  // namespace soapfilm::io
