#include "tools/scanner/trefoil.h"

#include <algorithm>
#include <limits>

namespace soapfilm {

TrefoilSearch::TrefoilSearch(const Box3d& box) : box_(box), cell_(box.longest() / 40.0), all_(samples) {
  double speed = 0.0;
  for (int i = 0; i < samples; ++i) {
    const TrefoilPoint p(spacing * i);
    speed = std::max(speed, norm(p.d1));
    sample_[i] = p.c;
    all_[i] = static_cast<uint8_t>(i);
  }
  reach_ = 1.01 * speed * 0.5 * spacing;  // 1 % for the speed between samples
  for (int axis = 0; axis < 3; ++axis) cells_[axis] = static_cast<int>(box.size()[axis] / cell_) + 1;
  const double cell_radius = 0.5 * std::sqrt(3.0) * cell_;
  for (Vec3i c; c.z < cells_.z; ++c.z) {
    for (c.y = 0; c.y < cells_.y; ++c.y) {
      for (c.x = 0; c.x < cells_.x; ++c.x) {
        const Vec3d center = box.lo + (static_cast<Vec3d>(c) + Vec3d{0.5, 0.5, 0.5}) * cell_;
        double least = std::numeric_limits<double>::infinity();
        for (size_t i = 0; i < samples; ++i) least = std::min(least, squared_distance(i, center));
        const double worth = std::sqrt(least) + 2.0 * cell_radius + reach_;
        std::vector<uint8_t>& list = table_.emplace_back();
        for (const uint8_t i : all_)
          if (squared_distance(i, center) <= worth * worth) list.push_back(i);
      }
    }
  }
}

const std::vector<uint8_t>& TrefoilSearch::candidates(Vec3d p) const {
  const Vec3d c = (p - box_.lo) / cell_;
  if (!(c.x >= 0.0 && c.y >= 0.0 && c.z >= 0.0 && c.x < cells_.x && c.y < cells_.y && c.z < cells_.z)) return all_;
  const size_t row = static_cast<size_t>(c.z) * cells_.y + static_cast<size_t>(c.y);
  return table_[row * cells_.x + static_cast<size_t>(c.x)];
}

double TrefoilSearch::lower_bound(Vec3d p) const {
  double least = std::numeric_limits<double>::infinity();
  for (const uint8_t i : candidates(p)) least = std::min(least, squared_distance(i, p));
  return std::sqrt(least) - reach_;
}

/// Parameter of the closest curve point between the neighbors of a sample: the root of g = (c - p) . c' by Newton,
/// kept in its bracket.
double TrefoilSearch::refine(int sample, Vec3d p) {
  double phi = spacing * sample;
  double lo = phi - spacing;
  double hi = phi + spacing;
  for (int k = 0; k < 60; ++k) {
    const TrefoilPoint q(phi);
    const Vec3d offset = q.c - p;
    const double g = dot(offset, q.d1);
    const double slope = dot(q.d1, q.d1) + dot(offset, q.d2);
    (g > 0.0 ? hi : lo) = phi;
    double next = slope > 0.0 ? phi - g / slope : lo;
    if (std::abs(next - phi) < 1e-10) return next;  // the next step would be below rounding
    if (next <= lo || next >= hi) next = 0.5 * (lo + hi);
    phi = next;
  }
  return phi;
}

Vec3d TrefoilSearch::closest(Vec3d p) const {
  const std::vector<uint8_t>& list = candidates(p);
  double nearest = std::numeric_limits<double>::infinity();
  for (const uint8_t i : list) nearest = std::min(nearest, squared_distance(i, p));
  const double worth = (std::sqrt(nearest) + reach_) * (std::sqrt(nearest) + reach_);
  double least = std::numeric_limits<double>::infinity();
  Vec3d foot;
  for (const uint8_t i : list) {
    const double d = squared_distance(i, p);
    if (d > worth || d > squared_distance((i + 1) % samples, p) || d > squared_distance((i + samples - 1) % samples, p))
      continue;
    const Vec3d c = TrefoilPoint(refine(i, p)).c;
    if (norm(p - c) >= least) continue;
    least = norm(p - c);
    foot = c;
  }
  return foot;
}

}  // namespace soapfilm
