#pragma once

namespace soapfilm {

/// The values of p_axis just below a brick, through its 64 low faces. Along x the two remaining axes are (y, z), along
/// y (x, z), along z (x, y). Below y and z rows along x are contiguous: inner is 1. Below z they are adjacent: outer is
/// 8. Below x the values of row y + 8 z are adjacent: outer is 8 inner.
struct LowFace {
  const float* base;  ///< first of 64 values
  int inner;          ///< distance between values along the lower remaining axis
  int outer;          ///< and along the higher one
  float at(int a, int b) const { return base[a * inner + b * outer]; }
  /// Below y or z: the row along x at z or y.
  const float* row(int b) const { return base + b * outer; }
};

}  // namespace soapfilm
