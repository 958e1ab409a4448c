// The nearest of many points.
#pragma once

#include <cstddef>
#include <cstdint>
#include <nanoflann.hpp>
#include <span>

#include "soapfilm/core/vec.h"

namespace soapfilm {

/// nanoflann's k-d tree over points, which must outlive it and must not move. Returns indices into them.
class KdTree {
  struct Points {
    std::span<const Vec3d> points;

    // Required by nanoflann.
    size_t kdtree_get_point_count() const { return points.size(); }
    double kdtree_get_pt(size_t index, size_t axis) const { return points[index][static_cast<int>(axis)]; }
    template <class Box>
    bool kdtree_get_bbox(Box& /*box*/) const {
      return false;
    }
  };
  using Tree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, Points>, Points, 3, uint32_t>;

 public:
  explicit KdTree(std::span<const Vec3d> points)
      : points_{points}, tree_(3, points_, nanoflann::KDTreeSingleIndexAdaptorParams(16)) {}
  KdTree(const KdTree&) = delete;
  KdTree& operator=(const KdTree&) = delete;

  const Tree* operator->() const { return &tree_; }

 private:
  Points points_;
  Tree tree_;
};

}  // namespace soapfilm
