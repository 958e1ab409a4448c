// Uses the installed library: reconstructs a torus and checks the mesh. Every include below must be found through the
// package alone.
#include <cmath>
#include <cstdio>

#include "soapfilm/io.h"
#include "soapfilm/reconstruct.h"
#include "soapfilm/version.h"

int main() {
  constexpr int around = 160, across = 80;
  soapfilm::PointCloud cloud;
  for (int i = 0; i < around; ++i)
    for (int k = 0; k < across; ++k) {
      const double a = 2 * M_PI * i / around, b = 2 * M_PI * k / across;
      const soapfilm::Vec3d normal{std::cos(a) * std::cos(b), std::sin(a) * std::cos(b), std::sin(b)};
      cloud.positions.push_back({std::cos(a) + 0.4 * normal.x, std::sin(a) + 0.4 * normal.y, 0.4 * normal.z});
      cloud.normals.push_back(
          {static_cast<float>(normal.x), static_cast<float>(normal.y), static_cast<float>(normal.z)});
    }
  cloud.scans.push_back({"torus", 0, cloud.size(), {}, {}, {}});

  soapfilm::Progress progress;
  const soapfilm::Context context(2, progress);
  soapfilm::ReconstructParams params;
  params.place.resolution = 72;
  soapfilm::Reconstruction result = soapfilm::reconstruct(cloud, params, context);
  const soapfilm::TopologyReport topology = soapfilm::check_topology(result.mesh);
  const double volume = 2 * M_PI * M_PI * 0.4 * 0.4;
  if (!topology.watertight() || topology.components.size() != 1 || topology.genus() != 1) return 1;
  if (std::abs(result.mesh.volume() - volume) > 0.02 * volume) return 2;
  if (!(result.report.certificate.relative_gap_binary() < 0.1)) return 3;
  soapfilm::write_mesh("torus.ply", result.mesh);
  if (soapfilm::read_mesh("torus.ply").triangles.size() != result.mesh.triangles.size()) return 4;
  std::printf("soapfilm %s\n", soapfilm::version);
}
