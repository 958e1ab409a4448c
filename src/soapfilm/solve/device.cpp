#include "soapfilm/solve/device.h"

#include "soapfilm/core/context_state.h"
#include "soapfilm/solve/sweep.h"

namespace soapfilm {

std::unique_ptr<LevelSolver> level_solver(Level& level, const Context& context) {
  if (const Device* device = device_of(context)) return device->on(level, context);
  return std::make_unique<Sweeper>(level, context);
}

}  // namespace soapfilm
