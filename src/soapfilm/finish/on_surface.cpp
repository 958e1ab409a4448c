#include "soapfilm/finish/on_surface.h"

#include <Eigen/Eigenvalues>

namespace soapfilm {

Company company_of(const GridSamples& samples, Vec3d place) {
  constexpr double reach = 8;  // voxels
  constexpr double fewest = 6;
  constexpr double most_thick = 0.15;  // least over middle variance
  const Vec3i center = brick_around(place);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  Eigen::Matrix3d moments = Eigen::Matrix3d::Zero();
  double count = 0;
  for (int k = 0; k < 27; ++k) {
    const Vec3i brick = center + Vec3i{k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1};
    const int32_t found = samples.bricks.find(brick);
    if (found < 0) continue;
    const auto slot = static_cast<size_t>(found);
    const Vec3d from = place - Vec3d(brick * brick_side);
    for (uint32_t s = samples.begin[slot]; s < samples.begin[slot + 1]; ++s) {
      const Vec3d d = Vec3d(samples.local[s]) - from;
      if (dot(d, d) > reach * reach) continue;
      const Eigen::Vector3d v(d.x, d.y, d.z);
      sum += v;
      moments += v * v.transpose();
      ++count;
    }
  }
  if (count < fewest) return Company::few;
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  const Eigen::Vector3d mean = sum / count;
  solver.computeDirect(moments / count - mean * mean.transpose(), Eigen::EigenvaluesOnly);
  const Eigen::Vector3d variance = solver.eigenvalues();
  constexpr double line = 0.05;  // middle over largest variance
  const bool surface = variance[0] <= most_thick * variance[1] || variance[1] <= line * variance[2];
  return surface ? Company::surface : Company::scattered;
}

}  // namespace soapfilm
