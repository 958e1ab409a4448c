// What reconstruct.h offers, by the page.
#include "soapfilm/reconstruct.h"

#include <utility>

#include "soapfilm/mesh/distance.h"
#include "soapfilm/mesh/topology.h"
#include "soapfilm/run/run.h"

namespace soapfilm {

Reconstruction reconstruct(const PointCloud& cloud, const ReconstructParams& params, const Context& context,
                           const PyramidObserver& observe) {
  return run(cloud, nullptr, params, context, observe);
}

Reconstruction reconstruct(PointCloud&& cloud, const ReconstructParams& params, const Context& context,
                           const PyramidObserver& observe) {
  PointCloud owned = std::move(cloud);
  return run(owned, &owned, params, context, observe);
}

void check_result(Reconstruction& result, const PointCloud& cloud, const Context& context) {
  result.report.topology = check_topology(result.mesh);
  result.report.sample_distance = point_to_mesh_distance(cloud.positions, result.mesh, context);
}

}  // namespace soapfilm
