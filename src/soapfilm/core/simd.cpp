#include "soapfilm/core/simd.h"

#include <fmt/core.h>
#include <hwy/highway.h>
#include <hwy/targets.h>

#include <algorithm>
#include <utility>

#include "soapfilm/core/error.h"

namespace soapfilm {

namespace {

const std::string scalar_name = "scalar";
bool only_scalar = false;

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::tolower(c); });
  return text;
}

}  // namespace

std::vector<std::string> simd_targets() {
  std::vector<std::string> names;
  for (const int64_t target : hwy::SupportedAndGeneratedTargets()) {
    std::string name = lower(hwy::TargetName(target));
    if (name != scalar_name) names.push_back(std::move(name));
  }
  names.push_back(scalar_name);
  return names;
}

bool scalar_forced() { return only_scalar; }

void force_simd_target(const std::string& name) {
  hwy::SetSupportedTargetsForTest(0);
  only_scalar = name == scalar_name;
  if (!name.empty() && !only_scalar) {
    const std::vector<int64_t> targets = hwy::SupportedAndGeneratedTargets();
    const auto it = std::find_if(targets.begin(), targets.end(),
                                 [&](int64_t target) { return lower(hwy::TargetName(target)) == name; });
    if (it == targets.end())
      throw ParameterError(fmt::format("SIMD target = {}, not available on this processor", name));
    hwy::SetSupportedTargetsForTest(*it);
  }
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
}

}  // namespace soapfilm
