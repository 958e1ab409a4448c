// What the same loops run on: SIMD targets with one thread, the best target and plain code with more. Results must not
// depend on it.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "soapfilm/context.h"

namespace soapfilm::test {

struct BackEnd {
  std::string target;
  int threads;
};

inline void PrintTo(const BackEnd& b, std::ostream* out) { *out << b.target << ", " << b.threads << " threads"; }

inline std::vector<BackEnd> back_ends() {
  const std::vector<std::string> targets = simd_targets();
  std::vector<BackEnd> all;
  for (const std::string& target : targets) {
    all.push_back({target, 1});
    if (target == targets.front())
      for (const int threads : {2, 3}) all.push_back({target, threads});
    if (target == targets.front() || target == targets.back()) all.push_back({target, 8});
  }
  return all;
}

/// Sanitized runs skip names that end in Slow: one and eight threads on the best target and on scalar code are enough.
inline std::string back_end_name(const testing::TestParamInfo<BackEnd>& info) {
  const auto& [target, threads] = info.param;
  const std::vector<std::string> targets = simd_targets();
  const bool fast = (target == targets.front() || target == targets.back()) && (threads == 1 || threads == 8);
  return target + "_threads" + std::to_string(threads) + (fast ? "" : "_Slow");
}

inline Context context_on(const BackEnd& b) { return Context(b.threads, b.target); }

}  // namespace soapfilm::test
