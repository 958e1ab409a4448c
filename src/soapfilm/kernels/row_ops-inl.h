// Common parts of the kernels on rows, compiled once per SIMD target (no include guard: see Highway's
// foreach_target.h): a row's lanes, the sums over its neighbors, sums by lane.

#include <hwy/cache_control.h>
#include <hwy/highway.h>

#include <algorithm>
#include <bit>

#include "soapfilm/grid/layout.h"
#include "soapfilm/kernels/row_kernel.h"

HWY_BEFORE_NAMESPACE();
namespace soapfilm::HWY_NAMESPACE {
namespace {  // the scalar target is compiled twice: as a dispatched one and alone

namespace hn = hwy::HWY_NAMESPACE;

// At most a row: 8 lanes, fewer where the target has fewer.
using D = hn::CappedTag<float, brick_side>;
using V = hn::Vec<D>;
using Neighbors = std::array<uint32_t, 6>;

HWY_INLINE int lane_count() { return static_cast<int>(hn::Lanes(D())); }

/// The lanes from x on, of a row given as bits.
HWY_INLINE hn::Mask<D> lanes_of(unsigned row, int x) {
  const uint8_t bits[8] = {static_cast<uint8_t>((row & 0xff) >> x)};
  return hn::LoadMaskBits(D(), bits);
}

/// Prefetches the values of an array next to a later row that are not adjacent to it in memory. (Those along -y have
/// just been read.)
HWY_INLINE void fetch_neighbors(const float* v, const Neighbors& n) {
  for (const size_t k : {3, 4, 5}) hwy::Prefetch(v + size_t{n[k]} * brick_side);
}

/// Values of an array at slots.
struct Plain {
  const float* v;
  HWY_INLINE V load(size_t i) const { return hn::LoadU(D(), v + i); }
  HWY_INLINE float one(size_t i) const { return v[i]; }
  HWY_INLINE void fetch(const Neighbors& n) const { fetch_neighbors(v, n); }
};

/// Products of two arrays.
struct Product {
  const float *a, *b;
  HWY_INLINE V load(size_t i) const { return hn::Mul(hn::LoadU(D(), a + i), hn::LoadU(D(), b + i)); }
  HWY_INLINE float one(size_t i) const { return a[i] * b[i]; }
  HWY_INLINE void fetch(const Neighbors& n) const {
    fetch_neighbors(a, n);
    fetch_neighbors(b, n);
  }
};

/// The two neighbors along x.
struct Sides {
  V below, above;
};

/// For the vertices from x on in a row.
template <class Values>
HWY_INLINE Sides sides(const Values& values, const Neighbors& n, size_t row, int x) {
  const D d;
  const size_t here = row * brick_side + static_cast<size_t>(x);
  V below = values.load(here - 1), above = values.load(here + 1);
  // The ends of a row have their neighbors in other bricks.
  if (x == 0)
    below = hn::IfThenElse(hn::FirstN(d, 1), hn::Set(d, values.one(size_t{n[0]} * brick_side + brick_side - 1)), below);
  if (x + lane_count() == brick_side)
    above = hn::IfThenElse(hn::FirstN(d, static_cast<size_t>(lane_count()) - 1), above,
                           hn::Set(d, values.one(size_t{n[1]} * brick_side)));
  return {below, above};
}

/// The sums over the two neighbors along each axis.
struct AxisSums {
  V x, y, z;
};

/// For the vertices from x on in a row.
template <class Values>
HWY_INLINE AxisSums axis_sums(const Values& values, const Neighbors& n, size_t row, int x) {
  const auto at = [&](size_t k) { return static_cast<size_t>(n[k]) * brick_side + static_cast<size_t>(x); };
  const auto [below, above] = sides(values, n, row, x);
  return {hn::Add(below, above), hn::Add(values.load(at(2)), values.load(at(3))),
          hn::Add(values.load(at(4)), values.load(at(5)))};
}

/// The sum over all six.
template <class Values>
HWY_INLINE V neighbor_sum(const Values& values, const Neighbors& n, size_t row, int x) {
  const AxisSums sums = axis_sums(values, n, row, x);
  return hn::Add(sums.x, hn::Add(sums.y, sums.z));
}

HWY_INLINE V degree_of(const uint8_t* degree) {
  const hn::Rebind<uint8_t, D> bytes;
  const hn::Rebind<int32_t, D> integers;
  return hn::ConvertTo(D(), hn::PromoteTo(integers, hn::LoadU(bytes, degree)));
}

HWY_INLINE V mix(V a, V b, V t) { return hn::Add(a, hn::Mul(t, hn::Sub(b, a))); }

/// Values and gradients in cells.
struct Jets {
  V value, x, y, z;
};

/// Values at four corners of cells, y fastest.
struct FourCorners {
  V y0z0, y1z0, y0z1, y1z1;
};

/// As trilinear() in grid/trilinear.h, bit for bit.
HWY_INLINE Jets trilinear(const FourCorners& low, const FourCorners& high, V tx, V ty, V tz) {
  const V d0 = hn::Sub(high.y0z0, low.y0z0), d1 = hn::Sub(high.y1z0, low.y1z0), d2 = hn::Sub(high.y0z1, low.y0z1),
          d3 = hn::Sub(high.y1z1, low.y1z1);
  const V m0 = hn::Add(low.y0z0, hn::Mul(tx, d0)), m1 = hn::Add(low.y1z0, hn::Mul(tx, d1)),
          m2 = hn::Add(low.y0z1, hn::Mul(tx, d2)), m3 = hn::Add(low.y1z1, hn::Mul(tx, d3));
  const V y0 = mix(m0, m1, ty), y1 = mix(m2, m3, ty);
  return {mix(y0, y1, tz), mix(mix(d0, d1, ty), mix(d2, d3, ty), tz), mix(hn::Sub(m1, m0), hn::Sub(m3, m2), tz),
          hn::Sub(y1, y0)};
}

/// Sums by lane: in float over a few rows, then in double.
class LaneSum {
 public:
  HWY_INLINE void add(V value, int x) {
    const D d;
    hn::Store(hn::Add(hn::Load(d, few_ + x), value), d, few_ + x);
  }
  HWY_INLINE void end_row() {
    if (++rows_ == most_rows) flush();
  }
  double total() {
    flush();
    return ((all_[0] + all_[1]) + (all_[2] + all_[3])) + ((all_[4] + all_[5]) + (all_[6] + all_[7]));
  }

 private:
  static constexpr int most_rows = 64;
  void flush() {
    for (int x = 0; x < brick_side; ++x) {
      all_[x] += static_cast<double>(few_[x]);
      few_[x] = 0;
    }
    rows_ = 0;
  }
  HWY_ALIGN float few_[brick_side] = {};
  double all_[brick_side] = {};
  int rows_ = 0;
};

}  // namespace
}  // namespace soapfilm::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
