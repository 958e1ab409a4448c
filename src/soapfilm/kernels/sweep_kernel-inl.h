// The kernels of a sweep, compiled once per SIMD target (no include guard: see Highway's foreach_target.h).
// No fused multiply-add, no reciprocal estimates: every target rounds in the same way.

#include <hwy/cache_control.h>
#include <hwy/highway.h>

#include <array>

#include "soapfilm/kernels/sweep_kernel.h"

HWY_BEFORE_NAMESPACE();
namespace soapfilm::HWY_NAMESPACE {
namespace {  // the scalar target is compiled twice: as a dispatched one and alone

namespace hn = hwy::HWY_NAMESPACE;

// Two rows of a brick that are adjacent along y, one cache line, are stepped together: as one vector with 512 bits,
// otherwise by at most 8 lanes.
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

/// The lanes from x on of a pair of rows stored in two places.
HWY_INLINE V load_rows(const float* first, const float* second, int x) {
#if SOAPFILM_PAIR_IN_A_VECTOR
  const hn::Half<D> row;
  return hn::Combine(D(), hn::LoadU(row, second + x), hn::LoadU(row, first + x));
#else
  return hn::LoadU(D(), x < brick_side ? first + x : second + x - brick_side);
#endif
}

/// `v`, the lanes from x on, with the marked lanes replaced: one value for each row.
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

/// The lanes from x on, of the 16 of a pair given as bits.
HWY_INLINE M lanes_of(unsigned pair, int x) {
  const uint8_t bits[8] = {static_cast<uint8_t>(pair >> x & 0xff), static_cast<uint8_t>(pair >> x >> 8)};
  return hn::LoadMaskBits(D(), bits);
}
/// The lanes from x on of the pair whose first row is y, as bits of the layer's 64 vertices.
HWY_INLINE uint64_t bits_of(M lanes, int y, int x) {
  uint8_t bits[8] = {};
  hn::StoreMaskBits(D(), lanes, bits);
  return static_cast<uint64_t>(bits[0] | bits[1] << 8) << (brick_side * y + x);
}
/// A bit for each of a layer's rows with a marked vertex.
HWY_INLINE RowMask rows_with(uint64_t vertices) {
  constexpr uint64_t low_bits = 0x7f7f7f7f7f7f7f7f;
  const uint64_t high_bits = (((vertices & low_bits) + low_bits) | vertices) & ~low_bits;
  return (high_bits >> 7) * 0x0102040810204080 >> 56;
}

/// Calls layer_at(z) for each layer of the brick with marked pairs of rows, and its step(y) for each of these pairs by
/// its first row. A step returns which of the layer's vertices have changed; their rows are collected. A step's y is a
/// constant: so is the distance of all its loads from the layer's first values.
template <class LayerAt>
HWY_INLINE RowMask step_pairs(RowMask pairs, LayerAt&& layer_at) {
  RowMask moved = 0;
  for (int z = 0; z < brick_side; ++z) {
    const auto marked = static_cast<unsigned>(pairs >> (brick_side * z) & 0xff);
    if (marked == 0) continue;
    const auto layer = layer_at(z);
    uint64_t moves = 0;
    if (marked & 0x01) moves |= layer.step(0);
    if (marked & 0x04) moves |= layer.step(2);
    if (marked & 0x10) moves |= layer.step(4);
    if (marked & 0x40) moves |= layer.step(6);
    moved |= rows_with(moves) << (brick_side * z);
  }
  return moved;
}

/// u - tau (grad^T p - f), clipped to [0, cap].
HWY_INLINE V primal_step(V u, V grad_t_p, V f, V tau, V cap) {
  const V moved = hn::Sub(u, hn::Mul(tau, hn::Sub(grad_t_p, f)));
  return hn::Min(hn::Max(moved, hn::Zero(D())), cap);
}

/// The upper bound of u on a layer: 1 at free vertices, elsewhere 0.
class Caps {
 public:
  HWY_INLINE Caps(Vec3i lo, Vec3i hi) : lo_z_(lo.z), hi_z_(hi.z) {
    if (lo.x == 0 && lo.y == 0 && hi.x == brick_side && hi.y == brick_side) return;  // nearly all bricks
    for (int i = 0; i < brick_area; ++i) {
      const int x = i % brick_side, y = i / brick_side;
      some_[i] = x >= lo.x && x < hi.x && y >= lo.y && y < hi.y ? 1.0f : 0.0f;
    }
    inside_ = some_;
  }
  Caps(const Caps&) = delete;
  Caps& operator=(const Caps&) = delete;
  HWY_INLINE const float* layer(int z) const { return z >= lo_z_ && z < hi_z_ ? inside_ : none; }

