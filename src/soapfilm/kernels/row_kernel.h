// What the loops over a band's rows need, as plain pointers: the interface between the fit and its kernels, which are
// compiled once per SIMD target and do not depend on bands or threads. Arrays are those of narrow_band.h: 8 floats per
// row, 0 at vertices outside the band; sums are the same for every target.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "soapfilm/core/vec.h"
#include "soapfilm/kernels/robust.h"

namespace soapfilm {

/// How many rows ahead kernels prefetch.
inline constexpr size_t rows_ahead = 16;

/// A band: rows next to each row along -x, +x, -y, +y, -z, +z, how many neighbors each vertex has, and each row's
/// vertices as bits. The neighbors of `rows_ahead` rows after the last may be read: they are row 0.
struct BandRows {
  const std::array<uint32_t, 6>* neighbors;
  const uint8_t* degree;
  const uint8_t* mask;
};

/// out = weight_v v + weight_g s G v; `share` s may be null: 1.
struct LaplacianJob {
  const float* v;
  float weight_v, weight_g;
  float* out;
  const float* share = nullptr;
};

/// out = beta (v - start) + gamma s (G v - R start), s = `share`, the factor of gamma; R sums the differences to
/// neighbors whose opposite neighbor is not in the band. Where both are, G v is the second difference of v, elsewhere
/// G v - R start is the slope of v - start alone: curvature is penalized up to the band boundary, and slopes there are
/// not.
struct CurvatureResidualJob {
  const float* v;
  const float* start;
  float beta, gamma;
  const float* share;
  float* out;
};

/// First step of Displacement::reweight_curvature(), its input to the local mean. At the band's vertices with six
/// neighbors: their curvature c = -G v, the weight 1 near the surface and `faint` elsewhere, the weight times
/// (c - target)^2. At the band boundary: c, faint, 0.
struct CurvatureJob {
  const float* v;
  const float* target;
  float reach, faint;  ///< near means |v| < reach
  float *curvature, *weight, *product;
};

/// product += weight (k1 - k2)^2 in the rows where a weight is 1: k1 and k2 are the principal curvatures of the level
/// sets of v, about a distance in voxels, (k1 - k2)^2 = 2 |D^2 v|^2 - (laplacian v)^2 by central differences, exact for
/// quadratic v; 0 where one of the eighteen vertices around is not in the band.
struct SaddleJob {
  const float* v;
  const float* weight;
  float* product;
};

/// Next step, where `around` holds the mean of that. share = 1 / (1 + per_square around) / (1 + x^2), the factor of
/// gamma; x is |distance| beyond `near` in units of `reach`. Then weight *= share, product = weight share curvature,
/// and `curvature` becomes 1 where a vertex has six neighbors. With fewer neighbors: share 1, product 0, curvature 0.
struct ShareJob {
  const float* around;
  const float* distance;
  float per_square, near, reach;
  float *share, *curvature, *weight, *product;
};

/// One level's system K x = b of the multigrid cycle, K x = diagonal x - sum_j w_ij x_j over the neighbors j, with
/// w_ij = diffusion (e_i + e_j) / 2; `extent` e may be null: 1. Jacobi steps divide by the diagonal, or where `inverse`
/// is null all have one length: then K x = reaction x + diffusion G x.
struct CycleJob {
  const float* inverse;  ///< omega / diagonal, 0 outside the band and without neighbors; null: see `step`
  const float* extent;
  const float* b;  ///< prolong_brick() takes null for 0
  float diffusion;
  float omega;     ///< damping of the Jacobi steps, in (0, 1)
  const float* x;  ///< smooth() starts from it
  float* out;
  const float* weight;              ///< smooth() returns <weight, out>; null: returns 0
  float step = 0;                   ///< without `inverse`: omega / (6 diffusion + reaction)
  float reaction = 0;               ///< without `inverse`
  const float* extended = nullptr;  ///< extent x, for restrict_residual() with an extent
};

/// Computes CycleJob's `inverse` from the diagonal of K: the neighbors' w_ij, sqrt(weight e) and reaction e.
struct InverseJob {
  const float* extent;   ///< e; may be null: 1
  const float* weights;  ///< of positions
  float diffusion, reaction, omega;
  float* inverse;
};

/// The data term of rows of cells: see CellSamples. out += scale times half of its gradient at v, or without `affine`
/// half of the gradient of its quadratic part.
struct DataJob {
  static constexpr size_t values = 7;  ///< per cell: place in it, unit normal times its certainty, weight

