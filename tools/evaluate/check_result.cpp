#include "tools/evaluate/check_result.h"

#include <algorithm>

#include "soapfilm/core/context_state.h"
#include "tools/mesh/distance.h"

namespace soapfilm {

namespace {

/// Embree's tree stays in memory. Where large arrays may be on disk it is of a part of the mesh at a time: a few
/// percent of what the mesh needs, which run/scratch_plan.cpp counts.
std::vector<double> distances(const std::vector<Vec3d>& points, const Mesh& mesh, const Context& context) {
  constexpr size_t parts = 32, least_triangles = size_t{1} << 17;
  if (context.state().scratch_folder.empty()) return distances_to_mesh(points, mesh, context);
  return distances_by_parts(points, mesh, std::max(least_triangles, mesh.triangles.size() / parts), context);
}

}  // namespace

void check_result(Reconstruction& result, const PointCloud& cloud, const Context& context) {
  result.report.topology = check_topology(result.mesh);
  context.progress().advance(0.4, "topology");
  result.report.sample_distance = summarize(distances(cloud.positions, result.mesh, context));
}

}  // namespace soapfilm
