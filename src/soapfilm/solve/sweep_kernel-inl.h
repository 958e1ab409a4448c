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

// Two rows of a brick that follow each other along y, a line of the cache, are stepped together: as one vector where
// there are 512 bits, elsewhere by at most 8 lanes.
constexpr int pair_size = 2 * brick_side;
#undef SOAPFILM_PAIR_IN_A_VECTOR
#define SOAPFILM_PAIR_IN_A_VECTOR (HWY_ARCH_X86 && HWY_MAX_BYTES >= 64)
#if SOAPFILM_PAIR_IN_A_VECTOR
using D = hn::CappedTag<float, pair_size>;
#else
using D = hn::CappedTag<float, brick_side>;
#endif
using V = hn::Vec<D>;
using M = hn::Mask<D>;

HWY_INLINE int lane_count() { return static_cast<int>(hn::Lanes(D())); }

/// The lanes from x on of a pair of rows that are at two places.
HWY_INLINE V load_rows(const float* first, const float* second, int x) {
#if SOAPFILM_PAIR_IN_A_VECTOR
  const hn::Half<D> row;
  return hn::Combine(D(), hn::LoadU(row, second + x), hn::LoadU(row, first + x));
#else
  return hn::LoadU(D(), x < brick_side ? first + x : second + x - brick_side);
#endif
}

/// `v`, the lanes from x on, with other values in the marked ones: one for each row.
HWY_INLINE V with_ends(M ends, const float* first, const float* second, int x, V v) {
  const D d;
#if SOAPFILM_PAIR_IN_A_VECTOR
  const hn::Half<D> row;
  (void)x;
  return hn::IfThenElse(ends, hn::Combine(d, hn::Set(row, *second), hn::Set(row, *first)), v);
#else
  return hn::IfThenElse(ends, hn::Set(d, x < brick_side ? *first : *second), v);
#endif
}

/// The lanes from x on, of the 16 of a pair as bits.
HWY_INLINE M lanes_of(unsigned pair, int x) {
  const uint8_t bits[8] = {static_cast<uint8_t>(pair >> x & 0xff), static_cast<uint8_t>(pair >> x >> 8)};
  return hn::LoadMaskBits(D(), bits);
}
HWY_INLINE unsigned bits_of(M lanes, int x) {
  uint8_t bits[8] = {};
  hn::StoreMaskBits(D(), lanes, bits);
  return static_cast<unsigned>(bits[0] | bits[1] << 8) << x;
}
/// A bit for each row of a pair.
HWY_INLINE RowMask rows_with(unsigned pair) { return ((pair & 0xff) != 0 ? 1u : 0u) | (pair > 0xff ? 2u : 0u); }

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
  const V tau = hn::Set(d, job.tau);
  const M first_lanes = lanes_of(0x0101, 0);
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

  HWY_ALIGN float cap_rows[4][pair_size] =
      {};  // bit 0 of the index: the first row has free vertices, bit 1: the second
  for (int k = 0; k < 4; ++k)
    for (int x = job.free_lo.x; x < job.free_hi.x; ++x) {
      cap_rows[k][x] = static_cast<float>(k & 1);
      cap_rows[k][x + brick_side] = static_cast<float>(k >> 1);
    }
  const RowMask free = free_rows(job.free_lo, job.free_hi);
  // Nothing is loaded from before the brick: that belongs to another brick, which another thread may be writing.
  float rows_0[pair_size] = {};
  for (int x = 1; x < pair_size; ++x) rows_0[x] = px[x - 1];

  RowMask moved = 0;
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

    const float* left_x = low_x.base + bit * low_x.inner;
    const float* below_x = bit == 0 ? rows_0 : px + row - 1;
    const float* below_y = first_y ? low_y.row(bit / brick_side) : py + row - brick_side;
    const float* below_z = bit < brick_side ? low_z.row(bit) : pz + row - brick_area;
    const float* cap = cap_rows[free >> bit & 3];
    unsigned moves = 0;
    for (int x = 0; x < pair_size; x += lane_count()) {
      V lower_x = hn::LoadU(d, below_x + x);
      if (x % brick_side == 0) lower_x = with_ends(first_lanes, left_x, left_x + low_x.inner, x, lower_x);
      const V old = hn::Load(d, u + row + x);
      const V dx = hn::Sub(lower_x, hn::Load(d, px + row + x));
      const V dy = hn::Sub(load_rows(below_y, py + row, x), hn::Load(d, py + row + x));
      const V dz = hn::Sub(hn::LoadU(d, below_z + x), hn::Load(d, pz + row + x));
      const V grad_t_p = hn::Add(hn::Add(dx, dy), dz);
      const V u_new = primal_step(old, grad_t_p, hn::Load(d, f + row + x), tau, hn::Load(d, cap + x));
      moves |= bits_of(hn::Ne(u_new, old), x);
      hn::Store(u_new, d, u + row + x);
      hn::Store(hn::Sub(hn::Add(u_new, u_new), old), d, u_bar + row + x);
    }
    face_x[bit] = u_bar[row];
    face_x[bit + 1] = u_bar[row + brick_side];
    moved |= rows_with(moves) << bit;
  }
  return moved;
}

