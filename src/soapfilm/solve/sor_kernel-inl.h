// The kernels of an SOR iteration, compiled once per SIMD target (no include guard: see Highway's foreach_target.h).
// No fused multiply-add, no reciprocal estimates: every target rounds alike.
//
// Equation (8) is written as a correction, lambda divided out and g_ij = (g_i + g_j) / 2 freed of its half:
//
//   u_i <- u_i + omega (sum_j (g_i + g_j) (u_j - u_i) + 2 f_i / lambda) / sum_j (g_i + g_j)
//
// so that where u is constant and f = 0 it changes nothing, not even by rounding: empty runs can be skipped exactly.

#include <hwy/highway.h>

#include <algorithm>

#include "soapfilm/solve/sor_kernel.h"

HWY_BEFORE_NAMESPACE();
namespace soapfilm::HWY_NAMESPACE {
namespace {  // the scalar target is compiled twice: among the dispatched ones and on its own

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
  add_lanes(d, hn::Sqrt(squared), job.variation + x % sor_run);
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
  hn::Vec<D> left;      ///< g_i + g_j of the neighbour below along x
  hn::Vec<D> residual;  ///< sum over the other five of (g_i + g_j) (u_j - u_i), plus 2 f / lambda
  hn::Vec<D> scale;     ///< omega / sum (g_i + g_j)

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

/// One run of each of up to 8 rows: [row][value].
struct RunBlock {
  alignas(64) float u[sor_rows][sor_run];
  alignas(64) float base[sor_rows][sor_run];  ///< u but for what the neighbour below along x adds
  alignas(64) float slope[sor_rows][sor_run];
};

HWY_INLINE void fill_block(const RelaxJob& job, const SorRow& row, int x0, int k, RunBlock& block) {
  const RunTag d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  for (int x = 0; x < sor_run; x += lanes) {
    const Stencil<RunTag> s(d, job, row, x0 + x);
    hn::Store(s.here, d, block.u[k] + x);
    hn::Store(hn::Add(s.here, hn::Mul(s.scale, s.residual)), d, block.base[k] + x);
    hn::Store(hn::Mul(s.scale, s.left), d, block.slope[k] + x);
  }
}

/// The recursion along x, for several rows at once: one row alone would wait for each result.
HWY_INLINE void recur(const RelaxJob& job, RunBlock& block, int lo, int hi, int count, float* previous) {
  const auto step = [&](int k, int x) {
    const float moved = block.base[k][x] + block.slope[k][x] * (previous[k] - block.u[k][x]);
    const float above = moved < job.low ? 0.0f : moved;
    previous[k] = block.u[k][x] = above > job.high ? 1.0f : above;
  };
  if (count == sor_rows)
    for (int x = lo; x < hi; ++x)
      for (int k = 0; k < sor_rows; ++k) step(k, x);
  else
    for (int x = lo; x < hi; ++x)
      for (int k = 0; k < count; ++k) step(k, x);
}

void relax(const RelaxJob& job, const SorRow* rows, int count, const uint8_t* active) {
  RunBlock block;
  float previous[sor_rows] = {};
  bool carried = false;  // the run before has been relaxed: `previous` holds its last values
  for (int run = 0, x0 = 0; x0 < job.size; ++run, x0 += sor_run) {
    if (!active[run]) {
      bool changed = false;
      if (carried)
        for (int k = 0; k < count; ++k) changed |= previous[k] != rows[k].u[x0];
      carried = changed;
      if (!changed) continue;
    } else if (!carried) {
      for (int k = 0; k < count; ++k) previous[k] = run == 0 ? 0.0f : rows[k].u[x0 - 1];
      carried = true;
    }
    const int lo = run == 0 ? 1 : 0, hi = std::min(sor_run, job.size - 1 - x0);
    for (int k = 0; k < count; ++k) fill_block(job, rows[k], x0, k, block);
    recur(job, block, lo, hi, count, previous);
    for (int k = 0; k < count; ++k) {
      std::copy(block.u[k] + lo, block.u[k] + std::max(lo, hi), rows[k].u + x0 + lo);
      if (rows[k].kinds) rows[k].kinds[run] = run_kind(rows[k].u + x0, std::min(sor_run, job.size - x0));
    }
  }
}

template <class D>
HWY_INLINE void colour_at(D d, const RelaxJob& job, const SorRow& row, int x, hn::Mask<D> chosen) {
  const Stencil<D> s(d, job, row, x);
  const auto left = hn::Mul(s.left, hn::Sub(hn::LoadU(d, row.u + x - 1), s.here));
  auto moved = hn::Add(s.here, hn::Mul(s.scale, hn::Add(s.residual, left)));
  moved = hn::IfThenElse(hn::Lt(moved, hn::Set(d, job.low)), hn::Zero(d), moved);
  moved = hn::IfThenElse(hn::Gt(moved, hn::Set(d, job.high)), hn::Set(d, 1.0f), moved);
  hn::StoreU(hn::IfThenElse(chosen, moved, s.here), d, row.u + x);
}

void relax_colour(const RelaxJob& job, const SorRow& row, int parity, const uint8_t* active) {
  const RunTag d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  HWY_ALIGN float chosen[2][sor_run];  // of the first run, whose first value is fixed, and of the others
  for (int x = 0; x < sor_run; ++x) {
    chosen[1][x] = x % 2 == parity ? 1.0f : 0.0f;
    chosen[0][x] = x == 0 ? 0.0f : chosen[1][x];
  }
  for (int run = 0, x0 = 0; x0 < job.size; ++run, x0 += sor_run) {
    if (!active[run]) continue;
    const float* mask = chosen[run != 0];
    if (x0 + sor_run < job.size) {
      for (int x = 0; x < sor_run; x += lanes)
        colour_at(d, job, row, x0 + x, hn::Gt(hn::Load(d, mask + x), hn::Zero(d)));
    } else {
      const OneTag one;
      for (int x = 0; x0 + x < job.size - 1; ++x)
        if (mask[x] > 0) colour_at(one, job, row, x0 + x, hn::Eq(hn::Zero(one), hn::Zero(one)));
    }
    if (row.kinds) row.kinds[run] = run_kind(row.u + x0, std::min(sor_run, job.size - x0));
  }
}

}  // namespace

inline SorKernel sor_row_kernel() { return {&slope, &relax, &relax_colour}; }

}  // namespace soapfilm::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
