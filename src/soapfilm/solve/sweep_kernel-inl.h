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

/// The row of in-brick neighbours below x: lane 0 of a row's first lane group comes from outside. Nothing is loaded
/// from before the brick: that belongs to another brick, which another thread may be writing.
HWY_INLINE V load_below(const float* row, int x, float outside, bool first_row) {
  if (x != 0) return hn::LoadU(D(), row + x - 1);
  if (first_row) {
    float shifted[brick_side + 1];
    shifted[0] = outside;
    for (int i = 0; i < brick_side; ++i) shifted[i + 1] = row[i];
    return hn::LoadU(D(), shifted);
  }
  return hn::IfThenElse(hn::FirstN(D(), 1), hn::Set(D(), outside), hn::LoadU(D(), row - 1));
}

RowMask primal(const PrimalJob& job, UBar& u_bar) {
  const D d;
  const int lanes = static_cast<int>(hn::Lanes(D()));
  const V tau = hn::Set(d, job.tau);
  const float* px = job.p;
  const float* py = job.p + brick_volume;
  const float* pz = job.p + 2 * brick_volume;
  HWY_ALIGN float cap_row[brick_side];
  for (int x = 0; x < brick_side; ++x) cap_row[x] = x >= job.free_lo.x && x < job.free_hi.x ? 1.0f : 0.0f;

  RowMask moved = 0;
  for (RowMask left = job.rows; left != 0; left &= left - 1) {
    const int bit = std::countr_zero(left);
    const int y = bit % brick_side, z = bit / brick_side;
    const int row = bit * brick_side;
    const float* below_y = y == 0 ? job.low_y.row(z) : py + row - brick_side;
    const float* below_z = z == 0 ? job.low_z.row(y) : pz + row - brick_area;
    const float below_x = job.low_x.at(y, z);
    const bool free = y >= job.free_lo.y && y < job.free_hi.y && z >= job.free_lo.z && z < job.free_hi.z;
    float* bar = u_bar.values + y * UBar::row + z * UBar::layer;
    bool moves = false;
    hwy::Prefetch(job.next_u + row);
    hwy::Prefetch(job.after_next_p + row);
    hwy::Prefetch(job.next_p + brick_volume + row);
    hwy::Prefetch(job.next_p + 2 * brick_volume + row);
    hwy::Prefetch(job.next_f + row);
    if (y == 0) hwy::Prefetch(job.next_low_y.row(z));
    if (z == 0) hwy::Prefetch(job.next_low_z.row(y));
    for (int x = 0; x < brick_side; x += lanes) {
      const V cap = free ? hn::Load(d, cap_row + x) : hn::Zero(d);
      const V u = hn::Load(d, job.u + row + x);
      const V dx = hn::Sub(load_below(px + row, x, below_x, row == 0), hn::Load(d, px + row + x));
      const V dy = hn::Sub(hn::LoadU(d, below_y + x), hn::Load(d, py + row + x));
      const V dz = hn::Sub(hn::LoadU(d, below_z + x), hn::Load(d, pz + row + x));
      const V grad_t_p = hn::Add(hn::Add(dx, dy), dz);
      const V u_new = primal_step(u, grad_t_p, hn::Load(d, job.f + row + x), tau, cap);
      moves |= !hn::AllFalse(d, hn::Ne(u_new, u));
      hn::Store(u_new, d, job.u + row + x);
      hn::Store(hn::Sub(hn::Add(u_new, u_new), u), d, bar + x);
    }
    if (moves) moved |= RowMask{1} << bit;
  }
  return moved;
}

/// Forward differences of u_bar at a row.
struct Gradient {
  V x, y, z;
};

HWY_INLINE Gradient forward_difference(const float* bar) {
  const D d;
  const V here = hn::Load(d, bar);
  return {hn::Sub(hn::LoadU(d, bar + 1), here), hn::Sub(hn::Load(d, bar + UBar::row), here),
          hn::Sub(hn::Load(d, bar + UBar::layer), here)};
}

HWY_INLINE bool differ(V old_x, V new_x, V old_y, V new_y, V old_z, V new_z) {
  const M some = hn::Or(hn::Or(hn::Ne(new_x, old_x), hn::Ne(new_y, old_y)), hn::Ne(new_z, old_z));
  return !hn::AllFalse(D(), some);
}

