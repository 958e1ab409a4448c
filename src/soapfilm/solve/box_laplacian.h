// -Laplace(u) on a box of vertices, u = 0 on its border: the matrix of Poisson's equation and its multigrid levels.
//
// An axis has the free vertices 1 .. free between the fixed ones 0 and free + 1. All intervals have length 1 except the
// last one, before vertex free + 1: so a coarse level keeps the exact length of the box for any number of vertices.
//
//   |----o----o----o--|        free = 3, last = 1/2
//   0    1    2    3  4
//
// The equation of a vertex is integrated over its cell (finite volumes): the matrix is symmetric, positive definite,
// and (A u)_i = sum over its six faces of area / distance * (u_i - u_j). With last = 1 on every axis and scale 1 that
// is the 7-point stencil (6, -1 x 6).
#pragma once

#include <array>
#include <cstddef>

#include "soapfilm/core/parallel.h"
#include "soapfilm/core/vec.h"
#include "soapfilm/grid/dense_field.h"

namespace soapfilm {

struct BoxAxis {
  int free = 1;     ///< free vertices, >= 1
  double last = 1;  ///< length of the last interval, > 0

  /// 1 / length of the interval between vertices i and i + 1.
  double link(int i) const { return i == free ? 1 / last : 1; }
  /// Length of vertex i's cell, which ends half way to its neighbors.
  double width(int i) const { return i == free ? (1 + last) / 2 : 1; }
};

/// Face area / distance to each neighbor, and their sum.
struct Stencil {
  float x_down, x_up, y_down, y_up, z_down, z_up;
  float sum() const { return ((x_down + x_up) + (y_down + y_up)) + (z_down + z_up); }
};

/// A row of vertices (all x of one y and z) has two stencils: its last vertex may be closer to the border.
struct RowStencils {
  Stencil inner, last;
};

class BoxLaplacian {
 public:
  /// `scale` multiplies the whole matrix: the length of an interval, in intervals of the finest level.
  BoxLaplacian(const std::array<BoxAxis, 3>& axes, double scale) : axes_(axes), scale_(scale) {}

  const BoxAxis& axis(int k) const { return axes_[static_cast<size_t>(k)]; }
  Vec3i free() const { return {axes_[0].free, axes_[1].free, axes_[2].free}; }
  RowStencils row(int y, int z) const;

 private:
  std::array<BoxAxis, 3> axes_;
  double scale_;
};

/// A field of zeros on `free` vertices along each axis and one layer of fixed ones around them.
DenseField<float> box_field(Vec3i free);

/// Calls body(z) for the layers 1 .. free.z, in chunks that depend only on the box.
template <class Body>
void for_layers(Vec3i free, const Context& context, Body&& body) {
  constexpr size_t vertices_per_task = size_t{1} << 16;
  const size_t layer = static_cast<size_t>(free.x) * static_cast<size_t>(free.y);
  parallel_chunks(context, static_cast<size_t>(free.z), vertices_per_task / layer + 1, [&](size_t begin, size_t end) {
    for (size_t z = begin + 1; z <= end; ++z) body(static_cast<int>(z));
  });
}

/// A row and the four neighboring rows; each begins with the fixed vertex 0.
struct Rows {
  const float *here, *y_down, *y_up, *z_down, *z_up;
};
inline Rows rows_around(const DenseField<float>& u, int y, int z) {
  return {u.row(y, z), u.row(y - 1, z), u.row(y + 1, z), u.row(y, z - 1), u.row(y, z + 1)};
}

/// out = A u at the free vertices 1 .. free of a row.
void apply_row(const RowStencils& stencils, const Rows& u, int free, float* out);
/// out = b - A u.
void residual_row(const RowStencils& stencils, const Rows& u, const float* b, int free, float* out);
/// Gauss-Seidel: solves the equations of every second vertex, from `first` (1 or 2) on, for u there; writes u through
/// `here`, the row that u.here reads.
void relax_row(const RowStencils& stencils, const Rows& u, const float* b, int first, int free, float* here);

}  // namespace soapfilm
