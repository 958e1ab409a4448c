#include "soapfilm/refine/fit/displacement.h"

namespace soapfilm {

int Displacement::minimize(const CellSamples& data, Smoothness smoothness, const SolveLimits& limits) {
  solver_->start(data, smoothness);
  double first = 0, rz = 0;
  int iteration = 0;
  for (bool last = false; !last && iteration < limits.iterations; ++iteration) {
    const double new_rz = solver_->preconditioned();
    if (iteration == 0) first = new_rz;
    if (!(new_rz > 0)) break;
    last = new_rz <= limits.tolerance * limits.tolerance * first || iteration + 1 == limits.iterations;
    const float ratio = iteration == 0 ? 0.0f : static_cast<float>(new_rz / rz);
    const double curvature = solver_->search_direction(data, smoothness, ratio, last);
    rz = new_rz;
    if (!(curvature > 0)) break;
    solver_->step(static_cast<float>(rz / curvature), last);
  }
  return iteration;
}

}  // namespace soapfilm
