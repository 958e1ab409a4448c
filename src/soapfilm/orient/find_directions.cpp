#include "soapfilm/orient/find_directions.h"

#include "soapfilm/core/context_state.h"
#include "soapfilm/core/memory.h"

namespace soapfilm {

Orientation find_directions(const PointCloud& cloud, const Box3d& box, const OrientSetup& params,
                            const Context& context) {
  Orientation found;
  found.directions = orient(cloud, params, context, found.report);
  context.progress().advance(0.3, "directions");
  const auto measure = [&](double begin, double end) {
    found.surface = measure_local_surface(cloud.positions, found.directions, box, part_of(context, begin, end));
  };
  measure(0.3, 0.8);
  if (check_signs(cloud, params, found.surface.sides, context, found.directions, found.report)) measure(0.8, 1);
  // Where each sample has a normal, there is nothing to improve.
  if (params.source != DirectionSource::automatic || found.report.from_normals == cloud.size()) return found;
  found.views = found.directions;
  use_plane_normals(cloud, found.surface, context, found.directions, found.report);
  if (found.report.from_planes == 0) release(found.views);
  return found;
}

}  // namespace soapfilm
