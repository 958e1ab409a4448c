#include "soapfilm/core/box_tree.h"

#include <cmath>

#include "soapfilm/core/parallel.h"

namespace soapfilm {

namespace {

constexpr size_t nodes_per_task = size_t{1} << 12;

float rounded_down(double value) {
  const auto near = static_cast<float>(value);
  return near > value ? std::nextafter(near, -std::numeric_limits<float>::infinity()) : near;
}

float rounded_up(double value) {
  const auto near = static_cast<float>(value);
  return near < value ? std::nextafter(near, std::numeric_limits<float>::infinity()) : near;
}

}  // namespace

BoxTree::Box BoxTree::box_around(std::span<const Vec3d> points) {
  Box3d exact;
  for (const Vec3d& p : points) exact.extend(p);
  Box box{};
  for (int axis = 0; axis < 3; ++axis) {
    box.lo[static_cast<size_t>(axis)] = rounded_down(exact.lo[axis]);
    box.hi[static_cast<size_t>(axis)] = rounded_up(exact.hi[axis]);
  }
  return box;
}

BoxTree::BoxTree(std::span<const Vec3d> points, const Context& context) : points_(points) {
  levels_.emplace_back((points.size() + leaf_points - 1) / leaf_points);
  parallel_for(context, levels_[0].size(), nodes_per_task, [&](size_t leaf) {
    const size_t begin = leaf * leaf_points;
    levels_[0][leaf] = box_around(points.subspan(begin, std::min(leaf_points, points.size() - begin)));
  });
  while (levels_.back().size() > 1) {
    std::vector<Box> above((levels_.back().size() + 1) / 2);
    const std::vector<Box>& below = levels_.back();
    parallel_for(context, above.size(), nodes_per_task, [&](size_t node) {
      above[node] = below[2 * node];
      if (2 * node + 1 == below.size()) return;
      const Box& right = below[2 * node + 1];
      for (size_t axis = 0; axis < 3; ++axis) {
        above[node].lo[axis] = std::min(above[node].lo[axis], right.lo[axis]);
        above[node].hi[axis] = std::max(above[node].hi[axis], right.hi[axis]);
      }
    });
    levels_.push_back(std::move(above));
  }
}

}  // namespace soapfilm
