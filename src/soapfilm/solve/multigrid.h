// Geometric multigrid for -Laplace(u) = b on a box of any size: the preconditioner of conjugate gradients.
//
// Briggs, Henson and McCormick, A Multigrid Tutorial (2000), chapters 3 and 4. Coarsening is vertex-centered: the
// coarse vertex I is the fine vertex 2 I, and the border of u = 0 stays where it is, at a distance of 1/2 to 3/2 coarse
// cells from the last coarse vertex (see box_laplacian.h). So a box of any size converges like one of 2^k - 1 vertices.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "soapfilm/context.h"
#include "soapfilm/grid/dense_field.h"
#include "soapfilm/solve/box_laplacian.h"

namespace soapfilm {

/// Interpolation along one axis: linear between the coarse vertices and the border.
struct AxisTransfer {
  struct Share {
    int coarse;  ///< vertex of the coarse axis
    float weight;
  };
  BoxAxis fine, coarse;

  explicit AxisTransfer(const BoxAxis& axis);
  /// Weights of the coarse vertex below (or at) fine vertex i and of the one above; 0 where that is fixed.
  std::array<Share, 2> at(int i) const;
};

/// One V-cycle from zero as a linear map z = B r, an approximate inverse of A. B is symmetric and positive definite:
/// Gauss-Seidel in red-black order before, in black-red order after the coarse correction, restriction the transpose of
/// interpolation. The values do not depend on the number of threads.
class Multigrid {
 public:
  /// For the 7-point matrix (6, -1 x 6) on `free` vertices along each axis, each >= 1.
  explicit Multigrid(Vec3i free);

  /// z = B r. Both are fields of free + 2 vertices; the border of r is not read, that of z must be zero and stays zero.
  void precondition(const DenseField<float>& r, DenseField<float>& z, const Context& context);

  /// The matrix A.
  const BoxLaplacian& matrix() const { return levels_.front().matrix; }
  size_t levels() const { return levels_.size(); }
  /// Memory of the coarse levels' fields.
  size_t bytes() const;

 private:
  struct Level {
    BoxLaplacian matrix;
    DenseField<float> b, x;  ///< of the coarse levels; empty at the finest
  };

  void cycle(size_t level, const DenseField<float>& b, DenseField<float>& x, const Context& context);
  void restrict_residual(size_t fine, const DenseField<float>& b, const DenseField<float>& x, const Context& context);
  void add_correction(size_t fine, DenseField<float>& x, const Context& context) const;

  std::vector<Level> levels_;  ///< fine to coarse
};

}  // namespace soapfilm
