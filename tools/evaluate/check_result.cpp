#include "tools/evaluate/check_result.h"

#include "tools/mesh/distance.h"

namespace soapfilm {

void check_result(Reconstruction& result, const PointCloud& cloud, const Context& context) {
  result.report.topology = check_topology(result.mesh);
  context.progress().advance(0.4, "topology");
  result.report.sample_distance = point_to_mesh_distance(cloud.positions, result.mesh, context);
}

}  // namespace soapfilm
