// From samples to a watertight mesh with a proof, in a page. The samples are those of a torus here; read_points() of
// soapfilm/io.h reads them from files instead.
#include <cmath>
#include <cstdio>
#include <exception>
#include <numbers>

#include "soapfilm/io.h"
#include "soapfilm/reconstruct.h"

namespace {

/// Samples of a torus with normals, 20,000 of them.
soapfilm::PointCloud torus() {
  soapfilm::PointCloud cloud;
  for (int i = 0; i < 20000; ++i) {
    const double a = 2 * std::numbers::pi * i / 20000, b = 2 * std::numbers::pi * std::fmod(i * 0.6180339887, 1.0);
    const soapfilm::Vec3d n{std::cos(a) * std::cos(b), std::sin(a) * std::cos(b), std::sin(b)};
    cloud.positions.push_back({std::cos(a) + 0.4 * n.x, std::sin(a) + 0.4 * n.y, 0.4 * n.z});
    cloud.normals.push_back(static_cast<soapfilm::Vec3f>(n));
  }
  cloud.scans.push_back({"torus", 0, cloud.size(), {}, {}, {}});
  return cloud;
}

}  // namespace

int main() try {
  soapfilm::Progress progress;                   // derive from it to be told, call cancel() to stop
  const soapfilm::Context context(0, progress);  // all threads that the process may use
  const soapfilm::PointCloud cloud = torus();

  soapfilm::ReconstructParams params;
  params.place.resolution = 64;
  const soapfilm::Reconstruction result = reconstruct(cloud, params, context);

  std::printf("%zu samples, %zu triangles\n", cloud.size(), result.mesh.triangles.size());
  std::printf("proved within %.3g of the global optimum\n", result.report.certificate.relative_gap_binary());
  soapfilm::write_mesh("torus.ply", result.mesh);
  const soapfilm::TopologyReport topology = check_topology(result.mesh);
  return topology.watertight() && topology.genus() == 1 ? 0 : 1;
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 2;
}
