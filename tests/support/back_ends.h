// Every way that the same loops can run: SIMD targets times threads. Results must not depend on it.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "soapfilm/core/simd.h"

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

inline std::string back_end_name(const testing::TestParamInfo<BackEnd>& info) {
  return info.param.target + "_threads" + std::to_string(info.param.threads);
}

/// Forces a SIMD target for a scope.
class ForcedTarget {
 public:
  explicit ForcedTarget(const std::string& name) { force_simd_target(name); }
  ~ForcedTarget() { force_simd_target(""); }
  ForcedTarget(const ForcedTarget&) = delete;
  ForcedTarget& operator=(const ForcedTarget&) = delete;
};

}  // namespace soapfilm::test
