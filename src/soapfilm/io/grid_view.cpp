#include "soapfilm/io/grid_view.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "soapfilm/core/median.h"
#include "soapfilm/core/vec.h"

namespace soapfilm::io {

namespace {

constexpr double does_not_fit = std::numeric_limits<double>::infinity();
constexpr size_t least_cells = 100;
constexpr int least_lines = 8;  // rows or columns
constexpr int most_lines = 64;  // of each kind that are looked at

/// A sample in its cell.
struct Seen {
  Vec3d position;
  int row = 0, column = 0;  ///< of the lines looked at
};

/// The samples in some lines of a grid: enough of them to tell what kind of image it is.
class GridSample {
 public:
  /// Without samples at `from`: cells without a return.
  GridSample(const std::vector<Vec3d>& positions, const Scan& scan, const Vec3d& from) {
    const RangeGrid& grid = *scan.range_grid;
    row_step_ = (grid.rows + most_lines - 1) / most_lines;
    column_step_ = (grid.columns + most_lines - 1) / most_lines;
    size_ = std::max(grid.rows, grid.columns);
    for (int r = 0; r < grid.rows; r += row_step_)
      for (int c = 0; c < grid.columns; c += column_step_) {
        const int32_t sample = grid.sample[static_cast<size_t>(r) * static_cast<size_t>(grid.columns) + c];
        if (sample < 0) continue;
        const Vec3d& p = positions[scan.begin + static_cast<size_t>(sample)];
        if (is_finite(p) && !(p == from)) cells_.push_back({p, r / row_step_, c / column_step_});
      }
    rows_ = 1 + (grid.rows - 1) / row_step_;
    columns_ = 1 + (grid.columns - 1) / column_step_;
  }

  bool tells() const { return cells_.size() >= least_cells && rows_ >= least_lines && columns_ >= least_lines; }
  /// Errors up to this are those of lenses and mirrors, in steps of the grid.
  double tolerance() const { return 0.5 + 0.005 * size_; }

  double median_range(const Vec3d& from) const {
    std::vector<double> ranges;
    for (const Seen& seen : cells_) ranges.push_back(norm(seen.position - from));
    return median(std::move(ranges));
  }

  double perspective_error(const Vec3d& from) const;
  double angular_error(const Vec3d& from) const;

 private:
  using Normals = std::array<Vec3d, most_lines>;

  Vec3d direction(const Seen& seen, const Vec3d& from) const { return normalized(seen.position - from); }
  std::vector<int> plane_normals(const Vec3d& from, Normals& normals) const;
  double column_error(const Vec3d& from, const std::vector<int>& planes, const Normals& normals) const;
  double row_error(const Vec3d& from, const Vec3d& axis) const;

