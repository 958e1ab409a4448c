#include "soapfilm/io/meshes/face_normals.h"

#include <utility>

#include "soapfilm/core/vec.h"

namespace soapfilm::io {

FaceNormals::FaceNormals(const std::vector<Vec3d>& positions) : positions_(positions), sums_(positions.size()) {
  Box3d box;
  for (const Vec3d& p : positions)
    if (is_finite(p)) box.extend(p);
  const double diagonal = box.diagonal();
  if (diagonal > 0 && std::isfinite(1 / diagonal)) scale_ = 1 / diagonal;
}

void FaceNormals::add(std::span<const uint32_t> corners) {
  if (corners.size() < 3) return;
  const Vec3d& first = positions_[corners[0]];
  Vec3d normal{};
  Vec3d last = scale_ * (positions_[corners[1]] - first);
  for (const uint32_t corner : corners.subspan(2)) {
    const Vec3d next = scale_ * (positions_[corner] - first);
    normal += cross(last, next);
    last = next;
  }
  if (!is_finite(normal)) return;
  for (const uint32_t corner : corners) sums_[corner] += static_cast<Vec3f>(normal);
}

std::vector<Vec3f> FaceNormals::finish() {
  for (Vec3f& sum : sums_) sum = static_cast<Vec3f>(normalized(static_cast<Vec3d>(sum)));
  return std::move(sums_);
}

}  // namespace soapfilm::io