/// The isotropic norm's.
RowMask dual(const DualJob& job, const UBar& u_bar) {
  const D d;
  const int lanes = static_cast<int>(hn::Lanes(D()));
  const V sigma = hn::Set(d, job.sigma);
  const V lambda = hn::Set(d, job.lambda);
  const V lambda_squared = hn::Mul(lambda, lambda);
  const bool rim = job.fixed_up[0] || job.fixed_up[1] || job.fixed_up[2];

  RowMask moved = 0;
  for (RowMask left = job.rows; left != 0; left &= left - 1) {
    const int bit = std::countr_zero(left);
    const int y = bit % brick_side, z = bit / brick_side;
    const bool fixed_y = job.fixed_up[1] && y == brick_side - 1;
    const bool fixed_z = job.fixed_up[2] && z == brick_side - 1;
    bool moved_here = false;
    for (int x = 0; x < brick_side; x += lanes) {
      float* px = job.p + bit * brick_side + x;
      float* py = px + brick_volume;
      float* pz = py + brick_volume;
      const V old_x = hn::Load(d, px), old_y = hn::Load(d, py), old_z = hn::Load(d, pz);
      const Gradient g = forward_difference(u_bar.values + x + y * UBar::row + z * UBar::layer);
      V qx = hn::Add(old_x, hn::Mul(sigma, g.x));
      V qy = hn::Add(old_y, hn::Mul(sigma, g.y));
      V qz = hn::Add(old_z, hn::Mul(sigma, g.z));
      if (!rim) {
        const V norm_squared = hn::Add(hn::Add(hn::Mul(qx, qx), hn::Mul(qy, qy)), hn::Mul(qz, qz));
        const M outside = hn::Gt(norm_squared, lambda_squared);
        if (!hn::AllFalse(d, outside)) {
          const V scale = hn::IfThenElse(outside, hn::Div(lambda, hn::Sqrt(norm_squared)), hn::Set(d, 1.0f));
          qx = hn::Mul(qx, scale);
          qy = hn::Mul(qy, scale);
          qz = hn::Mul(qz, scale);
        }
      } else {
        // Fixed components keep their value and leave the others the ball's remaining radius.
        const V zero = hn::Zero(d);
        const M last = hn::Eq(hn::Iota(d, static_cast<float>(x)), hn::Set(d, static_cast<float>(brick_side - 1)));
        const M fixed_x = hn::And(last, hn::Eq(zero, hn::Set(d, job.fixed_up[0] ? 0.0f : 1.0f)));
        const V free_x = hn::IfThenElse(fixed_x, zero, qx);
        const V free_y = fixed_y ? zero : qy;
        const V free_z = fixed_z ? zero : qz;
        const V kept_x = hn::IfThenElseZero(fixed_x, old_x);
        const V kept_y = fixed_y ? old_y : zero;
        const V kept_z = fixed_z ? old_z : zero;
        const V kept_squared =
            hn::Add(hn::Add(hn::Mul(kept_x, kept_x), hn::Mul(kept_y, kept_y)), hn::Mul(kept_z, kept_z));
        const V radius_squared = hn::Max(hn::Sub(lambda_squared, kept_squared), zero);
        const V norm_squared =
            hn::Add(hn::Add(hn::Mul(free_x, free_x), hn::Mul(free_y, free_y)), hn::Mul(free_z, free_z));
        const M outside = hn::Gt(norm_squared, radius_squared);
        const V scale =
            hn::IfThenElse(outside, hn::Div(hn::Sqrt(radius_squared), hn::Sqrt(norm_squared)), hn::Set(d, 1.0f));
        qx = hn::IfThenElse(fixed_x, old_x, hn::Mul(qx, scale));
        qy = fixed_y ? old_y : hn::Mul(qy, scale);
        qz = fixed_z ? old_z : hn::Mul(qz, scale);
      }
      hn::Store(qx, d, px);
      hn::Store(qy, d, py);
      hn::Store(qz, d, pz);
      moved_here |= differ(old_x, qx, old_y, qy, old_z, qz);
    }
    if (moved_here) moved |= RowMask{1} << bit;
  }
  return moved;
}

/// The anisotropic norm's: the ball is a cube, so each component is clamped on its own and fixed ones stay.
RowMask dual_by_component(const DualJob& job, const UBar& u_bar) {
  const D d;
  const int lanes = static_cast<int>(hn::Lanes(D()));
  const V sigma = hn::Set(d, job.sigma);
  const V lambda = hn::Set(d, job.lambda);
  const auto step = [&](V p, V g) { return hn::Min(hn::Max(hn::Add(p, hn::Mul(sigma, g)), hn::Neg(lambda)), lambda); };
  RowMask moved = 0;
  for (RowMask left = job.rows; left != 0; left &= left - 1) {
    const int bit = std::countr_zero(left);
    const int y = bit % brick_side, z = bit / brick_side;
    const bool fixed_y = job.fixed_up[1] && y == brick_side - 1;
    const bool fixed_z = job.fixed_up[2] && z == brick_side - 1;
    float* row = job.p + bit * brick_side;
    const float last_x = row[brick_side - 1];
    bool moved_here = false;
    for (int x = 0; x < brick_side; x += lanes) {
      float* px = row + x;
      float* py = px + brick_volume;
      float* pz = py + brick_volume;
      const Gradient g = forward_difference(u_bar.values + x + y * UBar::row + z * UBar::layer);
      const V old_x = hn::Load(d, px), old_y = hn::Load(d, py), old_z = hn::Load(d, pz);
      const V qx = step(old_x, g.x);
      const V qy = fixed_y ? old_y : step(old_y, g.y);
      const V qz = fixed_z ? old_z : step(old_z, g.z);
      hn::Store(qx, d, px);
      hn::Store(qy, d, py);
      hn::Store(qz, d, pz);
      moved_here |= differ(old_x, qx, old_y, qy, old_z, qz);
    }
    if (job.fixed_up[0]) row[brick_side - 1] = last_x;
    if (moved_here) moved |= RowMask{1} << bit;
  }
  return moved;
}

}  // namespace

inline SweepKernel kernel(Norm norm) { return {&primal, norm == Norm::isotropic ? &dual : &dual_by_component}; }

}  // namespace soapfilm::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
