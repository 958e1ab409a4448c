// Normals of samples that are the vertices of faces.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "soapfilm/vec.h"

namespace soapfilm::io {

/// Sums the faces' normals, weighted by area, at their corners. Faces are counter-clockwise seen from outside.
class FaceNormals {
 public:
  /// `positions` must stay as they are until finish().
  explicit FaceNormals(const std::vector<Vec3d>& positions);

  /// A polygon; of fewer than three corners, or with a corner that is not finite, it has no normal.
  void add(std::span<const uint32_t> corners);

  /// Unit normals; zero, that is none, where no face was.
  std::vector<Vec3f> finish();

 private:
  const std::vector<Vec3d>& positions_;
  double scale_ = 1;  // makes all areas less than 1
  std::vector<Vec3f> sums_;
};

}  // namespace soapfilm::io
