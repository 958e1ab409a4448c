#include "soapfilm/orient/sites.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <tuple>

#include "soapfilm/core/box_of.h"
#include "soapfilm/core/some_by_place.h"

namespace soapfilm {

Sites::Sites(const std::vector<Vec3d>& positions) : of_sample(positions.size()) {
  const Box3d box = box_of(positions);
  struct Place {
    uint64_t hash;
    uint32_t sample;
  };
  std::vector<Place> order;
  order.reserve(positions.size());
  for (size_t i = 0; i < positions.size(); ++i)
    order.push_back({hash_of_place(positions[i], box), static_cast<uint32_t>(i)});
  std::sort(order.begin(), order.end(), [&](const Place& a, const Place& b) {
    if (a.hash != b.hash) return a.hash < b.hash;
    const Vec3d &p = positions[a.sample], &q = positions[b.sample];
    return std::tie(p.x, p.y, p.z) < std::tie(q.x, q.y, q.z);
  });
  for (size_t k = 0; k < order.size(); ++k) {
    const Vec3d position = positions[order[k].sample];
    if (k == 0 || !(position == positions[order[k - 1].sample])) points.push_back(position - box.lo);
    of_sample[order[k].sample] = static_cast<uint32_t>(points.size() - 1);
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
