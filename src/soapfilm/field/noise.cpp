#include "soapfilm/field/noise.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "soapfilm/core/box_of.h"
#include "soapfilm/core/kd_tree.h"
#include "soapfilm/core/parallel.h"
#include "soapfilm/core/rounded.h"
#include "soapfilm/core/some_by_place.h"

namespace soapfilm {

namespace {

constexpr size_t most_searched = 100000, most_asked = 500;
constexpr size_t fewest_near = 32, most_near = 64, most_of_both_sides = 2 * most_near;
constexpr size_t thinned_by = 4, thinnings = 3;  // 64 of the thinnest subset lie where 4,096 of the first do
constexpr double most_thick = 0.1;               // least over middle variance
constexpr double least_wide = 0.15;              // middle over largest variance
constexpr size_t asked_per_task = 32;

struct Points {
  std::vector<Vec3d> places;     ///< relative to the first of them
  std::vector<Vec3f> direction;  ///< zero: unknown
  size_t size() const { return places.size(); }
  void add(Vec3d place, Vec3f towards) {
    places.push_back(place);
    direction.push_back(towards);
  }
};

/// Chosen by their places, in an order that is as good as a random one.
Points some_of(std::span<const Vec3d> positions, std::span<const Vec3f> directions, const Context& context) {
  const auto chosen = some_by_place(box_of(positions), positions.size(), most_searched, context,
                                    [&](size_t i) { return positions[i]; });
  Points some;
  for (const uint32_t i : chosen) some.add(positions[i] - positions[chosen[0]], directions[i]);
  return some;
}

/// Of normal noise a fifth lies within any quarter of a deviation around the middle; where much more has one height, as
/// the ground under trees, the others are no noise. By chance few samples may do so, too.
bool has_ground(std::vector<double>& height, double deviation) {
  constexpr double at_most = 0.27, chance = 1;  // of all; times the root of their number
  std::sort(height.begin(), height.end());
  size_t most = 0;
  for (size_t low = 0, high = 0; high < height.size(); ++high) {
    while (height[high] - height[low] > deviation / 2) ++low;
    most = std::max(most, high - low + 1);
  }
  const auto all = static_cast<double>(height.size());
  return static_cast<double>(most) > at_most * all + chance * std::sqrt(all);
}

struct Layer {
  bool thin = false;      ///< beside its width
  double deviation = -1;  ///< of its points, from the plane through them; < 0: not by noise
};

Layer layer_of(const std::vector<Vec3d>& points, Vec3d center, std::span<const uint32_t> near) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  Eigen::Matrix3d moments = Eigen::Matrix3d::Zero();
  for (const uint32_t index : near) {
    const Vec3d d = points[index] - center;
    const Eigen::Vector3d v(d.x, d.y, d.z);
    sum += v;
    moments += v * v.transpose();
  }
  const auto n = static_cast<double>(near.size());
  const Eigen::Vector3d mean = sum / n;
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.computeDirect(moments / n - mean * mean.transpose());
  const Eigen::Vector3d variance = solver.eigenvalues();
  if (!(variance[1] > least_wide * variance[2]) || !(variance[0] < most_thick * variance[1])) return {};
  const double deviation = std::sqrt(std::max(variance[0], 0.0) * n / (n - 3));
  const Eigen::Vector3d normal = solver.eigenvectors().col(0);
  std::vector<double> height;
  for (const uint32_t index : near) {
    const Vec3d d = points[index] - center;
    height.push_back(normal.x() * d.x + normal.y() * d.y + normal.z() * d.z);
  }
  return {true, has_ground(height, deviation) ? -1 : deviation};
}

/// The other side of a sheet, or the side of a post. An unknown direction is on any face.
bool on_another_face(Vec3f a, Vec3f b) {
  constexpr float alike = 0.5f;  // cosine
  return dot(a, b) < alike && !(a == Vec3f{}) && !(b == Vec3f{});
}

/// The layer of one face in the smallest neighborhood where it is thin.
Layer look_around(const Points& points, const KdTree& tree, Vec3d center, Vec3f direction, size_t fewest) {
  std::array<uint32_t, most_of_both_sides> index{};
  std::array<double, most_of_both_sides> squared{};
  const size_t found = tree->knnSearch(&center.x, most_of_both_sides, index.data(), squared.data());
  const auto end = std::remove_if(index.begin(), index.begin() + static_cast<std::ptrdiff_t>(found),
                                  [&](uint32_t i) { return on_another_face(points.direction[i], direction); });
  const size_t alike = std::min(static_cast<size_t>(end - index.begin()), most_near);
  for (size_t count = fewest; count <= alike; count *= 2)
    if (const Layer layer = layer_of(points.places, center, {index.data(), count}); layer.thin) return layer;
  return {};
}

/// The first of them. (Every so manieth would be others if one changed its place in the order.)
Points first_of(const Points& points, size_t count) {
  Points some;
  for (size_t k = 0; k < std::min(count, points.size()); ++k) some.add(points.places[k], points.direction[k]);
  return some;
}

}  // namespace

double measure_noise(std::span<const Vec3d> positions, std::span<const Vec3f> directions, const Context& context) {
  constexpr double enough = 0.3;  // of those asked
  if (positions.size() < 2 * most_near) return 0;
  Points points = some_of(positions, directions, context);
  const Points asked = first_of(points, most_asked);
  std::vector<Layer> found(asked.size());
  for (size_t thinning = 0; thinning <= thinnings && points.size() >= 2 * most_near; ++thinning) {
    if (thinning > 0) points = first_of(points, points.size() / thinned_by);
    const KdTree tree(points.places);
    parallel_chunks(context, asked.size(), asked_per_task, [&](size_t begin, size_t end) {
      context.check();
      for (size_t k = begin; k < end; ++k)
        if (!found[k].thin)
          found[k] =
              look_around(points, tree, asked.places[k], asked.direction[k], thinning == 0 ? fewest_near : most_near);
    });
  }
  std::vector<double> deviations;
  for (const Layer& layer : found)
    if (layer.deviation >= 0) deviations.push_back(layer.deviation);
  if (static_cast<double>(deviations.size()) < enough * static_cast<double>(asked.size())) return 0;
  const auto middle = deviations.begin() + static_cast<std::ptrdiff_t>(deviations.size() / 2);
  std::nth_element(deviations.begin(), middle, deviations.end());
  return rounded(*middle);
}

}  // namespace soapfilm
