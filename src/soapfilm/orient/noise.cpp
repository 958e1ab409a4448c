#include "soapfilm/orient/noise.h"

#include <algorithm>
#include <cmath>

namespace soapfilm {

namespace {

constexpr double per_octave = 8;

}  // namespace

void NoiseStatistics::add(double deviation, size_t samples, double area) {
  const double sum = static_cast<double>(samples) * area;
  all_ += sum;
  if (!(deviation > 0)) return;
  const double bin = std::floor(-per_octave * std::log2(std::min(deviation, 1.0)));
  if (bin < static_cast<double>(bins)) area_[static_cast<size_t>(bin)] += sum;
}

NoiseStatistics& NoiseStatistics::operator+=(const NoiseStatistics& other) {
  for (size_t bin = 0; bin < bins; ++bin) area_[bin] += other.area_[bin];
  all_ += other.all_;
  return *this;
}

double NoiseStatistics::quantile(double share) const {
  double above = 0;
  for (size_t bin = 0; bin < bins; ++bin) {
    above += area_[bin];
    if (above > (1 - share) * all_) return std::exp2(-(static_cast<double>(bin) + 0.5) / per_octave);
  }
  return 0;
}

}  // namespace soapfilm
