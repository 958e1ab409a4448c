#include "soapfilm/orient/sites.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <tuple>

#include "soapfilm/core/box_of.h"
#include "soapfilm/core/checks.h"
#include "soapfilm/core/morton.h"
#include "soapfilm/core/some_by_place.h"
#include "soapfilm/orient/sample_cells.h"

namespace soapfilm {

namespace {

/// Of one key of the order; more are sorted along a curve of their own.
constexpr size_t few = 64;

/// Samples of one cell of the curve, as where others lie far away, along a curve through their own box.
void sort_crowd(std::span<uint32_t> samples, std::span<const Vec3d> positions) {
  constexpr int depth = 21;
  Box3d box;
  for (const uint32_t i : samples) box.extend(positions[i]);
  if (!(box.longest() > 0)) return;
  struct Keyed {
    uint64_t key;
    uint32_t sample;
  };
  std::vector<Keyed> order;
  order.reserve(samples.size());
  for (const uint32_t i : samples) order.push_back({morton_key((positions[i] - box.lo) / box.longest(), depth), i});
  std::sort(order.begin(), order.end(), [&](const Keyed& a, const Keyed& b) {
    const Vec3d &p = positions[a.sample], &q = positions[b.sample];
    return std::tie(a.key, p.x, p.y, p.z) < std::tie(b.key, q.x, q.y, q.z);
  });
  for (size_t k = 0; k < order.size(); ++k) samples[k] = order[k].sample;
  for (size_t begin = 0, end = 0; begin < order.size(); begin = end) {
    while (end < order.size() && order[end].key == order[begin].key) ++end;
    if (end - begin > few) sort_crowd(samples.subspan(begin, end - begin), positions);
  }
}

/// Those at one place follow each other.
std::vector<uint32_t> sort_along_curve(const std::vector<Vec3d>& positions, const Box3d& box, const Context& context) {
  const SampleOrder order(positions, {}, box, context);
  std::vector<uint32_t> samples(order.size());
  Checks check(context);
  for (size_t k = 0; k < order.size(); ++k) samples[k] = order.sample(k);
  for (size_t begin = 0, end = 0; begin < order.size(); begin = end) {
    check();
    while (end < order.size() && order.key(end) == order.key(begin)) ++end;
    if (end - begin > few) sort_crowd(std::span(samples).subspan(begin, end - begin), positions);
  }
  return samples;
}

}  // namespace

Sites::Sites(const std::vector<Vec3d>& positions, const Context& context) : of_sample_(positions.size()) {
  const Box3d box = box_of(positions);
  box_ = {{}, box.hi - box.lo};
  if (!(box.longest() > 0)) {  // all at one place
    points_.resize(std::min<size_t>(1, positions.size()));
    return;
  }
  Checks check(context);
  for (const uint32_t sample : sort_along_curve(positions, box, context)) {
    check();
    const Vec3d point = positions[sample] - box.lo;
    if (points_.empty() || !(point == points_.back())) points_.push_back(point);
    of_sample_[sample] = static_cast<uint32_t>(points_.size() - 1);
  }
}

uint64_t Sites::lot(uint32_t site) const { return hash_of_place(points_[site], box_); }

bool Sites::before(uint32_t a, uint32_t b) const {
  const uint64_t lot_a = lot(a), lot_b = lot(b);
  const Vec3d &p = points_[a], &q = points_[b];
  return std::tie(lot_a, p.x, p.y, p.z) < std::tie(lot_b, q.x, q.y, q.z);
}

Plane fit_plane(std::span<const Vec3d> points, Vec3d center, std::span<const uint32_t> chosen) {
  double radius = 0.0;
  for (const uint32_t s : chosen) radius = std::max(radius, norm(points[s] - center));
  if (!(radius > 0.0)) return {};
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  Eigen::Matrix3d moments = Eigen::Matrix3d::Zero();
  for (const uint32_t s : chosen) {
    const Vec3d q = (points[s] - center) / radius;
    const Eigen::Vector3d v(q.x, q.y, q.z);
    mean += v;
    moments += v * v.transpose();
  }
  const double count = static_cast<double>(chosen.size()) + 1.0;  // and the center itself, at the origin
  mean /= count;
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.computeDirect(moments / count - mean * mean.transpose());
  const Eigen::Vector3d variance = solver.eigenvalues();
  constexpr double line = 1e-7;  // variance across a line, relative to that along it; the solver errs by 1e-8
  if (!(variance[1] > line * variance[2])) return {};
  const Eigen::Vector3d n = solver.eigenvectors().col(0);
  const Vec3d normal = normalized(Vec3d{n.x(), n.y(), n.z()});
  return {is_finite(normal) ? normal : Vec3d{}, std::max(variance[0], 0.0) / variance[1], variance[1] / variance[2]};
}

}  // namespace soapfilm
