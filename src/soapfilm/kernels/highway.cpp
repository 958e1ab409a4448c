// The back end of SIMD instructions: Highway's targets.
#include <hwy/highway.h>
#include <hwy/targets.h>

#include <algorithm>
#include <utility>

#include "soapfilm/kernels/kernels.h"

namespace soapfilm {

namespace {

std::string name_of(int64_t target) {
  std::string name = hwy::TargetName(target);
  std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) { return std::tolower(c); });
  return name;
}

std::vector<std::string> targets() {
  std::vector<std::string> names;
  for (const int64_t target : hwy::SupportedAndGeneratedTargets())
    if (std::string name = name_of(target); name != "scalar") names.push_back(std::move(name));
  return names;
}

Kernels kernels(const std::string& target) {
  int64_t bits = 0;
  for (const int64_t one : hwy::SupportedAndGeneratedTargets())
    if (name_of(one) == target) bits = one;
  return {{highway_sweep_kernel(bits, Norm::isotropic), highway_sweep_kernel(bits, Norm::anisotropic)},
          {highway_energy_kernel(bits, Norm::isotropic), highway_energy_kernel(bits, Norm::anisotropic)},
          highway_divergence_kernel(bits),
          highway_sor_kernel(bits),
          highway_row_kernel(bits)};
}

}  // namespace

BackEnd highway_back_end() { return {targets, kernels}; }

}  // namespace soapfilm
