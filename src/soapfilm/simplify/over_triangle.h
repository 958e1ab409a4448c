// The original as a sheet over a triangle: the quick proof that every point of the triangle is near it.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "soapfilm/simplify/edited_mesh.h"
#include "soapfilm/simplify/face_grid.h"

namespace soapfilm {

/// Follows the original from face to face as far as it lies over a triangle, seen along the triangle's normal. If all
/// these faces look the same way as the triangle, none of their edges over it is a border, and over the triangle all
/// are within the distance along the normal, then every point of the triangle has a point of the original within the
/// distance. For the number of faces over a point is the same everywhere: on the way from one point to another, each
/// edge that is crossed leaves one face and enters the next. At the face where the search begins it is at least one.
class OverTriangle {
 public:
  OverTriangle(const EditedMesh& now, const FaceGrid& grid) : now_(now), grid_(grid), slots_(64) {}

  /// "No" says nothing. `most`: raised to the largest distance that was accepted.
  bool proves(const std::array<Vec3d, 3>& corner, double distance, double& most);

 private:
  static constexpr uint32_t none = EditedMesh::none;

  /// In the triangle's plane, and the height over it.
  Vec3d seen(uint32_t vertex) const {
    const Vec3d p = now_.original[vertex] - origin_;
    return {dot(p, u_), dot(p, v_), dot(p, n_)};
  }
  bool find_begin(Vec3d middle, double distance);
  bool visit(uint32_t face, double distance, double& most);
  bool is_new(uint32_t face);
  void grow();

  const EditedMesh& now_;
  const FaceGrid& grid_;
  Vec3d origin_, u_, v_, n_;
  std::array<Vec3d, 3> inward_;  // of each side in the plane: x, y, and z the offset; lengths are one
  std::vector<uint32_t> pending_;
  std::vector<uint64_t> slots_;  // visited faces, by hash: the search's number and the face
  uint32_t search_ = 0;
  size_t visited_ = 0;
};

}  // namespace soapfilm