  std::vector<Seen> cells_;
  int row_step_ = 1, column_step_ = 1, rows_ = 0, columns_ = 0, size_ = 0;
};

Vec3d least_direction(const Eigen::Matrix3d& scatter) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(scatter);
  const Eigen::Vector3d v = solver.eigenvectors().col(0);
  return {v[0], v[1], v[2]};
}

void add_square(const Vec3d& v, Eigen::Matrix3d& scatter) {
  const Eigen::Vector3d e(v.x, v.y, v.z);
  scatter += e * e.transpose();
}

/// The root of the mean square of all but the largest 5 %: edges of things are blurred.
double trimmed_rms(std::vector<double> squares) {
  const size_t kept = squares.size() - squares.size() / 20;
  if (kept == 0) return does_not_fit;
  std::nth_element(squares.begin(), squares.begin() + static_cast<std::ptrdiff_t>(kept - 1), squares.end());
  double sum = 0;
  for (size_t i = 0; i < kept; ++i) sum += squares[i];
  return std::sqrt(sum / static_cast<double>(kept));
}

/// The best projection (u, v, w) = M d of directions d to columns u/w and rows v/w, by the direct linear transform
/// (Sutherland 1974). Returns the error in steps of the grid.
double GridSample::perspective_error(const Vec3d& from) const {
  constexpr double narrow = 0.25;  // cosine: wider images are not those of lenses
  const double middle_row = 0.5 * rows_, middle_column = 0.5 * columns_;
  using Matrix9 = Eigen::Matrix<double, 9, 9>;
  Matrix9 sum = Matrix9::Zero();
  Vec3d mean{};
  for (const Seen& seen : cells_) {
    const Vec3d d = direction(seen, from);
    if (d == Vec3d{}) return does_not_fit;
    mean += d;
    const double u = (seen.column - middle_column) / most_lines, v = (seen.row - middle_row) / most_lines;
    Eigen::Matrix<double, 9, 1> a, b;
    a << d.x, d.y, d.z, 0, 0, 0, -u * d.x, -u * d.y, -u * d.z;
    b << 0, 0, 0, d.x, d.y, d.z, -v * d.x, -v * d.y, -v * d.z;
    sum += a * a.transpose() + b * b.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Matrix9> solver(sum);
  const Eigen::Matrix<double, 9, 1> m = solver.eigenvectors().col(0);
  const Vec3d to_u{m[0], m[1], m[2]}, to_v{m[3], m[4], m[5]}, to_w{m[6], m[7], m[8]};
  mean = normalized(mean);
  const bool positive = dot(to_w, mean) > 0;
  std::vector<double> squares;
  for (const Seen& seen : cells_) {
    const Vec3d d = direction(seen, from);
    const double w = dot(to_w, d);
    if (dot(d, mean) < narrow || (w > 0) != positive || w == 0) return does_not_fit;
    const double u = (dot(to_u, d) / w * most_lines + middle_column - seen.column) * column_step_;
    const double v = (dot(to_v, d) / w * most_lines + middle_row - seen.row) * row_step_;
    squares.push_back(u * u + v * v);
  }
  return trimmed_rms(std::move(squares));
}

/// The planes through `from` that the columns' directions lie in; returns the columns that have one.
std::vector<int> GridSample::plane_normals(const Vec3d& from, Normals& normals) const {
  std::array<Eigen::Matrix3d, most_lines> scatter;
  std::array<int, most_lines> counts{};
  scatter.fill(Eigen::Matrix3d::Zero());
  for (const Seen& seen : cells_) {
    add_square(direction(seen, from), scatter[static_cast<size_t>(seen.column)]);
    ++counts[static_cast<size_t>(seen.column)];
  }
  constexpr int least_in_column = 5;
  std::vector<int> planes;
  for (size_t c = 0; c < counts.size(); ++c) {
    if (counts[c] < least_in_column) continue;
    normals[c] = least_direction(scatter[c]);
    planes.push_back(static_cast<int>(c));
  }
  return planes;
}

/// How far directions are from their column's plane, in steps from column to column.
double GridSample::column_error(const Vec3d& from, const std::vector<int>& planes, const Normals& normals) const {
  std::vector<double> steps, squares;
  for (size_t k = 1; k < planes.size(); ++k) {
    const double cosine =
        std::abs(dot(normals[static_cast<size_t>(planes[k - 1])], normals[static_cast<size_t>(planes[k])]));
    steps.push_back(std::acos(std::min(cosine, 1.0)) / (planes[k] - planes[k - 1]));
  }
  const double step = median(std::move(steps)) / column_step_;
  if (!(step > 0)) return does_not_fit;
  for (const Seen& seen : cells_) {
    if (!std::binary_search(planes.begin(), planes.end(), seen.column)) continue;
    const double off = dot(direction(seen, from), normals[static_cast<size_t>(seen.column)]) / step;
    squares.push_back(off * off);
  }
  return trimmed_rms(std::move(squares));
}

/// How far directions are from their row's cone about the axis, in steps from row to row.
double GridSample::row_error(const Vec3d& from, const Vec3d& axis) const {
  std::array<std::vector<double>, most_lines> heights;
  for (const Seen& seen : cells_)
    heights[static_cast<size_t>(seen.row)].push_back(
        std::asin(std::clamp(dot(direction(seen, from), axis), -1.0, 1.0)));
  std::vector<double> steps, offs;
  std::optional<std::pair<size_t, double>> last;
  for (size_t r = 0; r < heights.size(); ++r) {
    if (heights[r].size() < 4) continue;
    const double middle = median(heights[r]);
    for (const double height : heights[r]) offs.push_back(height - middle);
    if (last) steps.push_back(std::abs(middle - last->second) / static_cast<double>(r - last->first));
    last = {r, middle};
  }
  const double step = steps.empty() ? 0 : median(std::move(steps)) / row_step_;
  if (!(step > 0)) return does_not_fit;
  for (double& off : offs) off = off / step * (off / step);
  return trimmed_rms(std::move(offs));
}

double GridSample::angular_error(const Vec3d& from) const {
  Normals normals{};
  const std::vector<int> planes = plane_normals(from, normals);
  if (planes.size() < static_cast<size_t>(least_lines)) return does_not_fit;
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const int c : planes) add_square(normals[static_cast<size_t>(c)], scatter);
  return std::max(column_error(from, planes, normals), row_error(from, least_direction(scatter)));
}

/// Does the image fit about `from`, and about no place beside it?
template <class Error>
bool fits_only_here(const GridSample& grid, const Vec3d& from, double here, const Error& error) {
  constexpr double beside = 0.5;  // of the range
  if (here > grid.tolerance()) return false;
  const double way = beside * grid.median_range(from);
  for (int axis = 0; axis < 3; ++axis)
    for (const double sign : {-1.0, 1.0}) {
      Vec3d other = from;
      other[axis] += sign * way;
      if (!(error(other) > 2 * here + 0.05 * grid.tolerance())) return false;
    }
  return true;
}

}  // namespace

