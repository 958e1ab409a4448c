#pragma once

#include <cstdint>
#include <vector>

#include "soapfilm/mesh.h"

namespace soapfilm::io {

/// Appends a polygon as a fan of triangles around its first corner. `corner(i)` gives the vertex of corner i.
template <class Corner>
void append_fan(std::vector<Triangle>& triangles, size_t corners, const Corner& corner) {
  for (size_t i = 2; i < corners; ++i) triangles.push_back({corner(0), corner(i - 1), corner(i)});
}

}  // namespace soapfilm::io
