#include "soapfilm/io/leading_columns.h"

#include <algorithm>
#include <cmath>

#include "soapfilm/core/vec.h"

namespace soapfilm::io {

namespace {

bool is_whole(double value) { return value == std::floor(value); }

template <class T>
bool are_whole(const std::vector<T>& values) {
  return std::all_of(values.begin(), values.end(), [](T v) { return is_whole(static_cast<double>(v)); });
}

template <class T>
bool are_fractions(const std::vector<T>& values) {
  return std::all_of(values.begin(), values.end(), [](T v) { return v >= 0 && v <= 1; });
}

/// An intensity, a class, a color: not a coordinate.
template <class T>
bool may_be_value(const std::vector<T>& values) {
  return are_whole(values) || are_fractions(values);
}

bool rises(const std::vector<Vec3d>& positions) {
  for (size_t i = 1; i < positions.size(); ++i)
    if (!(positions[i].x > positions[i - 1].x)) return false;
  return positions.size() > 1;
}

/// Counted from row to row; some numbers may be missing.
bool counts_up(const std::vector<Vec3d>& positions) {
  size_t ones = 0;
  for (size_t i = 1; i < positions.size(); ++i) ones += positions[i].x - positions[i - 1].x == 1;
  const size_t steps = positions.size() - 1;
  return ones == steps || (steps >= 9 && 2 * ones >= steps);
}

/// Are neither y nor z whole numbers?
bool are_broken(const std::vector<Vec3d>& positions) {
  return !std::all_of(positions.begin(), positions.end(), [](const Vec3d& p) { return is_whole(p.y); }) &&
         !std::all_of(positions.begin(), positions.end(), [](const Vec3d& p) { return is_whole(p.z); });
}

/// Do the first two columns go through the cells of a grid in order, the one of axis `slow` row by row?
bool goes_through_cells(const std::vector<Vec3d>& positions, int slow) {
  constexpr double most = 1e6;
  const int fast = 1 - slow;
  size_t within = 0, ones = 0;
  for (size_t i = 0; i < positions.size(); ++i) {
    const Vec3d& p = positions[i];
    if (!is_whole(p.x) || !is_whole(p.y) || std::min(p.x, p.y) < 0 || std::max(p.x, p.y) > most) return false;
    if (i == 0) continue;
    const Vec3d& before = positions[i - 1];
    const double step = p[fast] - before[fast];
    if (p[slow] < before[slow] || (p[slow] == before[slow] && !(step > 0))) return false;
    if (p[slow] > before[slow]) continue;
    ++within;
    ones += step == 1;
  }
  const double first = positions.front()[slow];
  return 2 * within >= positions.size() && 2 * ones >= within && (positions.back()[slow] > first || first <= 1);
}

/// Are columns 3 to 5 more like x y z than like a height and its attributes?
bool are_coordinates(const PointCloud& cloud, const UnnamedColumns& unnamed) {
  const bool third_whole =
      std::all_of(cloud.positions.begin(), cloud.positions.end(), [](const Vec3d& p) { return is_whole(p.z); });
  return !third_whole && !are_whole(unnamed.fourth) && !are_whole(unnamed.fifth) &&
         !(are_fractions(unnamed.fourth) && are_fractions(unnamed.fifth));
}

}  // namespace

LeadingColumns judge_leading(const PointCloud& cloud, const UnnamedColumns& unnamed) {
  constexpr size_t least_rows = 4;
  const size_t rows = cloud.size();
  if (rows < 2 || cloud.columns.empty()) return LeadingColumns::none;
  const bool few = rows < least_rows;
  const bool whole = unnamed.fourth.size() == rows;  // the first column
  if (!few && whole && unnamed.fifth.size() == rows)
    for (const int slow : {0, 1})
      if (goes_through_cells(cloud.positions, slow)) {
        if (!are_coordinates(cloud, unnamed)) return LeadingColumns::unclear_cells;
        return slow == 0 ? LeadingColumns::row_column : LeadingColumns::column_row;
      }
  const bool rising = rises(cloud.positions), counting = whole && rising && counts_up(cloud.positions);
  if (whole ? may_be_value(unnamed.fourth) : may_be_value(cloud.columns[0].values))
    return counting && !few ? LeadingColumns::unclear : LeadingColumns::none;
  if (counting) return few ? LeadingColumns::unclear : LeadingColumns::number;
  return (rising && !few) || (whole && are_broken(cloud.positions)) ? LeadingColumns::unclear : LeadingColumns::none;
}

}  // namespace soapfilm::io