 private:
  HWY_ALIGN static constexpr auto all = [] {
    std::array<float, brick_area> ones{};
    for (float& one : ones) one = 1;
    return ones;
  }();
  HWY_ALIGN static constexpr float none[brick_area] = {};

  HWY_ALIGN float some_[brick_area];
  const float* inside_ = all.data();
  int lo_z_, hi_z_;
};

/// Layer z of the primal step.
class PrimalLayer {
 public:
  HWY_INLINE PrimalLayer(const PrimalJob& job, const float* cap, int z)
      : u_(job.u + z * brick_area),
        u_bar_(job.u_bar + z * brick_area),
        face_x_(job.face_x + z * brick_side),
        f_(job.f + z * brick_area),
        p_(job.p + z * brick_area),
        left_(job.low_x.base + z * brick_side * job.low_x.inner),
        left_inner_(job.low_x.inner),
        front_(job.low_y.row(z)),
        below_(z == 0 ? job.low_z.base : p_ + 2 * brick_volume - brick_area),
        cap_(cap),
        tau_(job.tau),
        next_u_(job.next_u + z * brick_area),
        next_f_(job.next_f + z * brick_area),
        after_next_p_(job.after_next_p + z * brick_area) {
    hwy::Prefetch(job.next_low_y.row(z));
    if (z == 0)
      for (int y = 0; y < brick_side; y += 2) hwy::Prefetch(job.next_low_z.row(y));
  }

  HWY_INLINE uint64_t step(int y) const {
    const D d;
    const int row = y * brick_side;
    hwy::Prefetch(next_u_ + row);
    hwy::Prefetch(after_next_p_ + row);
    hwy::Prefetch(next_f_ + row);
    const float *px = p_ + row, *py = px + brick_volume, *pz = py + brick_volume;
    uint64_t moves = 0;
    for (int x = 0; x < pair_size; x += lane_count()) {
      const V x_here = hn::Load(d, px + x), y_here = hn::Load(d, py + x), z_here = hn::Load(d, pz + x);
      const V dx = hn::Sub(lower_along_x(y, x, x_here), x_here);
      const V dy = hn::Sub(load_rows(y == 0 ? front_ : py - brick_side, py, x), y_here);
      const V dz = hn::Sub(hn::LoadU(d, below_ + row + x), z_here);
      const V old = hn::Load(d, u_ + row + x);
      const V u_new = primal_step(old, hn::Add(hn::Add(dx, dy), dz), hn::Load(d, f_ + row + x), hn::Set(d, tau_),
                                  hn::Load(d, cap_ + row + x));
      moves |= bits_of(hn::Ne(u_new, old), y, x);
      hn::Store(u_new, d, u_ + row + x);
      hn::Store(hn::Sub(hn::Add(u_new, u_new), old), d, u_bar_ + row + x);
    }
    face_x_[y] = u_bar_[row];
    face_x_[y + 1] = u_bar_[row + brick_side];
    return moves;
  }

