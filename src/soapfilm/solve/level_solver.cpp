#include "soapfilm/solve/level_solver.h"

#include "soapfilm/core/context_state.h"
#include "soapfilm/device/device.h"
#include "soapfilm/solve/energy.h"
#include "soapfilm/solve/sweep.h"

namespace soapfilm {

StepSizes step_sizes(double sigma) {
  // The iteration converges for tau sigma |grad|^2 < 4/3 (Li and Yan 2022, "On the improved conditions for some
  // primal-dual algorithms"), where |grad|^2 <= 12: a third more than Chambolle and Pock's own bound.
  constexpr double product = 1.3 / 12;
  return {static_cast<float>(sigma), static_cast<float>(product / sigma)};
}

Energies LevelSolver::energies() {
  download();
  return evaluate_energy(level_, {}, context_);
}

double LevelSolver::estimated_gap() {
  download();
  return estimate_gap(level_, context_);
}

std::shared_ptr<LevelSolver> level_solver(Level& level, const Context& context) {
  const Device* device = level.places ? nullptr : device_of(context);
  if (std::shared_ptr<LevelSolver> solver = device ? device->on(level, context) : nullptr) return solver;
  return std::make_shared<Sweeper>(level, context);
}

}  // namespace soapfilm
