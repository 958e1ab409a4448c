// Geometric multigrid for -Laplace(u) = b on a box of any size: the preconditioner of conjugate gradients.
//
// Briggs, Henson and McCormick, A Multigrid Tutorial (2000), chapters 3 and 4. Coarsening is vertex-centred: the coarse
// vertex I is the fine vertex 2 I, and the border of u = 0 stays where it is, at a distance of 1/2 to 3/2 coarse cells
// from the last coarse vertex (see box_laplacian.h). So a box of any size converges like one of 2^k - 1 vertices.
#pragma once

#include <cstddef>
#include <vector>

#include "soapfilm/core/parallel.h"
#include "soapfilm/grid/dense_field.h"
#include "soapfilm/solve/box_laplacian.h"

namespace soapfilm {

/// Interpolation along one axis: linear between the coarse vertices and the border.
struct AxisTransfer {
  /// A fine vertex takes `low` of coarse vertex `coarse` and `high` of the next one.
  struct Weights {
    int coarse;
    float low, high;
  };
  BoxAxis fine, coarse;

  explicit AxisTransfer(const BoxAxis& axis);
  Weights at(int i) const;
};

/// One V-cycle from zero as a linear map z = B r, an approximate inverse of A. B is symmetric and positive definite:
/// Gauss-Seidel in red-black order before, in black-red order after the coarse correction, restriction the transpose of
/// interpolation. The values do not depend on the number of threads.
class Multigrid {
 public:
  /// For the 7-point matrix (6, -1 x 6) on `free` vertices along each axis, each >= 1.
  explicit Multigrid(Vec3i free);

  /// z = B r. Both are fields of free + 2 vertices; the border of r is not read, that of z must be zero and stays so.
  void precondition(const DenseField<float>& r, DenseField<float>& z, const Parallel& parallel);

  /// A itself.
  const BoxLaplacian& matrix() const { return levels_.front().matrix; }
  size_t levels() const { return levels_.size(); }
  /// Of the coarse levels' fields.
  size_t bytes() const;

 private:
  struct Level {
    BoxLaplacian matrix;
    std::array<BoxAxis, 3> axes;
    DenseField<float> b, x;  ///< the coarse levels' own; empty at the finest
  };

  void cycle(size_t level, const DenseField<float>& b, DenseField<float>& x, const Parallel& parallel);
  void restrict_residual(size_t fine, const DenseField<float>& b, const DenseField<float>& x, const Parallel& parallel);
  void add_correction(size_t fine, DenseField<float>& x, const Parallel& parallel) const;

  std::vector<Level> levels_;  ///< fine to coarse
};

/// A field of zeros on `free` vertices along each axis and one layer of fixed ones.
DenseField<float> box_field(Vec3i free);

/// Layers z = begin + 1 .. end of free vertices, in chunks that depend on the box alone.
template <class Body>
void for_layers(Vec3i free, const Parallel& parallel, Body&& body) {
  constexpr size_t vertices_per_task = size_t{1} << 16;
  const size_t layer = static_cast<size_t>(free.x) * static_cast<size_t>(free.y);
  parallel.for_chunks(static_cast<size_t>(free.z), vertices_per_task / layer + 1, [&](size_t begin, size_t end) {
    for (size_t z = begin + 1; z <= end; ++z) body(static_cast<int>(z));
  });
}

/// The row (y, z) of a field and its four neighbours.
inline Rows rows_around(const DenseField<float>& u, int y, int z) {
  return {u.row(y, z), u.row(y - 1, z), u.row(y + 1, z), u.row(y, z - 1), u.row(y, z + 1)};
}

}  // namespace soapfilm
