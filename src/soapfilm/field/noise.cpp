#include "soapfilm/field/noise.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "soapfilm/core/kd_tree.h"
#include "soapfilm/core/parallel.h"
#include "soapfilm/core/random.h"

namespace soapfilm {

namespace {

constexpr size_t most_searched = 100000, most_asked = 500;
constexpr size_t fewest_near = 16, most_near = 64;
constexpr size_t thinned_by = 4, thinnings = 3;  // 64 of the thinnest subset lie where 4,096 of the first do
constexpr double most_thick = 0.05;  // least over middle variance: a quarter of the width
constexpr double least_wide = 0.15;  // middle over largest variance
constexpr size_t asked_per_task = 32;

/// Evenly spread over the order of the positions, relative to the first.
std::vector<Vec3d> some_of(std::span<const Vec3d> positions) {
  const size_t stretch = (positions.size() + most_searched - 1) / most_searched;
  std::vector<Vec3d> some;
  for (size_t k = 0; k * stretch < positions.size(); ++k)
    some.push_back(positions[one_of_stretch(k, stretch, positions.size())] - positions[0]);
  return some;
}

/// Sums over the nearest points, grown from step to step.
class Neighborhood {
 public:
  Neighborhood(const std::vector<Vec3d>& points, Vec3d center) : points_(points), center_(center) {}

  void add(uint32_t index) {
    const Vec3d d = points_[index] - center_;
    const Eigen::Vector3d v(d.x, d.y, d.z);
    sum_ += v;
    moments_ += v * v.transpose();
    ++count_;
  }
  /// Standard deviation from the plane through them, or -1 where they lie on none.
  double deviation() const {
    const auto n = static_cast<double>(count_);
    const Eigen::Vector3d mean = sum_ / n;
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
    solver.computeDirect(moments_ / n - mean * mean.transpose(), Eigen::EigenvaluesOnly);
    const Eigen::Vector3d variance = solver.eigenvalues();
    if (!(variance[1] > least_wide * variance[2]) || !(variance[0] < most_thick * variance[1])) return -1;
    return std::sqrt(std::max(variance[0], 0.0) * n / (n - 3));
  }

 private:
  const std::vector<Vec3d>& points_;
  Vec3d center_;
  Eigen::Vector3d sum_ = Eigen::Vector3d::Zero();
  Eigen::Matrix3d moments_ = Eigen::Matrix3d::Zero();
  size_t count_ = 0;
};

/// Neighborhood::deviation() of the smallest one that has it, or -1.
double deviation_around(const std::vector<Vec3d>& points, const KdTree& tree, Vec3d center, size_t fewest) {
  std::array<uint32_t, most_near> index{};
  std::array<double, most_near> squared{};
  const size_t found = tree->knnSearch(&center.x, most_near, index.data(), squared.data());
  Neighborhood around(points, center);
  size_t added = 0;
  for (size_t count = fewest; count <= found; count *= 2) {
    for (; added < count; ++added) around.add(index[added]);
    if (const double deviation = around.deviation(); deviation >= 0) return deviation;
  }
  return -1;
}

/// Every so manieth point.
std::vector<Vec3d> thinned(const std::vector<Vec3d>& points) {
  std::vector<Vec3d> some;
  for (size_t k = 0; k < points.size(); k += thinned_by) some.push_back(points[k]);
  return some;
}

}  // namespace

double measure_noise(std::span<const Vec3d> positions, const Context& context) {
  constexpr double enough = 0.3;  // of those asked
  if (positions.size() < 2 * most_near) return 0;
  std::vector<Vec3d> points = some_of(positions);
  std::vector<Vec3d> asked;
  for (size_t k = 0, step = (points.size() + most_asked - 1) / most_asked; k < points.size(); k += step)
    asked.push_back(points[k]);
  std::vector<double> found(asked.size(), -1.0);
  for (size_t thinning = 0; thinning <= thinnings && points.size() >= 2 * most_near; ++thinning) {
    if (thinning > 0) points = thinned(points);
    const KdTree tree(points);
    parallel_chunks(context, asked.size(), asked_per_task, [&](size_t begin, size_t end) {
      context.check();
      for (size_t k = begin; k < end; ++k)
        if (found[k] < 0) found[k] = deviation_around(points, tree, asked[k], thinning == 0 ? fewest_near : most_near);
    });
  }
  std::erase_if(found, [](double deviation) { return deviation < 0; });
  if (static_cast<double>(found.size()) < enough * static_cast<double>(asked.size())) return 0;
  std::nth_element(found.begin(), found.begin() + static_cast<std::ptrdiff_t>(found.size() / 2), found.end());
  return found[found.size() / 2];
}

}  // namespace soapfilm
