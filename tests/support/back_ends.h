// All combinations for the same loops: SIMD targets times threads. Results must not depend on them.
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
  std::vector<BackEnd> all;
  for (const std::string& target : simd_targets())
    for (const int threads : {1, 2, 3, 8}) all.push_back({target, threads});
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
