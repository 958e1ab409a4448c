// The noise of the samples: how far they lie from the planes around them.
#pragma once

#include <array>
#include <cstddef>

namespace soapfilm {

/// Sums over samples on planes, by the standard deviation of the samples around them along the plane's normal.
class NoiseStatistics {
 public:
  /// `deviation` of the samples in a cell, 0: they are too few to tell; `samples` that lie there, each of which represents `area`. Lengths are in
  /// units of the longest side of the samples' box.
  void add(double deviation, size_t samples, double area);
  NoiseStatistics& operator+=(const NoiseStatistics& other);

  /// A deviation so that this share of the area has less, same units, within a tenth; what is not known counts as
  /// none. 0: less than can be told.
  double quantile(double share) const;

 private:
  static constexpr size_t bins = 160;  ///< eight for each factor of two, from 1 downwards
  std::array<double, bins> area_{};
  double all_ = 0;
};

}  // namespace soapfilm
