#include "soapfilm/io/meshes/face_normals.h"

#include <algorithm>
#include <utility>

#include "soapfilm/core/random.h"
#include "soapfilm/core/vec.h"

namespace soapfilm::io {

namespace {

/// A number of an edge, minus that of the same edge in the other direction.
uint64_t number_of_edge(uint32_t from, uint32_t to) {
  Random mixed(uint64_t{std::min(from, to)} << 32 | std::max(from, to));
  const uint64_t number = mixed.next();
  return from < to ? number : from > to ? 0 - number : 0;
}

}  // namespace

FaceNormals::FaceNormals(const std::vector<Vec3d>& positions) : positions_(positions), sums_(positions.size()) {
  Box3d box;
  for (const Vec3d& p : positions)
    if (is_finite(p)) box.extend(p);
  const double diagonal = box.diagonal();
  if (diagonal > 0 && std::isfinite(1 / diagonal)) scale_ = 1 / diagonal;
}

void FaceNormals::add(std::span<const uint32_t> corners) {
  if (corners.size() < 3) return;
  ++faces_;
  for (size_t k = 0; k < corners.size(); ++k) edges_ += number_of_edge(corners[k], corners[(k + 1) % corners.size()]);
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