 private:
  /// p_x before the vertices from x on of a pair. Nothing is loaded from memory before the brick: that belongs to
  /// another brick, which another thread may be writing.
  HWY_INLINE V lower_along_x(int y, int x, V here) const {
    const D d;
    const float* before = p_ + y * brick_side + x - 1;
    if (x % brick_side != 0) return hn::LoadU(d, before);
    // Lanes moved up by one, cyclic.
    HWY_ALIGN int32_t up[pair_size];
    for (int i = 0; i < lane_count(); ++i) up[i] = (i + lane_count() - 1) % lane_count();
    const V lower = y == 0 && x == 0 ? hn::TableLookupLanes(here, hn::SetTableIndices(d, up)) : hn::LoadU(d, before);
    const float* left = left_ + y * left_inner_;
    return with_ends(lanes_of(0x0101, 0), left, left + left_inner_, x, lower);
  }

  float* HWY_RESTRICT u_;
  float* HWY_RESTRICT u_bar_;
  float* HWY_RESTRICT face_x_;
  const float *f_, *p_;
  const float* left_;  ///< p_x before the rows
  ptrdiff_t left_inner_;
  const float *front_, *below_;  ///< p_y before the first row, p_z before the layer
  const float* cap_;
  float tau_;
  const float *next_u_, *next_f_, *after_next_p_;
};

RowMask primal(const PrimalJob& job) {
  const Caps caps(job.free_lo, job.free_hi);
  return step_pairs(job.pairs, [&](int z) HWY_ATTR { return PrimalLayer(job, caps.layer(z), z); });
}

/// Forward differences of u_bar.
struct Gradient {
  V x, y, z;
};

/// The u_bar read by the dual step of layer z.
class UBarLayer {
 public:
  HWY_INLINE UBarLayer(const DualJob& job, int z)
      : u_bar_(job.u_bar + z * brick_area),
        right_(job.above_x + z * brick_side),
        back_(job.above_y + z * brick_side),
        above_(z == brick_side - 1 ? job.above_z : u_bar_ + brick_area) {}

  /// For the vertices from x on of the pair whose first row is y.
  HWY_INLINE Gradient forward_difference(int y, int x) const {
    const D d;
    const int row = y * brick_side;
    const float* rows = u_bar_ + row;
    const V here = hn::Load(d, rows + x);
    V next_x = hn::LoadU(d, rows + x + 1);
    if ((x + lane_count()) % brick_side == 0)
      next_x = with_ends(lanes_of(0x8080, pair_size - lane_count()), right_ + y, right_ + y + 1, x, next_x);
    const V next_y = load_rows(rows + brick_side, y == brick_side - 2 ? back_ : rows + pair_size, x);
    return {hn::Sub(next_x, here), hn::Sub(next_y, here), hn::Sub(hn::LoadU(d, above_ + row + x), here)};
  }

 private:
  const float* u_bar_;
  const float *right_, *back_, *above_;  ///< beyond the rows, the last row and the layer
};

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

/// Where a component of p is fixed: on the brick's upper faces at the band boundary, and at an open border.
struct Fixed {
  M x, y, z;
};

/// The vertices [lo, hi) of a row, as bits.
HWY_INLINE unsigned row_bits(int lo, int hi) { return lo < hi ? (0xffu << lo) & (0xffu >> (brick_side - hi)) : 0; }

/// The vertices of a row whose p along an axis must not change at an open border, as bits.
HWY_INLINE unsigned held_at_border(const DualJob& job, int axis, int y, int z) {
  Vec3i end = job.free_hi;
  end[axis] = job.last_up[axis];
  if (y < job.free_lo.y || y >= end.y || z < job.free_lo.z || z >= end.z) return 0xff;
  return 0xff & ~row_bits(job.free_lo.x, end.x);
}

HWY_INLINE Fixed fixed_flux(const DualJob& job, int y, int z, int x) {
  const bool last_y = y == brick_side - 2, last_z = z == brick_side - 1;
  unsigned pair[3] = {job.fixed_up[0] ? 0x8080u : 0u, job.fixed_up[1] && last_y ? 0xff00u : 0u,
                      job.fixed_up[2] && last_z ? 0xffffu : 0u};
  if (job.at_open_border)
    for (int axis = 0; axis < 3; ++axis)
      pair[axis] |= held_at_border(job, axis, y, z) | held_at_border(job, axis, y + 1, z) << brick_side;
  return {lanes_of(pair[0], x), lanes_of(pair[1], x), lanes_of(pair[2], x)};
}

HWY_INLINE Flux with_fixed(const Fixed& fixed, const Flux& old, const Flux& q) {
  return {hn::IfThenElse(fixed.x, old.x, q.x), hn::IfThenElse(fixed.y, old.y, q.y),
          hn::IfThenElse(fixed.z, old.z, q.z)};
}

/// The same at the band boundary: fixed components keep their value, the others have the ball's remaining radius.
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

/// Layer z of the dual step.
template <class Projection>
class DualLayer {
 public:
  HWY_INLINE DualLayer(const DualJob& job, const Projection& projection, int z)
      : u_bar_(job, z), p_(job.p + z * brick_area), job_(job), projection_(projection), z_(z) {}

