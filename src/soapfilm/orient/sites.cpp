#include "soapfilm/orient/sites.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <numeric>

namespace soapfilm {

Sites::Sites(const std::vector<Vec3d>& positions) : of_sample(positions.size()) {
  std::vector<uint32_t> order(positions.size());
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) {
    const Vec3d &p = positions[a], &q = positions[b];
    if (p.x != q.x) return p.x < q.x;
    if (p.y != q.y) return p.y < q.y;
    return p.z != q.z ? p.z < q.z : a < b;
  });
  // The first sample at each sample's position.
  for (size_t k = 0; k < order.size(); ++k) {
    const bool twin = k > 0 && positions[order[k]] == positions[order[k - 1]];
    of_sample[order[k]] = twin ? of_sample[order[k - 1]] : order[k];
  }
  for (size_t i = 0; i < positions.size(); ++i) {
    if (of_sample[i] < i) {
      of_sample[i] = of_sample[of_sample[i]];
      continue;
    }
    of_sample[i] = static_cast<uint32_t>(points.size());
    points.push_back(positions[i] - positions[0]);
  }
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