  const float* cells;      ///< a row's cells, stored value by value; eight may be read, beyond the end
  const uint32_t* first;   ///< cells before each row
  const uint8_t* present;  ///< which of a row's eight cells exist, as bits
  const uint32_t* row;     ///< row of the band with the lowest corners of each row of cells
  float normal, slope;     ///< weights of the normal and of the slope against one position
  bool affine;
  float scale;
  const float* v;  ///< null: 1 everywhere
  float* out;      ///< null: only the energy is computed
};

/// The samples of a brick, to be weighted and added to its cells: see CellSamples and Weighing.
struct SampleJob {
  static constexpr int corners = 9;  ///< of a brick's cells, along each axis
  static constexpr size_t sums = 8;  ///< per cell: weight times place in it, weight times normal, weight, 0

  const Vec3f *local, *direction;
  const float* sample_weight;  ///< may be null: all are 1
  const uint8_t* active;       ///< may be null: all are active
  size_t count;
  const float* phi;     ///< at the corners, x fastest
  const int32_t* cell;  ///< number of each of the 8^3 cells, x fastest; 0: outside the band
  Penalty penalty;
  float scale;
  bool directions;
  float doubt;
  float* cells;  ///< the sums of each
};

/// A fine brick and the coarse rows from which it interpolates: y = 0..4, z = 0..4 above half of it, y fastest, and
/// those right of them where that half is the upper one along x; 0: none.
struct BrickTransfer {
  static constexpr int side = 5;
  std::array<uint32_t, side * side> row, right;
  int half;              ///< where the brick starts in the coarse rows: 0 or 4
  uint32_t first;        ///< the brick's first row
  size_t count;          ///< the number of its rows
  const uint8_t* place;  ///< y + 8 z of each
};

/// The loops of one SIMD target: over rows [begin, end), or of one row.
struct RowKernel {
  /// Returns <G v, out>.
  double (*laplacian)(const BandRows& band, const LaplacianJob& job, size_t begin, size_t end);
  void (*bend)(const BandRows& band, const CurvatureResidualJob& job, size_t begin, size_t end);
  void (*curvature)(const BandRows& band, const CurvatureJob& job, size_t begin, size_t end);
  void (*saddles)(const BandRows& band, const SaddleJob& job, size_t begin, size_t end);
  void (*share)(const BandRows& band, const ShareJob& job, size_t begin, size_t end);
  void (*inverse)(const BandRows& band, const InverseJob& job, size_t begin, size_t end);
  /// coarse += P^T (b - K (inverse b)) of one brick: the residual after one Jacobi step from zero. With an extent, that
  /// step must already be in CycleJob's x; otherwise x is not used. Here and below, where `inverse` is null `step`
  /// replaces it.
  void (*restrict_residual)(const BandRows& band, const CycleJob& job, const BrickTransfer& transfer, float* coarse);
  /// out = x + inverse (b - K x).
  double (*smooth)(const BandRows& band, const CycleJob& job, size_t begin, size_t end);
  /// Rows of cells in sequence: neighbors share corners. Without `affine` returns <v, what is added, or would be>.
  double (*data_term)(const BandRows& band, const DataJob& job, size_t begin, size_t end);
  /// Adds in the order of the samples; returns how many have a weight below `doubt`.
  size_t (*add_samples)(const SampleJob& job);
  /// coarse += P^T from of one brick.
  void (*restrict_brick)(const BrickTransfer& transfer, const float* from, float* coarse);
  /// out = inverse b + P x on one brick, 0 where inverse is 0; x is coarse.
  void (*prolong_brick)(const BandRows& band, const CycleJob& job, const BrickTransfer& transfer);
};

/// Of Highway's SIMD targets among `bits`, and of the scalar version.
RowKernel highway_row_kernel(int64_t bits);
RowKernel scalar_row_kernel();

}  // namespace soapfilm
