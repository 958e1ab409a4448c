// Is a triangle within a distance of the original? By proof.
#pragma once

#include <array>

#include "soapfilm/simplify/edited_mesh.h"
#include "soapfilm/simplify/face_grid.h"
#include "soapfilm/simplify/over_triangle.h"

namespace soapfilm {

class NearOriginal {
 public:
  NearOriginal(const EditedMesh& now, const FaceGrid& grid) : grid_(grid), over_(now, grid) {}

  /// Every point of it? Where the original is no sheet over the triangle (over_triangle.h), that is halved; parts about
  /// as long as the original's triangles are covered by those, one by one (cover.h). `most`: raised to the distance
  /// that is proved.
  bool holds(const std::array<Vec3d, 3>& corner, double distance, double& most);

 private:
  const FaceGrid& grid_;
  OverTriangle over_;
};

}  // namespace soapfilm