  HWY_INLINE uint64_t step(int y) const {
    const V sigma = hn::Set(D(), job_.sigma);
    const float* next_p = job_.next_p + z_ * brick_area + y * brick_side;
    hwy::Prefetch(next_p + brick_volume);
    hwy::Prefetch(next_p + 2 * brick_volume);
    uint64_t moves = 0;
    for (int x = 0; x < pair_size; x += lane_count()) {
      float* at = p_ + y * brick_side + x;
      const Flux old = load(at);
      const Gradient g = u_bar_.forward_difference(y, x);
      Flux q{hn::Add(old.x, hn::Mul(sigma, g.x)), hn::Add(old.y, hn::Mul(sigma, g.y)),
             hn::Add(old.z, hn::Mul(sigma, g.z))};
      projection_.apply(
          old, [&]() HWY_ATTR { return fixed_flux(job_, y, z_, x); }, q);
      moves |= bits_of(store(q, old, at), y, x);
    }
    return moves;
  }

 private:
  UBarLayer u_bar_;
  float* p_;
  const DualJob& job_;
  const Projection& projection_;
  int z_;
};

template <class Projection>
HWY_INLINE RowMask step_dual(const DualJob& job, const Projection& projection) {
  return step_pairs(job.pairs, [&](int z) HWY_ATTR { return DualLayer<Projection>(job, projection, z); });
}

/// The projection for the isotropic norm.
template <bool rim>
struct OntoBall {
  float lambda;
  template <class FixedFlux>
  HWY_INLINE void apply(const Flux& old, FixedFlux&& fixed, Flux& q) const {
    const V radius = hn::Set(D(), lambda), radius_squared = hn::Mul(radius, radius);
    if constexpr (rim) {
      project_free(old, fixed(), radius_squared, q);
    } else {
      project(radius, radius_squared, q);
    }
  }
};

RowMask dual(const DualJob& job) {
  const bool rim = job.fixed_up[0] || job.fixed_up[1] || job.fixed_up[2] || job.at_open_border;
  return rim ? step_dual(job, OntoBall<true>{job.lambda}) : step_dual(job, OntoBall<false>{job.lambda});
}

/// The projection for the anisotropic norm: the ball is a cube, so each component is clamped alone and fixed ones stay.
struct OntoCube {
  float lambda;
  template <class FixedFlux>
  HWY_INLINE void apply(const Flux& old, FixedFlux&& fixed, Flux& q) const {
    const V most = hn::Set(D(), lambda), least = hn::Neg(most);
    const Flux clamped{hn::Min(hn::Max(q.x, least), most), hn::Min(hn::Max(q.y, least), most),
                       hn::Min(hn::Max(q.z, least), most)};
    q = with_fixed(fixed(), old, clamped);
  }
};

RowMask dual_by_component(const DualJob& job) { return step_dual(job, OntoCube{job.lambda}); }

}  // namespace

inline SweepKernel kernel(Norm norm) { return {&primal, norm == Norm::isotropic ? &dual : &dual_by_component}; }

}  // namespace soapfilm::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
