// The robust weight of a sample: less where it does not fit, and 0 if it was seen from the wrong side.
#pragma once

#include <cmath>

#include "soapfilm/core/vec.h"

namespace soapfilm {

/// The cost of a residual r, in units of the scale s: least_squares r^2; huber |r| beyond 1.345 s; geman_mcclure r^2 /
/// (1 + (r / 2 s)^2); tukey constant beyond 4.685 s.
enum class Penalty { least_squares, huber, geman_mcclure, tukey };

inline constexpr float huber_scales = 1.345f, tukey_scales = 4.685f;

/// Weight of a sample in iteratively re-weighted least squares: rho'(r) / 2 r, 1 at r = 0. scale > 0.
inline float robust_weight(Penalty penalty, float residual, float scale) {
  const float r = std::abs(residual) / scale;
  switch (penalty) {
    case Penalty::least_squares:
      return 1.0f;
    case Penalty::huber:
      return r <= huber_scales ? 1.0f : huber_scales / r;
    case Penalty::geman_mcclure: {
      const float d = 1 + r * r / 4;
      return 1 / (d * d);
    }
    case Penalty::tukey: {
      const float d = 1 - r * r / (tukey_scales * tukey_scales);
      return d <= 0 ? 0.0f : d * d;
    }
  }
  return 1.0f;
}

inline constexpr float outside_cosine = 0.3f;

/// Whether a sample was seen from outside: its direction points out of the surface, or nearly so.
inline bool seen_from_outside(Vec3f direction, Vec3f gradient) {
  return dot(direction, gradient) <= outside_cosine * norm(direction) * norm(gradient);
}

/// Lower bounds of the slopes by which distances from a level set and its normals are divided.
inline constexpr float least_slope_of_distance = 0.3f, least_slope_of_normal = 1e-3f;

}  // namespace soapfilm
