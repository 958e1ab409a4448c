// The kernels of an SOR iteration, compiled once per SIMD target (no include guard: see Highway's foreach_target.h).
// No fused multiply-add, no reciprocal estimates: every target rounds in the same way.
//
// Equation (8) is written as a correction, divided by lambda and without the factor 1/2 of g_ij = (g_i + g_j) / 2:
//
//   u_i <- u_i + omega (sum_j (g_i + g_j) (u_j - u_i) + 2 f_i / lambda) / sum_j (g_i + g_j)
//
// so that if u is constant and f = 0 it changes nothing, not even by rounding: empty runs can be skipped exactly.

#include <hwy/highway.h>

#include <algorithm>

#include "soapfilm/kernels/sor_kernel.h"

HWY_BEFORE_NAMESPACE();
namespace soapfilm::HWY_NAMESPACE {
namespace {  // the scalar target is compiled twice: as a dispatched one and alone

namespace hn = hwy::HWY_NAMESPACE;

using RunTag = hn::CappedTag<float, sor_run>;
using OneTag = hn::CappedTag<float, 1>;

/// sums[k] += lane k, in double.
HWY_INLINE void add_lanes(OneTag, hn::Vec<OneTag> value, double* sums) {
  *sums += static_cast<double>(hn::GetLane(value));
}
#if HWY_TARGET != HWY_SCALAR
HWY_INLINE void add_lanes(RunTag, hn::Vec<RunTag> value, double* sums) {
  const hn::Half<RunTag> half;
  const hn::Rebind<double, hn::Half<RunTag>> wide;
  const size_t n = hn::Lanes(wide);
  const auto lower = hn::PromoteTo(wide, hn::LowerHalf(half, value));
  const auto upper = hn::PromoteTo(wide, hn::UpperHalf(half, value));
  hn::StoreU(hn::Add(hn::LoadU(wide, sums), lower), wide, sums);
  hn::StoreU(hn::Add(hn::LoadU(wide, sums + n), upper), wide, sums + n);
}
#endif

template <class D>
HWY_INLINE hn::Vec<D> squared_norm(D, hn::Vec<D> x, hn::Vec<D> y, hn::Vec<D> z) {
  return hn::Add(hn::Add(hn::Mul(x, x), hn::Mul(y, y)), hn::Mul(z, z));
}

template <class D>
HWY_INLINE void slope_at(D d, const SlopeJob& job, int x) {
  const float* u = job.u + x;
  const auto here = hn::LoadU(d, u), right = hn::LoadU(d, u + 1);
  const auto front = hn::LoadU(d, job.front + x), above = hn::LoadU(d, job.above + x);
  if (job.g) {
    const auto per_step = hn::Set(d, job.per_step);
    const auto gx = hn::Mul(per_step, hn::Sub(right, hn::LoadU(d, u + job.left)));
    const auto gy = hn::Mul(per_step, hn::Sub(front, hn::LoadU(d, job.back + x)));
    const auto gz = hn::Mul(per_step, hn::Sub(above, hn::LoadU(d, job.below + x)));
    const auto root = hn::Sqrt(hn::Add(squared_norm(d, gx, gy, gz), hn::Set(d, job.epsilon_squared)));
    hn::StoreU(hn::Div(hn::Set(d, 1.0f), root), d, job.g + x);
  }
  const auto squared = squared_norm(d, hn::Sub(right, here), hn::Sub(front, here), hn::Sub(above, here));
  add_lanes(d, hn::Sqrt(squared), job.variation + x % slope_sums);
}

void slope(const SlopeJob& job, int begin, int end) {
  const RunTag d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  int x = begin;
  for (; x + lanes <= end; x += lanes) slope_at(d, job, x);
  for (; x < end; ++x) slope_at(OneTag(), job, x);
}

/// The linear system's row at a few vertices: new u = here + scale (residual + left (u_left - here)).
template <class D>
struct Stencil {
  hn::Vec<D> here;
  hn::Vec<D> left;      ///< g_i + g_j of the neighbor below along x
  hn::Vec<D> residual;  ///< sum over the other five of (g_i + g_j) (u_j - u_i), plus 2 f / lambda
  hn::Vec<D> scale;     ///< omega / sum (g_i + g_j)

  HWY_INLINE hn::Vec<D> base() const { return hn::Add(here, hn::Mul(scale, residual)); }
  HWY_INLINE hn::Vec<D> slope() const { return hn::Mul(scale, left); }

