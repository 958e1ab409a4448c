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

  /// Whether each edge was passed in one direction as often as in the other, as in a closed surface. (By a sum over
  /// edges: another one can have that of a closed one by chance, once in 2^64.)
  bool closed() const { return faces_ > 0 && edges_ == 0; }

  /// Unit normals; zero, that is none, where no face was.
  std::vector<Vec3f> finish();

 private:
  const std::vector<Vec3d>& positions_;
  double scale_ = 1;  // makes all areas less than 1
  std::vector<Vec3f> sums_;
  uint64_t edges_ = 0, faces_ = 0;
};

}  // namespace soapfilm::io
