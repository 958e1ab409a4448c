// The kernel of evaluate_energy, compiled once per SIMD target (no include guard: see Highway's foreach_target.h).
// In double, from stored floats; no fused multiply-add: every target rounds in the same way.

#include <hwy/highway.h>

#include "soapfilm/kernels/energy_kernel.h"

HWY_BEFORE_NAMESPACE();
namespace soapfilm::HWY_NAMESPACE {
namespace {  // the scalar target is compiled twice: as a dispatched one and alone

namespace hn = hwy::HWY_NAMESPACE;

// At most a row of a brick: 8 lanes, fewer where the target has fewer.
using D = hn::CappedTag<double, brick_side>;
using Stored = hn::Rebind<float, D>;
using V = hn::Vec<D>;

HWY_INLINE V load(const float* row) { return hn::PromoteTo(D(), hn::LoadU(Stored(), row)); }

/// The neighbors below x in a row of the brick: lane 0 of a row's first lane group comes from outside.
HWY_INLINE V load_below(const float* row, int x, float outside) {
  const V shifted = load(row + x - 1);
  return x != 0 ? shifted : hn::IfThenElse(hn::FirstN(D(), 1), hn::Set(D(), static_cast<double>(outside)), shifted);
}

/// One sum per lane of a row.
struct LaneSums {
  alignas(64) double values[brick_side] = {};

  HWY_INLINE void add(int x, V v) { hn::Store(hn::Add(hn::Load(D(), values + x), v), D(), values + x); }
  HWY_INLINE void max(int x, V v) { hn::Store(hn::Max(hn::Load(D(), values + x), v), D(), values + x); }
  double sum() const {
    const double* v = values;
    return ((v[0] + v[4]) + (v[2] + v[6])) + ((v[1] + v[5]) + (v[3] + v[7]));
  }
  double largest() const {
    double most = values[0];
    for (const double v : values) most = v > most ? v : most;
    return most;
  }
};

template <Norm norm>
HWY_INLINE V length(V x, V y, V z) {
  if constexpr (norm == Norm::isotropic)
    return hn::Sqrt(hn::Add(hn::Add(hn::Mul(x, x), hn::Mul(y, y)), hn::Mul(z, z)));
  else
    return hn::Add(hn::Add(hn::Abs(x), hn::Abs(y)), hn::Abs(z));
}

template <Norm norm>
HWY_INLINE V dual_norm_squared(V x, V y, V z) {
  const V xx = hn::Mul(x, x), yy = hn::Mul(y, y), zz = hn::Mul(z, z);
  if constexpr (norm == Norm::isotropic)
    return hn::Add(hn::Add(xx, yy), zz);
  else
    return hn::Max(hn::Max(xx, yy), zz);
}

template <Norm norm>
EnergyTerms brick_terms(const EnergyJob& job, const UpperWindow& u) {
  const D d;
  const int lanes = static_cast<int>(hn::Lanes(D()));
  const V zero = hn::Zero(d);
  const V lambda = hn::Set(d, job.lambda), p_scale = hn::Set(d, job.p_scale);
  LaneSums variation, data, dual, gap, max_norm;
  HWY_ALIGN double free_row[brick_side];
  for (int x = 0; x < brick_side; ++x) free_row[x] = x >= job.free_lo.x && x < job.free_hi.x ? 1 : 0;

  for (int z = 0; z < brick_side; ++z)
    for (int y = 0; y < brick_side; ++y) {
      const float* values = u.values + y * UpperWindow::row + z * UpperWindow::layer;
      const float* p = job.p + brick_offset(0, y, z);
      const float* f = job.f + brick_offset(0, y, z);
      const float* below_y = y == 0 ? job.low_y.row(z) : p + brick_volume - brick_side;
      const float* below_z = z == 0 ? job.low_z.row(y) : p + 2 * brick_volume - brick_area;
      const float below_x = job.low_x.at(y, z);
      const bool free = y >= job.free_lo.y && y < job.free_hi.y && z >= job.free_lo.z && z < job.free_hi.z;
      if (job.open && !free) continue;
      for (int x = 0; x < brick_side; x += lanes) {
        const V here = load(values + x);
        V gx = hn::Sub(load(values + x + 1), here);
        V gy = hn::Sub(load(values + x + UpperWindow::row), here);
        V gz = hn::Sub(load(values + x + UpperWindow::layer), here);
        const auto counts = hn::Ne(hn::Load(d, free_row + x), zero);
        if (job.open) {
          gx = hn::IfThenElseZero(counts, gx);
          gy = hn::IfThenElseZero(counts, gy);
          gz = hn::IfThenElseZero(counts, gz);
        }
        const V px = load(p + x), py = load(p + x + brick_volume), pz = load(p + x + 2 * brick_volume);
        max_norm.max(x, dual_norm_squared<norm>(px, py, pz));
        V gap_here = zero;
        // Most rows are constant: nothing to add.
        if (!hn::AllTrue(d, hn::Eq(hn::Or(hn::Or(gx, gy), gz), zero))) {
          const V slope = length<norm>(gx, gy, gz);
          const V coupling = hn::Add(hn::Add(hn::Mul(px, gx), hn::Mul(py, gy)), hn::Mul(pz, gz));
          variation.add(x, slope);
          gap_here = hn::Sub(hn::Mul(lambda, slope), hn::Mul(p_scale, coupling));
          gap.add(x, gap_here);
        }
        if (free) {
          const V into = hn::Add(hn::Add(hn::Sub(load_below(p, x, below_x), px), hn::Sub(load(below_y + x), py)),
                                 hn::Sub(load(below_z + x), pz));
          const V source = load(f + x);
          const V r = hn::IfThenElseZero(counts, hn::Sub(hn::Mul(p_scale, into), source));
          const V negative = hn::Min(r, zero);
          const V slack = hn::Sub(hn::Mul(r, here), negative);
          data.add(x, hn::IfThenElseZero(counts, hn::Mul(source, here)));
          dual.add(x, negative);
          gap.add(x, slack);
          gap_here = hn::Add(gap_here, slack);
        }
        if (job.gap) hn::StoreU(hn::DemoteTo(Stored(), gap_here), Stored(), job.gap + brick_offset(x, y, z));
      }
    }
  return {variation.sum(), data.sum(), dual.sum(), gap.sum(), max_norm.largest()};
}

}  // namespace

inline EnergyKernel energy_kernel(Norm norm) {
  return norm == Norm::isotropic ? &brick_terms<Norm::isotropic> : &brick_terms<Norm::anisotropic>;
}

}  // namespace soapfilm::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