  HWY_INLINE Stencil(D d, const RelaxJob& job, const SorRow& row, int x) {
    const float* u = row.u + x;
    const float* g = row.g + x;
    here = hn::LoadU(d, u);
    const auto gc = hn::LoadU(d, g);
    left = hn::Add(gc, hn::LoadU(d, g - 1));
    const auto right = hn::Add(gc, hn::LoadU(d, g + 1));
    const auto back = hn::Add(gc, hn::LoadU(d, g - job.row));
    const auto front = hn::Add(gc, hn::LoadU(d, g + job.row));
    const auto below = hn::Add(gc, hn::LoadU(d, row.g_below + x));
    const auto above = hn::Add(gc, hn::LoadU(d, row.g_above + x));
    const auto sum = hn::Add(hn::Add(hn::Add(left, right), hn::Add(back, front)), hn::Add(below, above));
    scale = hn::Div(hn::Set(d, job.omega), sum);
    const auto flux = [&](hn::Vec<D> weight, ptrdiff_t step) {
      return hn::Mul(weight, hn::Sub(hn::LoadU(d, u + step), here));
    };
    const auto along_y = hn::Add(flux(back, -job.row), flux(front, job.row));
    const auto along_z = hn::Add(flux(below, -job.layer), flux(above, job.layer));
    residual = hn::Add(hn::Add(flux(right, 1), hn::LoadU(d, row.f + x)), hn::Add(along_y, along_z));
  }
};

/// Clips to [0, 1], and sets values closer to 0 or 1 than the snap to 0 or 1.
template <class D>
HWY_INLINE hn::Vec<D> snapped(D, hn::Vec<D> u, hn::Vec<D> low, hn::Vec<D> high, hn::Vec<D> one) {
  return hn::IfThenElse(hn::Gt(u, high), one, hn::IfThenZeroElse(hn::Lt(u, low), u));
}

RunKind kind_of(const float* u, int count) {
  if (count < sor_run) return run_kind(u, count);
  const RunTag d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  bool zero = true, one = true;
  for (int x = 0; x < sor_run; x += lanes) {
    const auto values = hn::LoadU(d, u + x);
    zero &= hn::AllTrue(d, hn::Eq(values, hn::Zero(d)));
    one &= hn::AllTrue(d, hn::Eq(values, hn::Set(d, 1.0f)));
  }
  return zero ? RunKind::zero : one ? RunKind::one : RunKind::mixed;
}

/// Several rows together, so that a vector holds the same x of four rows: the recursion along x cannot be vectorized
/// along x. Highway interleaves four; two such groups hide each other's latency.
constexpr int group_rows = 4;
constexpr int groups = sor_rows / group_rows;
using GroupTag = hn::CappedTag<float, group_rows>;

/// One run of a group: [value][row].
struct RunBlock {
  alignas(64) float u[sor_run * group_rows];
  alignas(64) float base[sor_run * group_rows];   ///< new u without the contribution of the neighbor below along x
  alignas(64) float slope[sor_run * group_rows];  ///< that contribution, per difference
};

HWY_INLINE void fill_block(const RelaxJob& job, const SorRow* rows, int x0, RunBlock& block) {
  const RunTag d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  for (int x = 0; x < sor_run; x += lanes) {
    const Stencil<RunTag> a(d, job, rows[0], x0 + x), b(d, job, rows[1], x0 + x);
    const Stencil<RunTag> e(d, job, rows[2], x0 + x), f(d, job, rows[3], x0 + x);
    const int at = x * group_rows;
    hn::StoreInterleaved4(a.here, b.here, e.here, f.here, d, block.u + at);
    hn::StoreInterleaved4(a.base(), b.base(), e.base(), f.base(), d, block.base + at);
    hn::StoreInterleaved4(a.slope(), b.slope(), e.slope(), f.slope(), d, block.slope + at);
  }
}

/// u of the values [lo, hi) of the run, each computed from the one before.
HWY_INLINE void recur(const RelaxJob& job, RunBlock* blocks, int lo, int hi, float* previous) {
  const GroupTag d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const auto low = hn::Set(d, job.low), high = hn::Set(d, job.high), one = hn::Set(d, 1.0f);
  for (int x = lo; x < hi; ++x) {
    for (int k = 0; k < sor_rows; k += lanes) {
      RunBlock& block = blocks[k / group_rows];
      const int at = x * group_rows + k % group_rows;
      const auto difference = hn::Sub(hn::Load(d, previous + k), hn::Load(d, block.u + at));
      auto moved = hn::Add(hn::Load(d, block.base + at), hn::Mul(hn::Load(d, block.slope + at), difference));
      moved = snapped(d, moved, low, high, one);
      hn::Store(moved, d, block.u + at);
      hn::Store(moved, d, previous + k);
    }
  }
}

/// Writes back the values [lo, hi) of a group's first `count` rows.
HWY_INLINE void store_block(const RunBlock& block, const SorRow* rows, int count, int run, int lo, int hi, int size) {
  const RunTag d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  alignas(64) float u[group_rows][sor_run];
  for (int x = 0; x < sor_run; x += lanes) {
    hn::Vec<RunTag> a, b, e, f;
    hn::LoadInterleaved4(d, block.u + x * group_rows, a, b, e, f);
    hn::Store(a, d, u[0] + x);
    hn::Store(b, d, u[1] + x);
    hn::Store(e, d, u[2] + x);
    hn::Store(f, d, u[3] + x);
  }
  for (int k = 0; k < count; ++k) {
    float* out = rows[k].u + run * sor_run;
    if (hi - lo == sor_run)
      for (int x = 0; x < sor_run; x += lanes) hn::StoreU(hn::Load(d, u[k] + x), d, out + x);
    else
      for (int x = lo; x < hi; ++x) out[x] = u[k][x];
    if (rows[k].kinds) rows[k].kinds[run] = kind_of(out, std::min(sor_run, size - run * sor_run));
  }
}

void relax(const RelaxJob& job, const SorRow* given, int count, const uint8_t* active) {
  SorRow rows[sor_rows];  // groups are filled up with copies of a row, which are not written back
  for (int k = 0; k < sor_rows; ++k) rows[k] = given[std::min(k, count - 1)];
  RunBlock blocks[groups];
  alignas(64) float previous[sor_rows] = {};
  bool carried = false;  // the previous run was relaxed: `previous` holds its last values
  for (int run = 0, x0 = 0; x0 < job.size; ++run, x0 += sor_run) {
    if (!active[run]) {
      bool changed = false;
      if (carried)
        for (int k = 0; k < count; ++k) changed |= previous[k] != rows[k].u[x0];
      carried = changed;
      if (!changed) continue;
    } else if (!carried) {
      for (int k = 0; k < sor_rows; ++k) previous[k] = run == 0 ? 0.0f : rows[k].u[x0 - 1];
      carried = true;
    }
    const int lo = run == 0 ? 1 : 0, hi = std::min(sor_run, job.size - 1 - x0);
    for (int g = 0; g < groups; ++g) fill_block(job, rows + g * group_rows, x0, blocks[g]);
    recur(job, blocks, lo, hi, previous);
    for (int g = 0; g < groups; ++g) {
      const int first = g * group_rows;
      store_block(blocks[g], rows + first, std::clamp(count - first, 0, group_rows), run, lo, hi, job.size);
    }
  }
}

template <class D>
HWY_INLINE void color_at(D d, const RelaxJob& job, const SorRow& row, int x, hn::Mask<D> chosen) {
  const Stencil<D> s(d, job, row, x);
  const auto left = hn::Mul(s.left, hn::Sub(hn::LoadU(d, row.u + x - 1), s.here));
  auto moved = hn::Add(s.here, hn::Mul(s.scale, hn::Add(s.residual, left)));
  moved = snapped(d, moved, hn::Set(d, job.low), hn::Set(d, job.high), hn::Set(d, 1.0f));
  hn::StoreU(hn::IfThenElse(chosen, moved, s.here), d, row.u + x);
}

void relax_color(const RelaxJob& job, const SorRow& row, int parity, const uint8_t* active) {
  const RunTag d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  HWY_ALIGN float chosen[2][sor_run];  // for the first run, whose first value is fixed, and for the others
  for (int x = 0; x < sor_run; ++x) {
    chosen[1][x] = x % 2 == parity ? 1.0f : 0.0f;
    chosen[0][x] = x == 0 ? 0.0f : chosen[1][x];
  }
  for (int run = 0, x0 = 0; x0 < job.size; ++run, x0 += sor_run) {
    if (!active[run]) continue;
    const float* mask = chosen[run != 0];
    if (x0 + sor_run < job.size) {
      for (int x = 0; x < sor_run; x += lanes)
        color_at(d, job, row, x0 + x, hn::Gt(hn::Load(d, mask + x), hn::Zero(d)));
    } else {
      const OneTag one;
      for (int x = 0; x0 + x < job.size - 1; ++x)
        if (mask[x] > 0) color_at(one, job, row, x0 + x, hn::Eq(hn::Zero(one), hn::Zero(one)));
    }
    if (row.kinds) row.kinds[run] = kind_of(row.u + x0, std::min(sor_run, job.size - x0));
  }
}

}  // namespace

inline SorKernel sor_row_kernel() { return {&slope, &relax, &relax_color}; }

}  // namespace soapfilm::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
