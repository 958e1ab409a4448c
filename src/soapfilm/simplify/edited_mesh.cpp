#include "soapfilm/simplify/edited_mesh.h"

namespace soapfilm {

namespace {

/// Triangles that name a vertex twice have no area, and no part in the surface.
std::vector<Triangle> real_triangles(const Mesh& mesh) {
  std::vector<Triangle> triangles = mesh.triangles;
  std::erase_if(triangles, [](const Triangle& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; });
  return triangles;
}

std::vector<Vec3d> written_vertices(const Mesh& mesh, const Written& written) {
  std::vector<Vec3d> local;
  local.reserve(mesh.vertices.size());
  for (const Vec3d& v : mesh.vertices) local.push_back(written.local(v));
  return local;
}

}  // namespace

EditedMesh::EditedMesh(const Mesh& given, const Written& written_as)
    : written(written_as),
      was(real_triangles(given), given.vertices.size()),
      mesh(was),
      original(written_vertices(given, written_as)),
      position(original) {}

size_t EditedMesh::count_alive() const {
  size_t alive = 0;
  for (uint32_t t = 0; t < mesh.triangles(); ++t) alive += mesh.is_alive(t);
  return alive;
}

}  // namespace soapfilm