/// Forward differences of u_bar.
struct Gradient {
  V x, y, z;
};

/// The u_bar that a brick's dual step reads, pair of rows by pair.
class UBarRows {
 public:
  explicit HWY_INLINE UBarRows(const DualJob& job)
      : u_bar_(job.u_bar),
        above_x_(job.above_x),
        above_y_(job.above_y),
        above_z_(job.above_z),
        last_lanes_(lanes_of(0x8080, pair_size - lane_count())) {}

  /// Of the vertices from x on of the pair whose first row is `bit`.
  HWY_INLINE Gradient forward_difference(int bit, int x) const {
    const D d;
    const float* rows = u_bar_ + bit * brick_side;
    const bool last_y = bit % brick_side == brick_side - 2, last_z = bit >= brick_area - brick_side;
    const float* next_y = last_y ? above_y_ + bit - (brick_side - 2) : rows + pair_size;
    const float* next_z = last_z ? above_z_ + (bit - (brick_area - brick_side)) * brick_side : rows + brick_area;
    const V here = hn::Load(d, rows + x);
    V next_x = hn::LoadU(d, rows + x + 1);
    if ((x + lane_count()) % brick_side == 0)
      next_x = with_ends(last_lanes_, above_x_ + bit, above_x_ + bit + 1, x, next_x);
    return {hn::Sub(next_x, here), hn::Sub(load_rows(rows + brick_side, next_y, x), here),
            hn::Sub(hn::LoadU(d, next_z + x), here)};
  }

 private:
  const float *u_bar_, *above_x_, *above_y_, *above_z_;
  M last_lanes_;
};

/// Calls step(bit, x) for the vertices from x on of each pair and gathers the rows in which a lane that it returns
/// lies.
template <class Step>
HWY_INLINE RowMask step_pairs(RowMask pairs, Step&& step) {
  RowMask moved = 0;
  for (; pairs != 0; pairs &= pairs - 1) {
    const int bit = std::countr_zero(pairs);
    unsigned moves = 0;
    for (int x = 0; x < pair_size; x += lane_count()) moves |= bits_of(step(bit, x), x);
    moved |= rows_with(moves) << bit;
  }
  return moved;
}

/// p of some vertices of a pair.
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

/// Where a component of p is fixed: on the brick's upper faces at the band's rim.
struct Fixed {
  M x, y, z;
};

HWY_INLINE Fixed fixed_flux(const DualJob& job, int bit, int x) {
  const bool last_y = bit % brick_side == brick_side - 2, last_z = bit >= brick_area - brick_side;
  return {lanes_of(job.fixed_up[0] ? 0x8080 : 0, x), lanes_of(job.fixed_up[1] && last_y ? 0xff00 : 0, x),
          lanes_of(job.fixed_up[2] && last_z ? 0xffff : 0, x)};
}

