// The kernels of a sweep, compiled once per SIMD target (no include guard: see Highway's foreach_target.h).
// No fused multiply-add, no reciprocal estimates: every target rounds alike.

#include <hwy/cache_control.h>
#include <hwy/highway.h>

#include <bit>

#include "soapfilm/solve/sweep_kernel.h"

HWY_BEFORE_NAMESPACE();
namespace soapfilm::HWY_NAMESPACE {
namespace {  // the scalar target is compiled twice: among the dispatched ones and on its own

namespace hn = hwy::HWY_NAMESPACE;

// At most a row of a brick: 8 lanes, fewer where the target has fewer.
using D = hn::CappedTag<float, brick_side>;
using V = hn::Vec<D>;
using M = hn::Mask<D>;

/// u - tau (grad^T p - f), clipped to [0, cap].
HWY_INLINE V primal_step(V u, V grad_t_p, V f, V tau, V cap) {
  const V moved = hn::Sub(u, hn::Mul(tau, hn::Sub(grad_t_p, f)));
  return hn::Min(hn::Max(moved, hn::Zero(D())), cap);
}

/// Which rows hold a free vertex.
RowMask free_rows(Vec3i lo, Vec3i hi) {
  const RowMask layer = (RowMask{1} << hi.y) - (RowMask{1} << lo.y);
  RowMask rows = 0;
  for (int z = lo.z; z < hi.z; ++z) rows |= layer << (brick_side * z);
  return hi.y > lo.y ? rows : 0;
}

RowMask primal(const PrimalJob& job) {
  const D d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const V tau = hn::Set(d, job.tau);
  const M first_lane = hn::FirstN(d, 1);
  float* HWY_RESTRICT u = job.u;
  float* HWY_RESTRICT u_bar = job.u_bar;
  float* HWY_RESTRICT face_x = job.face_x;
  const float* f = job.f;
  const float* px = job.p;
  const float* py = px + brick_volume;
  const float* pz = py + brick_volume;
  const LowFace low_x = job.low_x, low_y = job.low_y, low_z = job.low_z;
  const LowFace next_low_y = job.next_low_y, next_low_z = job.next_low_z;
  const float *next_u = job.next_u, *next_p = job.next_p, *next_f = job.next_f, *after_next_p = job.after_next_p;

  HWY_ALIGN float cap_row[2][brick_side] = {};  // of a row without, with free vertices
  for (int x = job.free_lo.x; x < job.free_hi.x; ++x) cap_row[1][x] = 1;
  const RowMask free = free_rows(job.free_lo, job.free_hi);
  // Nothing is loaded from before the brick: that belongs to another brick, which another thread may be writing.
  float row_0[brick_side + 1] = {};
  for (int x = 0; x < brick_side; ++x) row_0[x + 1] = px[x];

  RowMask moved = 0;
  const auto step_row = [&](int bit, const float* below_y) HWY_ATTR {
    const int row = bit * brick_side;
    const float* below_x = bit == 0 ? row_0 : px + row - 1;
    const float* below_z = bit < brick_side ? low_z.row(bit) : pz + row - brick_area;
    const float* cap = cap_row[free >> bit & 1];
    M moves = hn::FirstN(d, 0);
    for (int x = 0; x < brick_side; x += lanes) {
      V lower_x = hn::LoadU(d, below_x + x);
      if (x == 0) lower_x = hn::IfThenElse(first_lane, hn::Set(d, low_x.base[bit * low_x.inner]), lower_x);
      const V old = hn::Load(d, u + row + x);
      const V dx = hn::Sub(lower_x, hn::Load(d, px + row + x));
      const V dy = hn::Sub(hn::LoadU(d, below_y + x), hn::Load(d, py + row + x));
      const V dz = hn::Sub(hn::LoadU(d, below_z + x), hn::Load(d, pz + row + x));
      const V grad_t_p = hn::Add(hn::Add(dx, dy), dz);
      const V u_new = primal_step(old, grad_t_p, hn::Load(d, f + row + x), tau, hn::Load(d, cap + x));
      const V bar = hn::Sub(hn::Add(u_new, u_new), old);
      moves = hn::Or(moves, hn::Ne(u_new, old));
      hn::Store(u_new, d, u + row + x);
      hn::Store(bar, d, u_bar + row + x);
      if (x == 0) face_x[bit] = hn::GetLane(bar);
    }
    moved |= RowMask{!hn::AllFalse(d, moves)} << bit;
  };
  for (RowMask left = job.pairs; left != 0; left &= left - 1) {
    const int bit = std::countr_zero(left);
    const int row = bit * brick_side;
    const bool first_y = bit % brick_side == 0;
    hwy::Prefetch(next_u + row);
    hwy::Prefetch(after_next_p + row);
    hwy::Prefetch(next_p + brick_volume + row);
    hwy::Prefetch(next_p + 2 * brick_volume + row);
    hwy::Prefetch(next_f + row);
    if (first_y) hwy::Prefetch(next_low_y.row(bit / brick_side));
    if (bit < brick_side) hwy::Prefetch(next_low_z.row(bit));
    step_row(bit, first_y ? low_y.row(bit / brick_side) : py + row - brick_side);
    step_row(bit + 1, py + row);
  }
  return moved;
}

/// Forward differences of u_bar.
struct Gradient {
  V x, y, z;
};

/// The u_bar that a brick's dual step reads, row by row.
class UBarRows {
 public:
  explicit HWY_INLINE UBarRows(const DualJob& job)
      : u_bar_(job.u_bar),
        above_x_(job.above_x),
        above_y_(job.above_y),
        above_z_(job.above_z),
        inner_lanes_(hn::FirstN(D(), hn::Lanes(D()) - 1)) {}

