// The triangles of the original mesh, found by place.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "soapfilm/core/triangle_distance.h"
#include "soapfilm/mesh.h"
#include "soapfilm/simplify/cells.h"

namespace soapfilm {

/// Cells of unit side, in blocks of 4^3 where triangles lie.
class FaceGrid {
 public:
  /// Refers to both, in the local frame.
  FaceGrid(const std::vector<Vec3d>& vertices, const std::vector<Triangle>& faces);

  Vec3d corner(uint32_t face, size_t k) const { return vertices_[faces_[face][k]]; }
  double squared_distance(Vec3d p, uint32_t face) const {
    return soapfilm::squared_distance(p, corner(face, 0), corner(face, 1), corner(face, 2));
  }

  /// visit(face) for those in cells that the ball reaches, some more than once, until it returns true; whether it did.
  template <class Visit>
  bool any_near(Vec3d p, double radius, Visit&& visit) const {
    const Vec3d r{radius, radius, radius};
    const Vec3i lo = cell_of(p - r, 1), hi = cell_of(p + r, 1), own = cell_of(p, 1);
    if (visit_cell(own, visit)) return true;
    if (lo == hi) return false;
    for (int z = lo.z; z <= hi.z; ++z)
      for (int y = lo.y; y <= hi.y; ++y)
        for (int x = lo.x; x <= hi.x; ++x)
          if (const Vec3i cell{x, y, z}; !(cell == own) && visit_cell(cell, visit)) return true;
    return false;
  }

  /// Is the surface within the distance of p?
  bool is_near(Vec3d p, double distance) const {
    return any_near(p, distance, [&](uint32_t f) { return squared_distance(p, f) <= distance * distance; });
  }

  /// The nearest face among those within `distance`; none: CellTable::none.
  uint32_t nearest(Vec3d p, double distance) const;

 private:
  using Block = std::array<uint32_t, 65>;  // where each cell's faces begin in faces_in_

  template <class Visit>
  bool visit_cell(Vec3i cell, Visit&& visit) const {
    const uint32_t block = blocks_.find(block_key(cell));
    if (block == CellTable::none) return false;
    const size_t i = within(cell);
    const Block& begins = begins_[block];
    for (uint32_t k = begins[i]; k < begins[i + 1]; ++k)
      if (visit(in_cells_[k])) return true;
    return false;
  }
  static uint64_t block_key(Vec3i cell) { return cell_key({cell.x >> 2, cell.y >> 2, cell.z >> 2}); }
  static size_t within(Vec3i cell) { return static_cast<size_t>((cell.z & 3) << 4 | (cell.y & 3) << 2 | (cell.x & 3)); }

  const std::vector<Vec3d>& vertices_;
  const std::vector<Triangle>& faces_;
  CellTable blocks_;
  std::vector<Block> begins_;
  std::vector<uint32_t> in_cells_;
};

}  // namespace soapfilm
