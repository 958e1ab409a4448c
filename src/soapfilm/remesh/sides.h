// Which way each face would look if sharp edges were sharp: seen at the scale of the new edges.
#pragma once

#include <vector>

#include "soapfilm/context.h"
#include "soapfilm/core/vec.h"
#include "soapfilm/mesh.h"
#include "soapfilm/simplify/cells.h"
#include "soapfilm/simplify/quadric.h"

namespace soapfilm {

/// A scan's sharp edge is rounded over a few small triangles. Within about half an `edge` of a face most of the surface
/// looks the way that the two sides of such an edge do: each face is given to the side that it is nearer to, the mode
/// of the normals there. Elsewhere a face keeps its own normal, apart from noise.
class Sides {
 public:
  Sides(const std::vector<Vec3d>& vertices, const std::vector<Triangle>& faces, double edge, const Context& context);

  /// Of the face's side, unit; zero for a face without area that is far from all others.
  Vec3d normal(uint32_t face) const { return side_[face]; }
  /// Of the face, or of the part of a large one that may be near a place.
  double area(uint32_t face) const { return area_[face]; }
  /// Whether the face looks another way than its side.
  bool is_rounded(uint32_t face) const;
  /// Where the planes of the faces near p meet that look as their sides do: the edge as it was before it was rounded.
  /// At most some part of `edge` from p.
  Vec3d sharpened(Vec3d p) const;

 private:
  /// Parts of faces in one small cell that look about the same way.
  struct Patch {
    int bin;
    Vec3d normal;  ///< times the area
    double area = 0;
  };

  template <class Visit>
  void for_cells_near(Vec3d p, Visit&& visit) const;
  void add_patches(const std::vector<Vec3d>& vertices, const std::vector<Triangle>& faces);
  std::vector<Patch> patches_near(Vec3d p) const;
  std::vector<uint8_t> faces_at_bends() const;
  Vec3d mode_at(uint32_t face) const;

  double edge_, radius_, per_side_;
  std::vector<Vec3d> own_;    // unit
  std::vector<double> area_;  // of the part that may be near
  std::vector<Vec3d> side_;
  std::vector<Vec3d> center_;
  CellTable cells_;
  std::vector<std::vector<Patch>> patches_;  // by cell
  std::vector<Quadric> planes_;              // by cell: of faces that look as their sides do
};

}  // namespace soapfilm
