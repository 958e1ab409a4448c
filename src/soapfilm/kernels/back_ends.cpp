// The table of back ends, and the choice of a context's kernels from it.
#include <fmt/core.h>

#include <algorithm>
#include <array>

#include "soapfilm/context.h"
#include "soapfilm/core/context_state.h"
#include "soapfilm/error.h"
#include "soapfilm/kernels/kernels.h"

namespace soapfilm {

namespace {

/// Best first.
std::array<BackEnd, 2> back_ends() { return {highway_back_end(), scalar_back_end()}; }

}  // namespace

std::vector<std::string> simd_targets() {
  std::vector<std::string> names;
  for (const BackEnd& back_end : back_ends())
    for (std::string& name : back_end.targets()) names.push_back(std::move(name));
  return names;
}

std::shared_ptr<const Kernels> kernels_for(const std::string& target) {
  for (const BackEnd& back_end : back_ends()) {
    const std::vector<std::string> targets = back_end.targets();
    if (targets.empty()) continue;
    if (target.empty()) return std::make_shared<const Kernels>(back_end.kernels(targets.front()));
    if (std::find(targets.begin(), targets.end(), target) != targets.end())
      return std::make_shared<const Kernels>(back_end.kernels(target));
  }
  throw ParameterError(fmt::format("SIMD target = {}, not available on this processor", target));
}

}  // namespace soapfilm
