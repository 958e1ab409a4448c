// Penalties that listen less to samples which do not fit.
#pragma once

#include <cmath>

namespace soapfilm {

/// What a residual r costs, in units of the scale s: least_squares r^2; huber |r| beyond 1.345 s; geman_mcclure
/// r^2 / (1 + (r / 2 s)^2); tukey nothing more beyond 4.685 s.
enum class Penalty { least_squares, huber, geman_mcclure, tukey };

/// Weight of a sample in iteratively re-weighted least squares: rho'(r) / 2 r, 1 at r = 0. scale > 0.
inline float robust_weight(Penalty penalty, float residual, float scale) {
  const float r = std::abs(residual) / scale;
  switch (penalty) {
    case Penalty::least_squares:
      return 1.0f;
    case Penalty::huber:
      return r <= 1.345f ? 1.0f : 1.345f / r;
    case Penalty::geman_mcclure: {
      const float d = 1 + r * r / 4;
      return 1 / (d * d);
    }
    case Penalty::tukey: {
      const float d = 1 - r * r / (4.685f * 4.685f);
      return d <= 0 ? 0.0f : d * d;
    }
  }
  return 1.0f;
}

}  // namespace soapfilm
