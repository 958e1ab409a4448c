#include "soapfilm/core/simd.h"

#include <fmt/core.h>
#include <hwy/highway.h>
#include <hwy/targets.h>

#include <algorithm>
#include <utility>

#include "soapfilm/context.h"
#include "soapfilm/error.h"

namespace soapfilm {

namespace {

const std::string scalar_name = "scalar";

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

SimdTarget::SimdTarget(const std::string& name) : bits_(hwy::SupportedTargets()) {
  if (name.empty()) return;
  bits_ = 0;
  if (name == scalar_name) return;
  for (const int64_t target : hwy::SupportedAndGeneratedTargets())
    if (lower(hwy::TargetName(target)) == name) bits_ = target;
  if (bits_ == 0) throw ParameterError(fmt::format("SIMD target = {}, not available on this processor", name));
}

}  // namespace soapfilm
