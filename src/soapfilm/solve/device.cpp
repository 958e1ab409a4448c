#include "soapfilm/solve/device.h"

#include "soapfilm/core/context_state.h"
#include "soapfilm/solve/energy.h"
#include "soapfilm/solve/sweep.h"

namespace soapfilm {

Energies LevelSolver::energies() {
  download();
  return evaluate_energy(level_, {}, context_);
}

double LevelSolver::estimated_gap() {
  download();
  return estimate_gap(level_, context_);
}

std::unique_ptr<LevelSolver> level_solver(Level& level, const Context& context) {
  if (const Device* device = device_of(context)) return device->on(level, context);
  return std::make_unique<Sweeper>(level, context);
}

}  // namespace soapfilm
