#include "soapfilm/io/meshes/vdb.h"

#include "soapfilm/error.h"

#ifdef SOAPFILM_OPENVDB

#include <fmt/format.h>
#include <openvdb/io/Stream.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/MeshToVolume.h>

#include <ostream>
#include <vector>

#include "soapfilm/core/parallel.h"
#include "soapfilm/core/vec.h"
#include "soapfilm/io/bytes/file_buffer.h"
#include "soapfilm/io/precision.h"

namespace soapfilm::io {

namespace {

/// In a local frame: OpenVDB takes positions of 32 bits.
openvdb::FloatGrid::Ptr distance_grid(const Mesh& mesh, Vec3d origin, double voxel) {
  std::vector<openvdb::Vec3s> points;
  points.reserve(mesh.vertices.size());
  for (const Vec3d& vertex : mesh.vertices) {
    const auto p = static_cast<Vec3f>(vertex - origin);
    points.emplace_back(p.x, p.y, p.z);
  }
  std::vector<openvdb::Vec3I> triangles;
  triangles.reserve(mesh.triangles.size());
  for (const Triangle& t : mesh.triangles) triangles.emplace_back(t[0], t[1], t[2]);
  const auto cells = openvdb::math::Transform::createLinearTransform(voxel);
  const auto grid = openvdb::tools::meshToLevelSet<openvdb::FloatGrid>(*cells, points, triangles);
  grid->transform().postTranslate({origin.x, origin.y, origin.z});
  return grid;
}

}  // namespace

WriteReport write_vdb(AtomicFile& file, const Mesh& mesh, const WriteOptions& options, const Context& context) {
  check_mesh(mesh);
  if (!check_topology(mesh).closed())
    throw OutputError(file.path() + ": the mesh is open, a signed distance needs a closed one: write another format");
  const double voxel = options.voxel > 0 ? options.voxel : mean_edge(mesh);
  FileBuffer buffer(file);
  std::ostream stream(&buffer);
  stream.exceptions(std::ios::badbit);  // the buffer's say why
  try {
    confine(context, [&] {
      openvdb::initialize();
      const auto grid = distance_grid(mesh, mesh.box().center(), voxel);
      grid->setName("distance");
      grid->setCreator("soapfilm");
      openvdb::io::Stream(stream).write({grid});
    });
  } catch (const openvdb::Exception& error) {
    throw OutputError(fmt::format("{}: OpenVDB: {}", file.path(), error.what()));
  }
  WriteReport report;
  report.format = "OpenVDB";
  if (!mesh.colors.empty() || !mesh.attributes.empty())
    report.warnings.push_back(file.path() +
                              ": a .vdb holds the signed distance, no colors or attributes: they were left out");
  return report;
}

}  // namespace soapfilm::io

#else

namespace soapfilm::io {

WriteReport write_vdb(AtomicFile& file, const Mesh&, const WriteOptions&, const Context&) {
  throw OutputError(file.path() +
                    ": this build is without OpenVDB: build with libopenvdb-dev, or write another format");
}

}  // namespace soapfilm::io

#endif
