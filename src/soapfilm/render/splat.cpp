#include "soapfilm/render/splat.h"

#include <algorithm>
#include <cmath>
#include <nanoflann.hpp>
#include <utility>

#include "soapfilm/core/box.h"
#include "soapfilm/core/median.h"

namespace soapfilm::render_detail {

namespace {

constexpr size_t probes = 1000;
constexpr size_t neighbours = 5;          // the sample itself and four more
constexpr double radius_share = 0.75;     // a square grid's holes close at 1 / sqrt(2) of its spacing
constexpr double fallback_share = 0.005;  // of the box, where samples coincide

/// What nanoflann asks of a set of points.
struct Adaptor {
  const std::vector<Vec3d>& positions;
  size_t kdtree_get_point_count() const { return positions.size(); }
  double kdtree_get_pt(size_t i, size_t axis) const { return positions[i][static_cast<int>(axis)]; }
  template <class Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};

}  // namespace

double splat_radius(const std::vector<Vec3d>& positions) {
  using Tree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, Adaptor>, Adaptor, 3, uint32_t>;
  const Adaptor adaptor{positions};
  Tree tree(3, adaptor, nanoflann::KDTreeSingleIndexAdaptorParams(16));
  tree.buildIndex();
  const size_t count = std::min(neighbours, positions.size());
  const size_t stride = std::max<size_t>(1, positions.size() / probes);
  std::vector<double> squares;
  for (size_t i = 0; i < positions.size(); i += stride) {
    uint32_t index[neighbours];
    double square[neighbours];
    tree.knnSearch(&positions[i].x, count, index, square);
    squares.push_back(square[count - 1]);
  }
  if (const double middle = median(std::move(squares)); middle > 0) return radius_share * std::sqrt(middle);
  Box3d box;
  for (const Vec3d& p : positions) box.extend(p);
  return box.longest() > 0 ? fallback_share * box.longest() : 1;
}

}  // namespace soapfilm::render_detail
