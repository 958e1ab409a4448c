#include "soapfilm/io/meshes/mesh_points.h"

#include <filesystem>
#include <utility>

#include "soapfilm/io/meshes/face_normals.h"
#include "soapfilm/io/point_columns.h"
#include "soapfilm/io/point_table.h"

namespace soapfilm::io {

PointCloud points_of_mesh(Mesh&& mesh, const ByteSource& source, std::string format, bool float32, ReadReport& report) {
  FileReport file;
  file.path = source.path();
  file.format = std::move(format);
  file.properties = {"x", "y", "z"};
  const bool has_faces = !mesh.triangles.empty();
  bool closed = false;
  PointCloud cloud;
  cloud.positions = std::move(mesh.vertices);
  cloud.normals = std::move(mesh.normals);
  if (!cloud.normals.empty()) {
    file.properties.insert(file.properties.end(), {"nx", "ny", "nz"});
  } else if (has_faces) {
    FaceNormals normals(cloud.positions);
    for (const Triangle& triangle : mesh.triangles) normals.add(triangle);
    closed = normals.closed();
    cloud.normals = normals.finish();
    file.format += ", normals from its faces";
  }
  cloud.colors = std::move(mesh.colors);
  if (!cloud.colors.empty()) file.properties.insert(file.properties.end(), {"red", "green", "blue"});
  for (Column& attribute : mesh.attributes) {
    file.properties.push_back(attribute.name);
    attribute.is_label = holds_labels(attribute.name);
    cloud.columns.push_back(std::move(attribute));
  }
  Scan scan;
  scan.name = std::filesystem::path(source.path()).stem().string();
  scan.end = cloud.size();
  cloud.scans.push_back(std::move(scan));
  finish_points(cloud, std::move(file), {.float32 = float32, .has_faces = has_faces, .closed = closed}, report);
  return cloud;
}

}  // namespace soapfilm::io