  HWY_INLINE Gradient forward_difference(int bit, int x) const {
    const D d;
    const int lanes = static_cast<int>(hn::Lanes(d));
    const float* row = u_bar_ + bit * brick_side;
    const bool last_y = bit % brick_side == brick_side - 1, last_z = bit >= brick_area - brick_side;
    const float* next_y = last_y ? above_y_ + bit - (brick_side - 1) : row + brick_side;
    const float* next_z = last_z ? above_z_ + (bit - (brick_area - brick_side)) * brick_side : row + brick_area;
    const V here = hn::Load(d, row + x);
    V next_x = hn::LoadU(d, row + x + 1);
    if (x + lanes == brick_side) next_x = hn::IfThenElse(inner_lanes_, next_x, hn::Set(d, above_x_[bit]));
    return {hn::Sub(next_x, here), hn::Sub(hn::LoadU(d, next_y + x), here), hn::Sub(hn::LoadU(d, next_z + x), here)};
  }

 private:
  const float *u_bar_, *above_x_, *above_y_, *above_z_;
  M inner_lanes_;
};

/// Calls step(bit) for both rows of each pair, and gathers the rows for which it says that a value has changed.
template <class Step>
HWY_INLINE RowMask step_pairs(RowMask pairs, Step&& step) {
  RowMask moved = 0;
  for (; pairs != 0; pairs &= pairs - 1) {
    const int bit = std::countr_zero(pairs);
    moved |= RowMask{step(bit)} << bit;
    moved |= RowMask{step(bit + 1)} << (bit + 1);
  }
  return moved;
}

/// p of some vertices of a row.
struct Flux {
  V x, y, z;
};

HWY_INLINE Flux load(const float* p) {
  const D d;
  return {hn::Load(d, p), hn::Load(d, p + brick_volume), hn::Load(d, p + 2 * brick_volume)};
}

/// Where a value has changed.
HWY_INLINE M store(const Flux& now, const Flux& old, float* p) {
  const D d;
  hn::Store(now.x, d, p);
  hn::Store(now.y, d, p + brick_volume);
  hn::Store(now.z, d, p + 2 * brick_volume);
  return hn::Or(hn::Or(hn::Ne(now.z, old.z), hn::Ne(now.y, old.y)), hn::Ne(now.x, old.x));
}

HWY_INLINE V norm_squared(const Flux& q) {
  return hn::Add(hn::Add(hn::Mul(q.x, q.x), hn::Mul(q.y, q.y)), hn::Mul(q.z, q.z));
}

/// Projects q onto the ball.
HWY_INLINE void project(V lambda, V lambda_squared, Flux& q) {
  const D d;
  const V length_squared = norm_squared(q);
  const M outside = hn::Gt(length_squared, lambda_squared);
  if (hn::AllFalse(d, outside)) return;
  const V scale = hn::IfThenElse(outside, hn::Div(lambda, hn::Sqrt(length_squared)), hn::Set(d, 1.0f));
  q = {hn::Mul(q.x, scale), hn::Mul(q.y, scale), hn::Mul(q.z, scale)};
}

/// The same on the band's rim: fixed components keep their value and leave the others the ball's remaining radius.
HWY_INLINE void project_free(const Flux& old, M fixed_x, bool fixed_y, bool fixed_z, V lambda_squared, Flux& q) {
  const D d;
  const V zero = hn::Zero(d);
  const Flux moving{hn::IfThenZeroElse(fixed_x, q.x), fixed_y ? zero : q.y, fixed_z ? zero : q.z};
  const Flux kept{hn::IfThenElseZero(fixed_x, old.x), fixed_y ? old.y : zero, fixed_z ? old.z : zero};
  const V radius_squared = hn::Max(hn::Sub(lambda_squared, norm_squared(kept)), zero);
  const V length_squared = norm_squared(moving);
  const M outside = hn::Gt(length_squared, radius_squared);
  const V scale =
      hn::IfThenElse(outside, hn::Div(hn::Sqrt(radius_squared), hn::Sqrt(length_squared)), hn::Set(d, 1.0f));
  q.x = hn::IfThenElse(fixed_x, old.x, hn::Mul(q.x, scale));
  q.y = fixed_y ? old.y : hn::Mul(q.y, scale);
  q.z = fixed_z ? old.z : hn::Mul(q.z, scale);
}

/// The lanes from x on whose p_x is free: all, but for a row's last one on the band's rim.
HWY_INLINE M free_along_x(const DualJob& job, int x) {
  const D d;
  return hn::FirstN(d, job.fixed_up[0] ? static_cast<size_t>(brick_side - 1 - x) : hn::Lanes(d));
}
HWY_INLINE bool fixed_up_y(const DualJob& job, int bit) {
  return job.fixed_up[1] && bit % brick_side == brick_side - 1;
}
HWY_INLINE bool fixed_up_z(const DualJob& job, int bit) { return job.fixed_up[2] && bit >= brick_area - brick_side; }

/// The isotropic norm's.
template <bool rim>
RowMask dual_by_length(const DualJob& job) {
  const D d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const V sigma = hn::Set(d, job.sigma);
  const V lambda = hn::Set(d, job.lambda);
  const V lambda_squared = hn::Mul(lambda, lambda);
  const UBarRows u_bar(job);
  float* p = job.p;
  return step_pairs(job.pairs, [&](int bit) HWY_ATTR {
    M moved = hn::FirstN(d, 0);
    for (int x = 0; x < brick_side; x += lanes) {
      float* at = p + bit * brick_side + x;
      const Flux old = load(at);
      const Gradient g = u_bar.forward_difference(bit, x);
      Flux q{hn::Add(old.x, hn::Mul(sigma, g.x)), hn::Add(old.y, hn::Mul(sigma, g.y)),
             hn::Add(old.z, hn::Mul(sigma, g.z))};
      if (rim) {
        project_free(old, hn::Not(free_along_x(job, x)), fixed_up_y(job, bit), fixed_up_z(job, bit), lambda_squared, q);
      } else {
        project(lambda, lambda_squared, q);
      }
      moved = hn::Or(moved, store(q, old, at));
    }
    return !hn::AllFalse(d, moved);
  });
}

RowMask dual(const DualJob& job) {
  const bool rim = job.fixed_up[0] || job.fixed_up[1] || job.fixed_up[2];
  return rim ? dual_by_length<true>(job) : dual_by_length<false>(job);
}

/// The anisotropic norm's: the ball is a cube, so each component is clamped on its own and fixed ones stay.
RowMask dual_by_component(const DualJob& job) {
  const D d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const V sigma = hn::Set(d, job.sigma);
  const V lambda = hn::Set(d, job.lambda);
  const UBarRows u_bar(job);
  return step_pairs(job.pairs, [&](int bit) HWY_ATTR {
    const auto step = [&](V p, V g)
                          HWY_ATTR { return hn::Min(hn::Max(hn::Add(p, hn::Mul(sigma, g)), hn::Neg(lambda)), lambda); };
    float* row = job.p + bit * brick_side;
    M moved = hn::FirstN(d, 0);
    for (int x = 0; x < brick_side; x += lanes) {
      const Flux old = load(row + x);
      const Gradient g = u_bar.forward_difference(bit, x);
      const M free_x = free_along_x(job, x);
      const Flux q{hn::IfThenElse(free_x, step(old.x, g.x), old.x), fixed_up_y(job, bit) ? old.y : step(old.y, g.y),
                   fixed_up_z(job, bit) ? old.z : step(old.z, g.z)};
      moved = hn::Or(moved, store(q, old, row + x));
    }
    return !hn::AllFalse(d, moved);
  });
}

}  // namespace

inline SweepKernel kernel(Norm norm) { return {&primal, norm == Norm::isotropic ? &dual : &dual_by_component}; }

}  // namespace soapfilm::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
