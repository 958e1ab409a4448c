#include "soapfilm/mesh.h"
#include "soapfilm/core/box_of.h"
#include "soapfilm/core/vec.h"

namespace soapfilm {

Box3d Mesh::box() const { return box_of(vertices); }

double Mesh::area() const {
  double twice = 0;
  for (const Triangle& t : triangles)
    twice += norm(cross(vertices[t[1]] - vertices[t[0]], vertices[t[2]] - vertices[t[0]]));
  return 0.5 * twice;
}

double Mesh::volume() const {
  // Relative to the box center, so that georeferenced coordinates do not cancel.
  const Vec3d center = box().center();
  double six = 0;
  for (const Triangle& t : triangles)
    six += dot(vertices[t[0]] - center, cross(vertices[t[1]] - center, vertices[t[2]] - center));
  return six / 6.0;
}

}  // namespace soapfilm