HWY_INLINE Flux with_fixed(const Fixed& fixed, const Flux& old, const Flux& q) {
  return {hn::IfThenElse(fixed.x, old.x, q.x), hn::IfThenElse(fixed.y, old.y, q.y),
          hn::IfThenElse(fixed.z, old.z, q.z)};
}

/// The same on the band's rim: fixed components keep their value and leave the others the ball's remaining radius.
HWY_INLINE void project_free(const Flux& old, const Fixed& fixed, V lambda_squared, Flux& q) {
  const D d;
  const Flux moving{hn::IfThenZeroElse(fixed.x, q.x), hn::IfThenZeroElse(fixed.y, q.y),
                    hn::IfThenZeroElse(fixed.z, q.z)};
  const Flux kept{hn::IfThenElseZero(fixed.x, old.x), hn::IfThenElseZero(fixed.y, old.y),
                  hn::IfThenElseZero(fixed.z, old.z)};
  const V radius_squared = hn::Max(hn::Sub(lambda_squared, norm_squared(kept)), hn::Zero(d));
  const V length_squared = norm_squared(moving);
  const M outside = hn::Gt(length_squared, radius_squared);
  if (!hn::AllFalse(d, outside)) {
    const V scale =
        hn::IfThenElse(outside, hn::Div(hn::Sqrt(radius_squared), hn::Sqrt(length_squared)), hn::Set(d, 1.0f));
    q = {hn::Mul(q.x, scale), hn::Mul(q.y, scale), hn::Mul(q.z, scale)};
  }
  q = with_fixed(fixed, old, q);
}

/// The isotropic norm's.
template <bool rim>
RowMask dual_by_length(const DualJob& job) {
  const D d;
  const V sigma = hn::Set(d, job.sigma);
  const V lambda = hn::Set(d, job.lambda);
  const V lambda_squared = hn::Mul(lambda, lambda);
  const UBarRows u_bar(job);
  float* p = job.p;
  return step_pairs(job.pairs, [&](int bit, int x) HWY_ATTR {
    float* at = p + bit * brick_side + x;
    const Flux old = load(at);
    const Gradient g = u_bar.forward_difference(bit, x);
    Flux q{hn::Add(old.x, hn::Mul(sigma, g.x)), hn::Add(old.y, hn::Mul(sigma, g.y)),
           hn::Add(old.z, hn::Mul(sigma, g.z))};
    if (rim) {
      project_free(old, fixed_flux(job, bit, x), lambda_squared, q);
    } else {
      project(lambda, lambda_squared, q);
    }
    return store(q, old, at);
  });
}

RowMask dual(const DualJob& job) {
  const bool rim = job.fixed_up[0] || job.fixed_up[1] || job.fixed_up[2];
  return rim ? dual_by_length<true>(job) : dual_by_length<false>(job);
}

/// The anisotropic norm's: the ball is a cube, so each component is clamped on its own and fixed ones stay.
RowMask dual_by_component(const DualJob& job) {
  const D d;
  const V sigma = hn::Set(d, job.sigma);
  const V lambda = hn::Set(d, job.lambda);
  const UBarRows u_bar(job);
  return step_pairs(job.pairs, [&](int bit, int x) HWY_ATTR {
    const auto step = [&](V p, V g)
                          HWY_ATTR { return hn::Min(hn::Max(hn::Add(p, hn::Mul(sigma, g)), hn::Neg(lambda)), lambda); };
    float* at = job.p + bit * brick_side + x;
    const Flux old = load(at);
    const Gradient g = u_bar.forward_difference(bit, x);
    const Flux q{step(old.x, g.x), step(old.y, g.y), step(old.z, g.z)};
    const Flux kept = with_fixed(fixed_flux(job, bit, x), old, q);
    return store(kept, old, at);
  });
}

}  // namespace

inline SweepKernel kernel(Norm norm) { return {&primal, norm == Norm::isotropic ? &dual : &dual_by_component}; }

}  // namespace soapfilm::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
