// Which SIMD instructions the kernels use. They are chosen at run time; results do not depend on the choice.
#pragma once

#include <cstdint>
#include <string>

namespace soapfilm {

/// One of simd_targets().
class SimdTarget {
 public:
  /// By name; empty: the best. Throws ParameterError for one that cannot run here.
  explicit SimdTarget(const std::string& name = {});

  /// No kernels but those without SIMD instructions.
  bool is_scalar() const { return bits_ == 0; }
  /// Bits of the targets that may serve, as Highway numbers them; the best of these that was compiled does.
  int64_t bits() const { return bits_; }

 private:
  int64_t bits_;
};

}  // namespace soapfilm
