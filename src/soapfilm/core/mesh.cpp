#include "soapfilm/mesh.h"
#include "soapfilm/core/vec.h"

namespace soapfilm {

Box3d Mesh::box() const {
  Box3d box;
  for (const Vec3d& v : vertices) box.extend(v);
  return box;
}

double Mesh::area() const {
  double twice = 0;
  for (const Triangle& t : triangles)
    twice += norm(cross(vertices[t[1]] - vertices[t[0]], vertices[t[2]] - vertices[t[0]]));
  return 0.5 * twice;
}

double Mesh::volume() const {
  // Relative to the box centre, so that georeferenced coordinates do not cancel.
  const Vec3d centre = box().center();
  double six = 0;
  for (const Triangle& t : triangles)
    six += dot(vertices[t[0]] - centre, cross(vertices[t[1]] - centre, vertices[t[2]] - centre));
  return six / 6.0;
}

}  // namespace soapfilm
