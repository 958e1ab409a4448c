#include "soapfilm/place/check_samples.h"

#include <fmt/core.h>

#include <Eigen/Dense>
#include <algorithm>

#include "soapfilm/core/gather.h"
#include "soapfilm/core/indices.h"
#include "soapfilm/error.h"
#include "soapfilm/field/samples.h"

namespace soapfilm {

namespace {

/// Sides of the samples' box, input units, whose squares and cubes double can hold.
constexpr double shortest_box = 1e-100, longest_box = 1e100;
/// Fewer samples cannot lie around a volume.
constexpr size_t fewest_samples = 4;
/// Thickness of the samples along their thinnest direction, relative to the longest, below which they are coplanar.
constexpr double coplanar = 1e-7;
constexpr size_t samples_per_task = size_t{1} << 15;

/// Sums over positions.
struct Moments {
  Vec3d sum, squares, products;

  void add(Vec3d q) {
    sum += q;
    squares += Vec3d{q.x * q.x, q.y * q.y, q.z * q.z};
    products += Vec3d{q.x * q.y, q.y * q.z, q.z * q.x};
  }
  Moments& operator+=(const Moments& o) {
    sum += o.sum, squares += o.squares, products += o.products;
    return *this;
  }
};

}  // namespace

Box3d check_samples(const PointCloud& cloud, const Context& context) {
  if (cloud.size() < fewest_samples)
    throw SamplesError(
        fmt::format("{} sample{}, must be at least {}", cloud.size(), cloud.size() == 1 ? "" : "s", fewest_samples));
  if (cloud.size() > most_indices)
    throw SamplesError(fmt::format("{} samples, must be at most {} in one run: read a part of them, or thin them",
                                   cloud.size(), most_indices));
  const auto box_of = [&](size_t begin, size_t end) {
    Box3d box;
    for (size_t i = begin; i < end; ++i) {
      if (!is_finite(cloud.positions[i])) throw SamplesError(fmt::format("sample {}: position is not finite", i));
      box.extend(cloud.positions[i]);
    }
    return box;
  };
  const auto box = join_chunks<Box3d>(cloud.size(), samples_per_task, context, box_of,
                                      [](Box3d& whole, const Box3d& part) { whole.extend(part); });
  if (!(box.longest() > 0))
    throw SamplesError(fmt::format("all {} samples are identical, must span a volume", cloud.size()));
  if (box.longest() < shortest_box || box.longest() > longest_box)
    throw SamplesError(fmt::format("the longest side of the samples' box = {:g}, must be in [{:g}, {:g}]",
                                   box.longest(), shortest_box, longest_box));

  const Vec3d center = box.center();
  const double scale = 1 / box.longest();
  const auto [sum, squares, products] =
      sum_chunks<Moments>(cloud.size(), samples_per_task, context, [&](size_t begin, size_t end) {
        Moments moments;
        for (size_t i = begin; i < end; ++i) moments.add((cloud.positions[i] - center) * scale);
        return moments;
      });
  Eigen::Vector3d mean(sum.x, sum.y, sum.z);
  Eigen::Matrix3d moments;
  moments << squares.x, products.x, products.z, products.x, squares.y, products.y, products.z, products.y, squares.z;
  const auto n = static_cast<double>(cloud.size());
  mean /= n;
  const Eigen::Matrix3d covariance = moments / n - mean * mean.transpose();
  const Eigen::Vector3d variance = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(covariance).eigenvalues();
  // In units of the longest side; variances below double's rounding of 1 are no thickness.
  if (variance[0] <= std::max(coplanar * coplanar * variance[2], 1e-15))
    throw SamplesError(
        fmt::format("all {} samples are coplanar (but for {:g} of their longest side, {:.6g}), must span a volume",
                    cloud.size(), coplanar, box.longest()));
  return box;
}

}  // namespace soapfilm
