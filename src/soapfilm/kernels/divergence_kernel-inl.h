// The smoothed divergence of one brick, compiled once per SIMD target (no include guard: see Highway's
// foreach_target.h). No fused multiply-add: every target rounds in the same way. Rows that are zero are left out, which
// changes no sum: sums start at +0 and never become -0.

#include <hwy/highway.h>

#include "soapfilm/grid/smoothing.h"
#include "soapfilm/kernels/divergence_kernel.h"

HWY_BEFORE_NAMESPACE();
namespace soapfilm::HWY_NAMESPACE {
namespace {  // the scalar target is compiled twice: as a dispatched one and alone

namespace hn = hwy::HWY_NAMESPACE;

// At most a row of a brick: 8 lanes, fewer where the target has fewer.
using D = hn::CappedTag<float, brick_side>;
using V = hn::Vec<D>;

constexpr int reach = SplatWindow::reach;
constexpr int side = SplatWindow::side;
constexpr int taps = 2 * reach + 1;
constexpr unsigned taps_mask = (1u << taps) - 1;
static_assert(side == 16);

// The smoothing kernel k (box filter, n = 3) and its central difference k'(j) = (k(j + 1) - k(j - 1)) / 2 as the taps
// of one pass: divergence after smoothing is one pass of k' along the component's own axis and of k along the others.
struct Taps {
  float smoothing[taps] = {};
  float difference[taps] = {};
};
constexpr Taps make_taps() {
  // Output x is sum_j in(x + j) * (k(j - 1) - k(j + 1)) / 2: k is even.
  constexpr int k[] = {0, 0, 1, 3, 6, 7, 6, 3, 1, 0, 0};
  Taps t;
  for (int j = 0; j < taps; ++j) t.difference[j] = static_cast<float>(k[j] - k[j + 2]) / 54.0f;
  for (int j = 0; j < static_cast<int>(smoothing_taps.size()); ++j)
    t.smoothing[j + reach - smoothing_reach] = smoothing_taps[static_cast<size_t>(j)];
  return t;
}
constexpr Taps weights = make_taps();

/// One pass along x: lanes of 8 outputs from a row of 16. Taps of zero are at the ends and in the middle.
template <int first>
HWY_INLINE V filter_x(const float* row, const float (&tap)[taps]) {
  V sum = hn::Zero(D());
  for (int j = first; j < taps - first; ++j) sum = hn::Add(sum, hn::Mul(hn::Set(D(), tap[j]), hn::LoadU(D(), row + j)));
  return sum;
}

struct Passes {
  // Rows of 8 after the pass along x: [z][y][component]; after y: [z][y], the sum of the components x and y (they have
  // the same last pass), and component z.
  alignas(64) float after_x[side * side * 3 * brick_side];
  alignas(64) float after_y[side * brick_side * 2 * brick_side];
  uint16_t layers[brick_side];  // bit z of [y]: after y the row may have values other than zero

  float* x(int y, int z, int component) { return after_x + ((z * side + y) * 3 + component) * brick_side; }
  float* y(int y, int z, int part) { return after_y + ((z * brick_side + y) * 2 + part) * brick_side; }
};

void pass_x(SplatWindow& window, Passes& p) {
  const D d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  for (int z = 0; z < side; ++z)
    for (unsigned rows = window.occupied[static_cast<size_t>(z)]; rows != 0; rows &= rows - 1) {
      const int y = __builtin_ctz(rows);
      for (int x = 0; x < brick_side; x += lanes) {
        hn::Store(filter_x<0>(window.row(y, z, 0) + x, weights.difference), d, p.x(y, z, 0) + x);
        hn::Store(filter_x<1>(window.row(y, z, 1) + x, weights.smoothing), d, p.x(y, z, 1) + x);
        hn::Store(filter_x<1>(window.row(y, z, 2) + x, weights.smoothing), d, p.x(y, z, 2) + x);
      }
      for (int i = 0; i < 3 * side; i += lanes) hn::Store(hn::Zero(d), d, window.row(y, z, 0) + i);
    }
}

void pass_y(const SplatWindow::Rows& occupied, Passes& p) {
  const D d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  for (uint16_t& bits : p.layers) bits = 0;
  for (int z = 0; z < side; ++z)
    for (int y = 0; y < brick_side; ++y) {
      const unsigned from = occupied[static_cast<size_t>(z)] >> y & taps_mask;
      if (from == 0) continue;
      p.layers[y] = static_cast<uint16_t>(p.layers[y] | 1u << z);
      for (int x = 0; x < brick_side; x += lanes) {
        V sum = hn::Zero(d), other = hn::Zero(d), only_z = hn::Zero(d);
        for (unsigned rows = from; rows != 0; rows &= rows - 1) {
          const int j = __builtin_ctz(rows);
          const float* in = p.x(y + j, z, 0) + x;
          const V smooth = hn::Set(d, weights.smoothing[j]);
          sum = hn::Add(sum, hn::Mul(smooth, hn::Load(d, in)));
          other = hn::Add(other, hn::Mul(hn::Set(d, weights.difference[j]), hn::Load(d, in + brick_side)));
          only_z = hn::Add(only_z, hn::Mul(smooth, hn::Load(d, in + 2 * brick_side)));
        }
        hn::Store(hn::Add(sum, other), d, p.y(y, z, 0) + x);
        hn::Store(only_z, d, p.y(y, z, 1) + x);
      }
    }
}

void pass_z(Passes& p, float* f) {
  const D d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  for (int z = 0; z < brick_side; ++z)
    for (int y = 0; y < brick_side; ++y) {
      const unsigned from = p.layers[y] >> z & taps_mask;
      if (from == 0) continue;
      for (int x = 0; x < brick_side; x += lanes) {
        V sum = hn::Zero(d), other = hn::Zero(d);
        for (unsigned rows = from; rows != 0; rows &= rows - 1) {
          const int j = __builtin_ctz(rows);
          const float* in = p.y(y, z + j, 0) + x;
          sum = hn::Add(sum, hn::Mul(hn::Set(d, weights.smoothing[j]), hn::Load(d, in)));
          other = hn::Add(other, hn::Mul(hn::Set(d, weights.difference[j]), hn::Load(d, in + brick_side)));
        }
        hn::StoreU(hn::Add(sum, other), d, f + brick_offset(x, y, z));
      }
    }
}

/// Separable: x, then y, then z.
void divergence(SplatWindow& window, float* f) {
  Passes p;  // written before it is read
  pass_x(window, p);
  pass_y(window.occupied, p);
  pass_z(p, f);
  window.occupied = {};
}

}  // namespace

inline DivergenceKernel kernel() { return &divergence; }

}  // namespace soapfilm::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
