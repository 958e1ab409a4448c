#include "soapfilm/simplify/over_triangle.h"

#include <algorithm>
#include <cmath>

namespace soapfilm {

namespace {

constexpr double margin = 1e-9;  // units: what is this near a side counts as over the triangle

double doubled_area(Vec3d a, Vec3d b, Vec3d c) { return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x); }

}  // namespace

bool OverTriangle::proves(const std::array<Vec3d, 3>& corner, double distance, double& most) {
  const Vec3d along = corner[1] - corner[0], normal = cross(along, corner[2] - corner[0]);
  const double area = norm(normal);
  if (!(area > 0)) return false;
  origin_ = corner[0];
  n_ = normal / area;
  u_ = normalized(along);
  v_ = cross(n_, u_);
  std::array<Vec3d, 3> flat;
  for (size_t k = 0; k < 3; ++k) flat[k] = {dot(corner[k] - origin_, u_), dot(corner[k] - origin_, v_), 0};
  for (size_t k = 0; k < 3; ++k) {
    const Vec3d side = flat[(k + 1) % 3] - flat[k];
    const double length = norm(side);
    inward_[k] = {-side.y / length, side.x / length, (side.y * flat[k].x - side.x * flat[k].y) / length};
  }
  ++search_;
  visited_ = 0;
  pending_.clear();
  double highest = 0;
  if (!find_begin((corner[0] + corner[1] + corner[2]) / 3.0, distance)) return false;
  while (!pending_.empty()) {
    const uint32_t face = pending_.back();
    pending_.pop_back();
    if (!visit(face, distance, highest)) return false;
  }
  most = std::max(most, highest);
  return true;
}

/// A face over the triangle's middle.
bool OverTriangle::find_begin(Vec3d middle, double distance) {
  const Vec3d m{dot(middle - origin_, u_), dot(middle - origin_, v_), 0};
  return grid_.any_near(middle, distance, [&](uint32_t f) {
    const Triangle& t = now_.was.corners(f);
    const std::array<Vec3d, 3> p{seen(t[0]), seen(t[1]), seen(t[2])};
    const double whole = doubled_area(p[0], p[1], p[2]);
    const double a = doubled_area(m, p[1], p[2]), b = doubled_area(p[0], m, p[2]), c = doubled_area(p[0], p[1], m);
    if (!(whole > 0) || a < 0 || b < 0 || c < 0) return false;
    if (std::abs(a * p[0].z + b * p[1].z + c * p[2].z) > distance * whole) return false;
    is_new(f);
    pending_.push_back(f);
    return true;
  });
}

bool OverTriangle::visit(uint32_t face, double distance, double& most) {
  const Triangle& t = now_.was.corners(face);
  std::array<Vec3d, 8> part{seen(t[0]), seen(t[1]), seen(t[2])};
  constexpr double least_area = 1e-12;
  if (!(doubled_area(part[0], part[1], part[2]) > least_area)) return false;
  // Cut by the triangle's sides; which edges of the face are partly over it?
  std::array<std::array<double, 3>, 3> height;  // over side i at corner k
  bool inside = true;
  for (size_t i = 0; i < 3; ++i)
    for (size_t k = 0; k < 3; ++k) {
      height[i][k] = inward_[i].x * part[k].x + inward_[i].y * part[k].y + inward_[i].z;
      inside = inside && height[i][k] >= 0;
    }
  for (uint32_t k = 0; k < 3; ++k) {
    const size_t next = (k + 1) % 3;
    // The stretch [from, to] of the edge over all three sides.
    double from = 0, to = 1;
    for (size_t i = 0; i < 3 && !inside; ++i) {
      const double h = height[i][k] + margin, g = height[i][next] + margin;
      if (h < 0 && g < 0) to = -1;
      if (h < 0 && g >= 0) from = std::max(from, h / (h - g) - margin);
      if (h >= 0 && g < 0) to = std::min(to, h / (h - g) + margin);
    }
    if (from > to) continue;
    const uint32_t twin = now_.was.twin(3 * face + k);
    if (twin == none) return false;
    if (is_new(twin / 3)) pending_.push_back(twin / 3);
  }
  size_t count = 3;
  for (size_t i = 0; i < 3 && !inside; ++i) {
    std::array<Vec3d, 8> cut;
    size_t left = 0;
    const auto above = [&](Vec3d p) { return inward_[i].x * p.x + inward_[i].y * p.y + inward_[i].z + margin; };
    for (size_t k = 0; k < count; ++k) {
      const Vec3d p = part[k], q = part[(k + 1) % count];
      const double h = above(p), g = above(q);
      if (h >= 0) cut[left++] = p;
      if ((h < 0) != (g < 0)) cut[left++] = p + (q - p) * (h / (h - g));
    }
    part = cut;
    count = left;
  }
  for (size_t k = 0; k < count; ++k) {
    if (!(std::abs(part[k].z) <= distance)) return false;
    most = std::max(most, std::abs(part[k].z));
  }
  return true;
}

bool OverTriangle::is_new(uint32_t face) {
  if (4 * visited_ > slots_.size()) grow();
  const uint64_t entry = uint64_t{search_} << 32 | face;
  for (size_t i = face * size_t{2654435761u};; ++i) {
    uint64_t& slot = slots_[i & (slots_.size() - 1)];
    if (slot == entry) return false;
    if (slot >> 32 == search_) continue;
    slot = entry;
    ++visited_;
    return true;
  }
}

void OverTriangle::grow() {
  std::vector<uint64_t> old(4 * slots_.size());
  old.swap(slots_);
  visited_ = 0;
  for (const uint64_t entry : old)
    if (entry >> 32 == search_) is_new(static_cast<uint32_t>(entry));
}

}  // namespace soapfilm
