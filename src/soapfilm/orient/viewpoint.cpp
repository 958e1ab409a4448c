#include "soapfilm/orient/viewpoint.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <tuple>

namespace soapfilm {

namespace {

/// Two axes of the coordinate system that are square to an axis.
std::array<int, 2> across(Vec3d up) {
  const int axis = up.x != 0 ? 0 : up.y != 0 ? 1 : 2;
  return {(axis + 1) % 3, (axis + 2) % 3};
}

/// Length along an axis that holds all but the outermost fiftieths.
double extent(std::span<const Vec3d> points, Vec3d axis) {
  constexpr size_t at_each_end = 50;  // one part of so many
  std::vector<double> along(points.size());
  for (size_t i = 0; i < points.size(); ++i) along[i] = dot(points[i], axis);
  const auto few = static_cast<std::ptrdiff_t>(points.size() / at_each_end);
  std::nth_element(along.begin(), along.begin() + few, along.end());
  const double low = along[static_cast<size_t>(few)];
  std::nth_element(along.begin(), along.end() - 1 - few, along.end());
  return along[along.size() - 1 - static_cast<size_t>(few)] - low;
}

Vec3d unit_along(int axis) {
  Vec3d unit;
  unit[axis] = 1;
  return unit;
}

struct LevelPiece {
  int64_t column;
  double height;
};

/// Level flat pieces, by columns with some 16 of them each. `column`: its width.
std::vector<LevelPiece> level_pieces(const PlanePoints& scene, Vec3d up, double& column) {
  constexpr double level = 0.8;  // cosine
  constexpr double per_column = 16;
  std::vector<Vec3d> pieces;
  for (size_t i = 0; i < scene.points.size(); ++i)
    if (is_flat(scene.planes[i]) && std::abs(dot(scene.planes[i].normal, up)) > level)
      pieces.push_back(scene.points[i]);
  if (static_cast<double>(pieces.size()) < 2 * per_column) return {};
  const std::array<int, 2> axes = across(up);
  const double a = extent(pieces, unit_along(axes[0])), b = extent(pieces, unit_along(axes[1]));
  column = std::sqrt(a * b * per_column / static_cast<double>(pieces.size()));
  if (!(column > 0)) return {};
  std::vector<LevelPiece> levels;
  for (const Vec3d& p : pieces) {
    constexpr double most = 1e9;  // an outlier may be anywhere
    const auto cell = [&](int axis) {
      return static_cast<int64_t>(std::clamp(std::floor(p[axis] / column), -most, most));
    };
    const int64_t i = cell(axes[0]), j = cell(axes[1]);
    levels.push_back({i * (int64_t{1} << 31) + j, dot(p, up)});
  }
  std::sort(levels.begin(), levels.end(), [](const LevelPiece& p, const LevelPiece& q) {
    return std::tie(p.column, p.height) < std::tie(q.column, q.height);
  });
  return levels;
}

}  // namespace

bool is_flat_layer(const PlanePoints& scene, Vec3d up) {
  constexpr double thin = 0.35;  // of the shorter width
  constexpr double level = 0.6;  // cosine
  constexpr double mostly_level = 0.5;
  if (scene.points.empty()) return false;
  const std::array<int, 2> axes = across(up);
  const double width = std::min(extent(scene.points, unit_along(axes[0])), extent(scene.points, unit_along(axes[1])));
  if (!(extent(scene.points, up) <= thin * width)) return false;
  size_t level_ones = 0;
  for (const Plane& plane : scene.planes) level_ones += std::abs(dot(plane.normal, up)) > level;
  return static_cast<double>(level_ones) >= mostly_level * static_cast<double>(scene.planes.size());
}

bool is_storey(const PlanePoints& scene, Vec3d up) {
  constexpr double apart = 1.5;          // columns: a slope is no second piece
  constexpr size_t fewest = 8, few = 3;  // pieces of a column; of each of its levels
  constexpr double nearly_all = 0.4;     // of the columns
  double column = 0;
  const std::vector<LevelPiece> levels = level_pieces(scene, up, column);
  size_t columns = 0, twofold = 0;
  for (size_t begin = 0, end = 0; begin < levels.size(); begin = end) {
    while (end < levels.size() && levels[end].column == levels[begin].column) ++end;
    if (end - begin < fewest) continue;
    ++columns;
    bool two = false;
    for (size_t k = begin + few; k + few <= end && !two; ++k)
      two = levels[k].height - levels[k - 1].height > apart * column;
    twofold += two;
  }
  return static_cast<double>(twofold) > nearly_all * static_cast<double>(columns);
}

}  // namespace soapfilm
