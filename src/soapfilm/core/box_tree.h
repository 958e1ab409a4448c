// The nearest of many points that are in an order along space.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "soapfilm/context.h"
#include "soapfilm/core/vec.h"

namespace soapfilm {

/// A tree of bounding boxes over points, which must outlive it: its leaves are runs of consecutive points, its nodes
/// pairs of consecutive nodes. Any order gives the same results; with points along a Morton curve it is fast, and near
/// points lie near in memory, so queries in the order of the points read the points once, even from disk.
class BoxTree {
 public:
  BoxTree(std::span<const Vec3d> points, const Context& context);

  /// Calls found.add(index, squared distance) for all points not farther from p than found.limit(), a squared distance
  /// that may fall with each call, and for some others. Begins at a point thought to be near.
  template <class Found>
  void search(Vec3d p, size_t start, Found& found) const;

 private:
  static constexpr size_t leaf_points = 16;
  static constexpr size_t most_levels = 40;

  /// Not smaller than the points' box, though in float.
  struct Box {
    std::array<float, 3> lo, hi;
  };
  /// Not more than to any point in it: each rounding below keeps the order of its arguments.
  static double squared_distance(Vec3d p, const Box& box) {
    double sum = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const auto a = static_cast<size_t>(axis);
      const double apart = std::max({box.lo[a] - p[axis], p[axis] - box.hi[a], 0.0});
      sum += apart * apart;
    }
    return sum;
  }
  static Box box_around(std::span<const Vec3d> points);

  template <class Found>
  void search_leaf(Vec3d p, size_t leaf, Found& found) const {
    const size_t end = std::min(points_.size(), (leaf + 1) * leaf_points);
    for (size_t i = leaf * leaf_points; i < end; ++i) {
      const Vec3d step = p - points_[i];
      const double squared = step.x * step.x + step.y * step.y + step.z * step.z;
      if (squared <= found.limit()) found.add(static_cast<uint32_t>(i), squared);
    }
  }
  template <class Found>
  void search_node(Vec3d p, size_t level, size_t node, Found& found) const;

  std::span<const Vec3d> points_;
  std::vector<std::vector<Box>> levels_;  ///< the leaves first, the root last
};

template <class Found>
void BoxTree::search(Vec3d p, size_t start, Found& found) const {
  if (points_.empty()) return;
  size_t node = std::min(start, points_.size() - 1) / leaf_points;
  search_leaf(p, node, found);
  for (size_t level = 0; level + 1 < levels_.size(); ++level, node /= 2)
    if (const size_t sibling = node ^ 1; sibling < levels_[level].size()) search_node(p, level, sibling, found);
}

template <class Found>
void BoxTree::search_node(Vec3d p, size_t level, size_t node, Found& found) const {
  struct Open {
    double squared;
    size_t level, node;
  };
  std::array<Open, most_levels> open;  // at most one on each level, and a second one on the lowest
  size_t count = 0;
  open[count++] = {squared_distance(p, levels_[level][node]), level, node};
  while (count > 0) {
    const Open at = open[--count];
    if (at.squared > found.limit()) continue;
    if (at.level == 0) {
      search_leaf(p, at.node, found);
      continue;
    }
    const std::vector<Box>& below = levels_[at.level - 1];
    const size_t left = 2 * at.node, right = left + 1;
    Open near{squared_distance(p, below[left]), at.level - 1, left};
    if (right < below.size()) {
      Open far{squared_distance(p, below[right]), at.level - 1, right};
      if (far.squared < near.squared) std::swap(near, far);
      if (far.squared <= found.limit()) open[count++] = far;
    }
    open[count++] = near;
  }
}

/// The `most` points nearest to a query, nearest first. Of equally near ones those come first that are before(a, b)
/// others, an order of all points.
template <class Before>
class NearestPoints {
 public:
  NearestPoints(size_t most, Before before) : index_(most), squared_(most), before_(before) {}

  /// Of a new query, which does not find the point `excluded`.
  void restart(uint32_t excluded = ~uint32_t{0}) {
    count_ = 0;
    excluded_ = excluded;
  }
  std::span<const uint32_t> found() const { return {index_.data(), count_}; }
  double limit() const {
    return count_ < index_.size() ? std::numeric_limits<double>::infinity() : count_ > 0 ? squared_[count_ - 1] : -1.0;
  }
  void add(uint32_t i, double squared) {
    if (i == excluded_) return;
    const auto comes_first = [&](size_t k) {
      return squared < squared_[k] || (squared == squared_[k] && before_(i, index_[k]));
    };
    if (count_ == index_.size() && !comes_first(count_ - 1)) return;
    size_t k = count_ < index_.size() ? count_++ : count_ - 1;
    for (; k > 0 && comes_first(k - 1); --k) {
      index_[k] = index_[k - 1];
      squared_[k] = squared_[k - 1];
    }
    index_[k] = i;
    squared_[k] = squared;
  }

 private:
  std::vector<uint32_t> index_;
  std::vector<double> squared_;
  Before before_;
  size_t count_ = 0;
  uint32_t excluded_ = 0;
};

}  // namespace soapfilm
