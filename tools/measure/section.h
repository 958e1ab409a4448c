// Where a plane cuts a mesh: contours, their lengths and the area that they enclose.
#pragma once

#include <vector>

#include "soapfilm/mesh.h"
#include "tools/measure/plane.h"

namespace soapfilm {

struct Contour {
  std::vector<Vec3d> points;  ///< in order, the first not repeated; the solid is to the left, seen from above the plane
  bool closed = false;
};

struct Section {
  Plane plane;
  std::vector<Contour> contours;  ///< in the order of the triangles that they begin with

  double length() const;
  /// Holes count negative; what is open encloses nothing.
  double area() const;
  bool closed() const;  ///< all contours
};

/// Vertices on the plane count as above it, so every triangle is cut at two edges or not at all: contours end only at
/// the mesh's border, whatever touches the plane.
Section section(const Mesh& mesh, const Plane& plane);

/// Directions along a plane in which it is drawn: x and y where the plane is horizontal, else the first is horizontal.
struct PlaneAxes {
  Vec3d right, up;
};
PlaneAxes axes_of(const Plane& plane);

}  // namespace soapfilm