GridView judge_view(const std::vector<Vec3d>& positions, const Scan& scan, const Vec3d& from) {
  constexpr double clearly = 3;
  if (!scan.range_grid || scan.range_grid->rows < least_lines || scan.range_grid->columns < least_lines)
    return GridView::unclear;
  const GridSample grid(positions, scan, from);
  if (!grid.tells()) return GridView::unclear;
  const auto perspective = [&](const Vec3d& at) { return grid.perspective_error(at); };
  const auto angular = [&](const Vec3d& at) { return grid.angular_error(at); };
  const double error = perspective(from), turned_error = angular(from);
  if (fits_only_here(grid, from, error, perspective) || fits_only_here(grid, from, turned_error, angular))
    return GridView::seen_from;
  return std::min(error, turned_error) > clearly * grid.tolerance() ? GridView::not_from : GridView::unclear;
}

bool is_near_samples(const std::vector<Vec3d>& positions, const Scan& scan, const Vec3d& from, double diagonals) {
  Box3d box;
  for (size_t i = scan.begin; i < scan.end; ++i)
    if (is_finite(positions[i])) box.extend(positions[i]);
  Vec3d way{};
  for (int axis = 0; axis < 3; ++axis)
    way[axis] = std::max({box.lo[axis] - from[axis], from[axis] - box.hi[axis], 0.0});
  return box.diagonal() == 0 || norm(way) <= diagonals * box.diagonal();  // one place alone tells nothing
}

bool is_scanner_place(const std::vector<Vec3d>& positions, const Scan& scan, const Vec3d& from,
                      bool unless_contradicted) {
  constexpr double far = 30, not_far = 10;  // in diagonals; far: a small thing before a camera
  if (!scan.range_grid || !is_near_samples(positions, scan, from, far)) return false;
  const GridView view = judge_view(positions, scan, from);
  if (view != GridView::unclear) return view == GridView::seen_from;
  return unless_contradicted && is_near_samples(positions, scan, from, not_far);
}

}  // namespace soapfilm::io
