#include "tools/measure/columns.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "soapfilm/core/parallel.h"
#include "soapfilm/core/vec.h"
#include "soapfilm/error.h"

namespace soapfilm {

namespace {

constexpr size_t rows_per_strip = 8;

/// Where the columns stand. Horizontal places are whole numbers of `unit`, so that the side of an edge on which a
/// column stands is exact: each passes through one of two neighboring triangles, never through both or none.
struct ColumnGrid {
  Box3d box;
  double cell = 1;
  double unit = 1;
  size_t columns = 0, rows = 0;

  int64_t whole(double length) const { return std::llround(length / unit); }
  int64_t column_at(size_t i) const { return whole((static_cast<double>(i) + 0.5) * cell); }
};

ColumnGrid grid_over(const Box3d& all, const ColumnOptions& options) {
  ColumnGrid grid;
  grid.box = all;
  if (options.window) {
    grid.box.lo.x = options.window->lo_x, grid.box.lo.y = options.window->lo_y;
    grid.box.hi.x = options.window->hi_x, grid.box.hi.y = options.window->hi_y;
  }
  const Vec3d size = grid.box.size();
  constexpr double wanted = 1e6, most = 1e9;
  const double least = 1e-9 * std::max(size.x, size.y);
  grid.cell = options.cell > 0 ? options.cell : std::sqrt(std::max(size.x, least) * std::max(size.y, least) / wanted);
  const double columns = std::ceil(size.x / grid.cell), rows = std::ceil(size.y / grid.cell);
  if (!(columns * rows <= most))
    throw ParameterError(fmt::format("cell = {}, must be at least {:.3g}: {:.3g} columns are more than 1e9", grid.cell,
                                     std::sqrt(size.x * size.y / most), columns * rows));
  grid.columns = static_cast<size_t>(columns), grid.rows = static_cast<size_t>(rows);
  // Meshes may reach beyond a window. 2^29 units over all: products of differences stay below 2^61.
  Box3d reach = all;
  reach.extend(grid.box);
  grid.unit = std::max({reach.size().x, reach.size().y, grid.cell}) * 0x1p-29;
  return grid;
}

/// A corner relative to the grid's lower left corner.
struct Corner {
  int64_t x = 0, y = 0;
  double z = 0;
};

/// Where a column passes through a mesh.
struct Crossing {
  uint32_t column = 0;  ///< within the strip
  float side = 0;       ///< 1: the face looks up; -1: down
  bool of_other = false;
  double z = 0;

  /// From the sky down, in each column; the order of equal ones changes no length.
  bool operator<(const Crossing& b) const {
    if (column != b.column) return column < b.column;
    if (z != b.z) return z > b.z;
    return of_other != b.of_other ? b.of_other : side < b.side;
  }
};

int64_t side_of(const Corner& a, const Corner& b, int64_t x, int64_t y) {
  return (b.x - a.x) * (y - a.y) - (b.y - a.y) * (x - a.x);
}

/// Whether a point on the edge from a to b is to its left: as if all columns were moved a little to the left, and less
/// down.
bool owns_edge(const Corner& a, const Corner& b) { return b.y > a.y || (b.y == a.y && b.x < a.x); }

/// A mesh prepared for columns: its triangles by strips of rows.
class ColumnMesh {
 public:
  ColumnMesh(const Mesh& mesh, bool turned, const ColumnGrid& grid) : grid_(grid), side_(turned ? -1 : 1) {
    for (const Vec3d& v : mesh.vertices)
      corners_.push_back({grid.whole(v.x - grid.box.lo.x), grid.whole(v.y - grid.box.lo.y), v.z - grid.box.lo.z});
    strips_.resize((grid.rows + rows_per_strip - 1) / rows_per_strip);
    for (const Triangle& t : mesh.triangles) {
      const auto [first, last] = rows_of(t);
      if (first >= last) continue;
      for (size_t s = first / rows_per_strip; s <= (last - 1) / rows_per_strip; ++s) strips_[s].push_back(t);
    }
  }

  void add_crossings(size_t strip, bool of_other, std::vector<Crossing>& crossings) const {
    for (const Triangle& t : strips_[strip]) add_triangle(t, strip, of_other, crossings);
  }

 private:
  /// Columns or rows that stand within [lo, hi], up to one beyond.
  std::pair<size_t, size_t> range(int64_t lo, int64_t hi, size_t count) const {
    const double per = grid_.unit / grid_.cell, most = static_cast<double>(count);
    const double first = std::floor(static_cast<double>(lo) * per - 0.5) - 1;
    const double last = std::ceil(static_cast<double>(hi) * per - 0.5) + 2;
    return {static_cast<size_t>(std::clamp(first, 0.0, most)), static_cast<size_t>(std::clamp(last, 0.0, most))};
  }
  std::pair<size_t, size_t> rows_of(const Triangle& t) const {
    const auto [lo, hi] = std::minmax({corners_[t[0]].y, corners_[t[1]].y, corners_[t[2]].y});
    return range(lo, hi, grid_.rows);
  }

