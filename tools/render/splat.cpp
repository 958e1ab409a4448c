#include "tools/render/splat.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "soapfilm/core/kd_tree.h"
#include "soapfilm/core/median.h"
#include "soapfilm/core/vec.h"

namespace soapfilm::render_detail {

namespace {

constexpr size_t probes = 1000;
constexpr size_t neighbors = 5;           // the sample itself and four more
constexpr double radius_share = 0.75;     // a square grid's holes close at 1 / sqrt(2) of its spacing
constexpr double fallback_share = 0.005;  // of the box, where samples coincide

}  // namespace

double splat_radius(const std::vector<Vec3d>& positions) {
  const KdTree tree(positions);
  const size_t count = std::min(neighbors, positions.size());
  const size_t stride = std::max<size_t>(1, positions.size() / probes);
  std::vector<double> squares;
  for (size_t i = 0; i < positions.size(); i += stride) {
    uint32_t index[neighbors];
    double square[neighbors];
    tree->knnSearch(&positions[i].x, count, index, square);
    squares.push_back(square[count - 1]);
  }
  if (const double middle = median(std::move(squares)); middle > 0) return radius_share * std::sqrt(middle);
  Box3d box;
  for (const Vec3d& p : positions) box.extend(p);
  return box.longest() > 0 ? fallback_share * box.longest() : 1;
}

}  // namespace soapfilm::render_detail
