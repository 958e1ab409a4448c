// glTF has y up, scans have z up: files that are written here are turned, and say so, so that they can be turned back.
#pragma once

#include <array>
#include <cstddef>

#include "soapfilm/io/meshes/gltf_nodes.h"
#include "soapfilm/params.h"

namespace soapfilm::io {

/// The key in `asset.extras` whose value names the axis (names_of<Axis>) that was upright before y was.
inline constexpr const char* gltf_up_key = "soapfilm_up";

/// The turn that makes `up` glTF's y; whole numbers, so that turning there and back changes no bit.
inline GltfPlace turned_up(Axis up) {
  constexpr std::array<std::array<Vec3d, 3>, 6> images{{
      {{{0, 1, 0}, {-1, 0, 0}, {0, 0, 1}}},   // x
      {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}},    // y
      {{{1, 0, 0}, {0, 0, -1}, {0, 1, 0}}},   // z
      {{{0, -1, 0}, {1, 0, 0}, {0, 0, 1}}},   // -x
      {{{1, 0, 0}, {0, -1, 0}, {0, 0, -1}}},  // -y
      {{{1, 0, 0}, {0, 0, 1}, {0, -1, 0}}},   // -z
  }};
  GltfPlace place;
  for (size_t k = 0; k < 3; ++k) place.axis[k] = images[static_cast<size_t>(up)][k];
  return place;
}

/// The turn back: the transpose.
inline GltfPlace turned_back(Axis up) {
  const GltfPlace there = turned_up(up);
  GltfPlace back;
  for (int k = 0; k < 3; ++k) back.axis[k] = {there.axis[0][k], there.axis[1][k], there.axis[2][k]};
  return back;
}

}  // namespace soapfilm::io
