// The nodes of a glTF scene that show a mesh, and where they put it.
#pragma once

#include <vector>

#include "soapfilm/core/vec.h"
#include "soapfilm/io/meshes/glb_file.h"

namespace soapfilm::io {

/// world = x axis[0] + y axis[1] + z axis[2] + shift.
struct GltfPlace {
  Vec3d axis[3]{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  Vec3d shift{};

  Vec3d vector(const Vec3d& v) const { return v.x * axis[0] + v.y * axis[1] + v.z * axis[2]; }
  Vec3d point(const Vec3d& p) const { return vector(p) + shift; }
  /// A normal of unit length, by the inverse transpose; zero stays zero.
  Vec3d normal(const Vec3d& n) const;
  bool mirrors() const { return dot(axis[0], cross(axis[1], axis[2])) < 0; }
  /// Places what `inner` has placed.
  GltfPlace after(const GltfPlace& inner) const;

  bool operator==(const GltfPlace& other) const {
    return axis[0] == other.axis[0] && axis[1] == other.axis[1] && axis[2] == other.axis[2] && shift == other.shift;
  }
};

struct GltfNode {
  uint64_t mesh = 0;
  GltfPlace place;
};

/// Of the default scene, or the first; without scenes of all nodes that are no other's child; without nodes of all
/// meshes. Throws InputError for nodes in circles, and for numbers that are not finite.
/// A turn of a file that was written here is taken back: gltf_up.h.
std::vector<GltfNode> gltf_nodes(const GlbFile& file);

}  // namespace soapfilm::io
