// Where sheets of the surface face each other, and which triangles are there.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "soapfilm/simplify/cells.h"
#include "soapfilm/simplify/edited_mesh.h"

namespace soapfilm {

/// Two triangles can come to intersect only where the triangles of the original do not all face one half of all
/// directions, apart from folds at a single edge. Only these places keep lists of triangles.
class ThinPlaces {
 public:
  struct NewTriangle {
    std::array<Vec3d, 3> corner;
  };

  /// Of the original within `distance` of each other, local frame; lists the triangles that are there now.
  ThinPlaces(const EditedMesh& now, double distance);

  /// False if none is in the box.
  bool near(const Box3d& box) const;
  /// Do the triangles intersect each other or one there that is not in `replaced`? A flat one does.
  bool meets(std::span<const NewTriangle> triangles, std::span<const uint32_t> replaced) const;
  void remove(uint32_t triangle);
  void insert(uint32_t triangle);
  /// Files what is there now in lists of cells of about that side, local frame, at most the usual one. Not for use by
  /// several threads afterwards.
  void refile(double side_of_cells);

 private:
  static constexpr double side = 2, per_side = 1 / side;
  static constexpr int coarse = 3;  // log2 of cells along a coarse cell

  template <class Visit>
  void for_lists(Vec3d a, Vec3d b, Vec3d c, Visit&& visit) const;

  const EditedMesh& now_;
  CellTable thin_, coarse_;
  int finer_ = 0;   // log2 of the lists' cells along a cell
  CellTable fine_;  // where lists are, if those are finer
  std::vector<std::vector<uint32_t>> lists_;
};

/// All pairs of triangles that intersect elsewhere than in common corners and edges, at least one of them marked:
/// sorted.
std::vector<std::array<uint32_t, 2>> meeting_pairs(const EditedMesh& now, const std::vector<uint8_t>& marked,
                                                   const Context& context);

}  // namespace soapfilm