  void add_triangle(const Triangle& t, size_t strip, bool of_other, std::vector<Crossing>& crossings) const {
    std::array<Corner, 3> c{corners_[t[0]], corners_[t[1]], corners_[t[2]]};
    const int64_t twice = side_of(c[0], c[1], c[2].x, c[2].y);
    if (twice == 0) return;
    if (twice < 0) std::swap(c[1], c[2]);
    const float side = (twice > 0 ? 1.0F : -1.0F) * side_;
    const auto [lo, hi] = std::minmax({c[0].x, c[1].x, c[2].x});
    const auto [first_column, last_column] = range(lo, hi, grid_.columns);
    const auto [first_row, last_row] = rows_of(t);
    const size_t begin = strip * rows_per_strip;
    for (size_t j = std::max(first_row, begin); j < std::min(last_row, begin + rows_per_strip); ++j) {
      const int64_t y = grid_.column_at(j);
      for (size_t i = first_column; i < last_column; ++i) {
        const int64_t x = grid_.column_at(i);
        double height = 0;
        bool inside = true;
        for (size_t k = 0; k < 3 && inside; ++k) {
          const Corner &a = c[(k + 1) % 3], &b = c[(k + 2) % 3];
          const int64_t weight = side_of(a, b, x, y);
          inside = weight > 0 || (weight == 0 && owns_edge(a, b));
          height += static_cast<double>(weight) * c[k].z;
        }
        if (inside)
          crossings.push_back({static_cast<uint32_t>((j - begin) * grid_.columns + i), side, of_other,
                               height / std::abs(static_cast<double>(twice))});
      }
    }
  }

  const ColumnGrid& grid_;
  float side_;
  std::vector<Corner> corners_;
  std::vector<std::vector<Triangle>> strips_;
};

/// Sums of lengths by color of the checkerboard, and counts of columns.
struct ColumnSums {
  std::array<double, 2> fill{}, cut{};
  size_t counted = 0, left_out = 0;

  void add(const ColumnSums& other) {
    for (size_t k = 0; k < 2; ++k) fill[k] += other.fill[k], cut[k] += other.cut[k];
    counted += other.counted, left_out += other.left_out;
  }
};

/// The crossings of one column from the sky down; `open` and `other_open` say which mesh is a sheet.
void add_column(const Crossing* begin, const Crossing* end, std::array<bool, 2> open, size_t color, ColumnSums& sums) {
  std::array<int, 2> depth{};
  double fill = 0, cut = 0;
  for (const Crossing* at = begin; at != end; ++at) {
    if (at != begin) {
      const double length = (at - 1)->z - at->z;
      if (depth[0] > 0 && depth[1] <= 0) fill += length;
      if (depth[1] > 0 && depth[0] <= 0) cut += length;
    }
    depth[at->of_other] += at->side > 0 ? 1 : -1;
  }
  // Below a sheet there is ground, below a solid there is none: else a hole was met.
  bool complete = true;
  for (size_t k = 0; k < 2; ++k) complete = complete && (open[k] ? depth[k] > 0 : depth[k] == 0);
  if (!complete) {
    ++sums.left_out;
    return;
  }
  ++sums.counted;
  sums.fill[color] += fill;
  sums.cut[color] += cut;
}

Estimated estimated(const std::array<double, 2>& halves, double column_area) {
  return {(halves[0] + halves[1]) * column_area, std::abs(halves[0] - halves[1]) * column_area};
}

/// Of its area seen from above, what looks down outweighs the rest: a sheet that is turned over. A body with holes,
/// where both are about the same, is none.
bool mostly_looks_down(const Mesh& mesh) {
  constexpr double least_of_sheet = 0.5;
  double up = 0, all = 0;
  for (const Triangle& t : mesh.triangles) {
    const double area = cross(mesh.vertices[t[1]] - mesh.vertices[t[0]], mesh.vertices[t[2]] - mesh.vertices[t[0]]).z;
    up += area, all += std::abs(area);
  }
  return up < -least_of_sheet * all;
}

}  // namespace

VolumesBetween volumes_between(const Mesh& mesh, const Mesh& other, const ColumnOptions& options,
                               const Context& context) {
  const std::array<bool, 2> open{!check_topology(mesh).closed(), !check_topology(other).closed()};
  if (mesh.triangles.empty() || other.triangles.empty())
    throw ParameterError("a mesh has 0 triangles, volumes between two need at least 1 in each");
  if (open[0] && !open[1])
    throw ParameterError("the mesh is open and the one below it is closed, both must be open or the first one closed");
  Box3d box = mesh.box();
  box.extend(other.box());
  const ColumnGrid grid = grid_over(box, options);
  const auto turned = [](const Mesh& m, bool is_open) { return is_open ? mostly_looks_down(m) : m.volume() < 0; };
  const ColumnMesh first(mesh, turned(mesh, open[0]), grid), second(other, turned(other, open[1]), grid);

  const size_t strips = (grid.rows + rows_per_strip - 1) / rows_per_strip;
  std::vector<ColumnSums> sums(strips);
  parallel_for(context, strips, 1, [&](size_t strip) {
    std::vector<Crossing> crossings;
    first.add_crossings(strip, false, crossings);
    second.add_crossings(strip, true, crossings);
    std::sort(crossings.begin(), crossings.end());
    for (size_t begin = 0, end = 0; begin < crossings.size(); begin = end) {
      const size_t column = crossings[begin].column;
      while (end < crossings.size() && crossings[end].column == column) ++end;
      const size_t color = (column / grid.columns + strip * rows_per_strip + column % grid.columns) % 2;
      add_column(crossings.data() + begin, crossings.data() + end, open, color, sums[strip]);
    }
  });
  ColumnSums all;
  for (const ColumnSums& strip : sums) all.add(strip);

  const double column_area = grid.cell * grid.cell;
  VolumesBetween out;
  out.cell = grid.cell;
  out.columns = grid.columns * grid.rows;
  out.fill = estimated(all.fill, column_area);
  out.net = out.fill;
  if (open[0] == open[1]) {
    out.cut = estimated(all.cut, column_area);
    out.net = estimated({all.fill[0] - all.cut[0], all.fill[1] - all.cut[1]}, column_area);
  }
  out.footprint = static_cast<double>(all.counted) * column_area;
  out.left_out = static_cast<double>(all.left_out) * column_area;
  return out;
}

}  // namespace soapfilm
