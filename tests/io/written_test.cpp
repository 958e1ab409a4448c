// What is written keeps what the mesh had: judged in the file, not in memory.
#include <cmath>

#include "files.h"
#include "samples.h"
#include "soapfilm/io.h"
#include "soapfilm/mesh.h"

namespace soapfilm {
namespace TEST_FILE {

/// A watertight torus that lies thousands of its sizes from the origin: float steps are as large as its smallest
/// triangles.
Mesh far_torus(double distance) {
  Mesh mesh = torus_mesh(200, 1.0);
  mesh.colors.clear();
  mesh.attributes.clear();
  mesh.normals.clear();
  // One vertex close to a neighbor: a triangle much smaller than the mean edge, as marching cubes makes them.
  const Triangle& t = mesh.triangles.front();
  mesh.vertices[t[0]] = mesh.vertices[t[1]] + (mesh.vertices[t[0]] - mesh.vertices[t[1]]) * 1e-5;
  for (Vec3d& v : mesh.vertices) v = v + Vec3d{distance, distance, distance};
  return mesh;
}

TEST(Written, NoTriangleCollapsesInTheFile) {
  const TemporaryFolder folder;
  for (const double distance : {0.0, 3000.0}) {
    const Mesh mesh = far_torus(distance);
    ASSERT_TRUE(check_topology(mesh).watertight());
    for (const char* name : {"m.ply", "m.obj", "m.off"})
      for (const bool ascii : {false, true}) {
        WriteOptions options;
        options.ascii = ascii;
        options.coordinate_precision = 1;  // the caller would allow float
        const WriteReport written = write_mesh(folder / name, mesh, options);
        EXPECT_TRUE(check_topology(read_mesh(folder / name)).watertight()) << name << " at " << distance;
        EXPECT_EQ(written.double_coordinates, distance > 0) << name << " at " << distance;
      }
  }
}

TEST(Written, StlCountsTheTrianglesThatItCollapses) {
  const TemporaryFolder folder;
  const WriteReport near = write_mesh(folder / "near.stl", far_torus(0));
  EXPECT_TRUE(near.warnings.empty());
  const WriteReport far = write_mesh(folder / "far.stl", far_torus(3000));
  bool said = false;
  for (const std::string& warning : far.warnings) said = said || warning.find("lost all area") != std::string::npos;
  EXPECT_TRUE(said);
}

TEST(Written, StlRefusesUnitsThatFloatCannotHold) {
  const TemporaryFolder folder;
  for (const double scale : {1e-50, 1e50}) {
    Mesh mesh = torus_mesh(10, 1.0);
    for (Vec3d& v : mesh.vertices) v = v * scale;
    expect_refusal<OutputError>([&] { write_mesh(folder / "m.stl", mesh); }, {"m.stl", "largest coordinate", "unit"});
    write_mesh(folder / "m.ply", mesh);
    EXPECT_EQ(read_mesh(folder / "m.ply").vertices, mesh.vertices);
  }
  EXPECT_EQ(folder.file_count(), 1u);
}

}  // namespace TEST_FILE
}  // namespace soapfilm
