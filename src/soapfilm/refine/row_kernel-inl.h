// The loops over rows, compiled once per SIMD target (no include guard: see Highway's foreach_target.h).
// No fused multiply-add, no reciprocal estimates, sums by lane of the row: every target rounds alike.

#include <hwy/highway.h>

#include <algorithm>

#include "soapfilm/grid/layout.h"
#include "soapfilm/refine/row_kernel.h"

// Where a row is one vector, its lanes are shuffled in registers.
#undef SOAPFILM_ROW_IN_A_VECTOR
#define SOAPFILM_ROW_IN_A_VECTOR (HWY_ARCH_X86 && HWY_MAX_BYTES >= 32)

HWY_BEFORE_NAMESPACE();
namespace soapfilm::HWY_NAMESPACE {
namespace {  // the scalar target is compiled twice: among the dispatched ones and on its own

namespace hn = hwy::HWY_NAMESPACE;

// At most a row: 8 lanes, fewer where the target has fewer.
using D = hn::CappedTag<float, brick_side>;
using V = hn::Vec<D>;
using Neighbors = std::array<uint32_t, 6>;

HWY_INLINE int lane_count() { return static_cast<int>(hn::Lanes(D())); }

/// Values of an array at slots.
struct Plain {
  const float* v;
  HWY_INLINE V load(size_t i) const { return hn::LoadU(D(), v + i); }
  HWY_INLINE float one(size_t i) const { return v[i]; }
};

/// Products of two arrays.
struct Product {
  const float *a, *b;
  HWY_INLINE V load(size_t i) const { return hn::Mul(hn::LoadU(D(), a + i), hn::LoadU(D(), b + i)); }
  HWY_INLINE float one(size_t i) const { return a[i] * b[i]; }
};

/// Products with a third array.
struct Weighted {
  Product product;
  const float* e;
  HWY_INLINE V load(size_t i) const { return hn::Mul(product.load(i), hn::LoadU(D(), e + i)); }
  HWY_INLINE float one(size_t i) const { return product.one(i) * e[i]; }
};

/// The sums over the two neighbours along each axis.
struct AxisSums {
  V x, y, z;
};

/// Of the vertices from x on in a row.
template <class Values>
HWY_INLINE AxisSums axis_sums(const Values& values, const Neighbors& n, size_t row, int x) {
  const D d;
  const size_t here = row * brick_side + static_cast<size_t>(x);
  const auto at = [&](size_t k) { return static_cast<size_t>(n[k]) * brick_side + static_cast<size_t>(x); };
  V below = values.load(here - 1), above = values.load(here + 1);
  // The ends of a row have their neighbours in other bricks.
  if (x == 0)
    below = hn::IfThenElse(hn::FirstN(d, 1), hn::Set(d, values.one(size_t{n[0]} * brick_side + brick_side - 1)), below);
  if (x + lane_count() == brick_side)
    above = hn::IfThenElse(hn::FirstN(d, static_cast<size_t>(lane_count()) - 1), above,
                           hn::Set(d, values.one(size_t{n[1]} * brick_side)));
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

double laplacian(const BandRows& band, const LaplacianJob& job, size_t begin, size_t end) {
  const D d;
  const V weight_v = hn::Set(d, job.weight_v), weight_g = hn::Set(d, job.weight_g);
  LaneSum sum;
  for (size_t r = begin; r < end; ++r) {
    for (int x = 0; x < brick_side; x += lane_count()) {
      const size_t i = r * brick_side + static_cast<size_t>(x);
      const V degree = degree_of(band.degree + i), here = hn::Load(d, job.v + i);
      const V g =
          hn::IfThenElseZero(hn::Gt(degree, hn::Zero(d)),
                             hn::Sub(hn::Mul(degree, here), neighbor_sum(Plain{job.v}, band.neighbors[r], r, x)));
      const V weight = job.share ? hn::Mul(weight_g, hn::Load(d, job.share + i)) : weight_g;
      const V out = hn::Add(hn::Mul(weight_v, here), hn::Mul(weight, g));
      hn::Store(out, d, job.out + i);
      sum.add(hn::Mul(g, out), x);
    }
    sum.end_row();
  }
  return sum.total();
}

/// R v: differences to neighbours without an opposite one; outside the band v is 0.
HWY_INLINE V one_sided(const BandRows& band, const float* v, size_t row, int x) {
  const D d;
  const Neighbors& n = band.neighbors[row];
  const AxisSums sums = axis_sums(Plain{v}, n, row, x);
  const V here = hn::Load(d, v + row * brick_side + static_cast<size_t>(x));
  const unsigned own = band.mask[row];
  const unsigned below = own << 1 | band.mask[n[0]] >> 7, above = own >> 1 | (band.mask[n[1]] & 1u) << 7;
  const auto where = [&](unsigned one_of_two, V sum) {
    const uint8_t bits[8] = {static_cast<uint8_t>((one_of_two & 0xff) >> x)};
    return hn::IfThenElseZero(hn::LoadMaskBits(d, bits), hn::Sub(here, sum));
  };
  return hn::Add(where(below ^ above, sums.x), hn::Add(where(band.mask[n[2]] ^ band.mask[n[3]], sums.y),
                                                       where(band.mask[n[4]] ^ band.mask[n[5]], sums.z)));
}

void bend(const BandRows& band, const BendJob& job, size_t begin, size_t end) {
  const D d;
  const V beta = hn::Set(d, job.beta), gamma = hn::Set(d, job.gamma);
  for (size_t r = begin; r < end; ++r) {
    for (int x = 0; x < brick_side; x += lane_count()) {
      const size_t i = r * brick_side + static_cast<size_t>(x);
      const V degree = degree_of(band.degree + i), here = hn::Load(d, job.v + i), start = hn::Load(d, job.start + i);
      const V g = hn::Sub(hn::Mul(degree, here), neighbor_sum(Plain{job.v}, band.neighbors[r], r, x));
      const V bent = hn::Sub(g, one_sided(band, job.start, r, x));
      const V out =
          hn::Add(hn::Mul(beta, hn::Sub(here, start)), hn::Mul(hn::Mul(gamma, hn::Load(d, job.share + i)), bent));
      hn::Store(hn::IfThenElseZero(hn::Gt(degree, hn::Zero(d)), out), d, job.out + i);
    }
  }
}

void curvature(const BandRows& band, const CurvatureJob& job, size_t begin, size_t end) {
  const D d;
  const V one = hn::Set(d, 1.0f), six = hn::Set(d, 6.0f), faint = hn::Set(d, job.faint), reach = hn::Set(d, job.reach);
  for (size_t r = begin; r < end; ++r) {
    for (int x = 0; x < brick_side; x += lane_count()) {
      const size_t i = r * brick_side + static_cast<size_t>(x);
      const V degree = degree_of(band.degree + i), here = hn::Load(d, job.v + i);
      const auto inside = hn::Eq(degree, six);
      const V c = hn::Sub(neighbor_sum(Plain{job.v}, band.neighbors[r], r, x), hn::Mul(degree, here));
      const V weight = hn::IfThenElse(hn::And(inside, hn::Lt(hn::Abs(here), reach)), one,
                                      hn::IfThenElseZero(hn::Gt(degree, hn::Zero(d)), faint));
      const V off = hn::Sub(c, hn::Load(d, job.target + i));
      hn::Store(c, d, job.curvature + i);
      hn::Store(weight, d, job.weight + i);
      hn::Store(hn::IfThenElseZero(inside, hn::Mul(hn::Mul(weight, off), off)), d, job.product + i);
    }
  }
}

void share(const BandRows& band, const ShareJob& job, size_t begin, size_t end) {
  const D d;
  const V zero = hn::Zero(d), one = hn::Set(d, 1.0f), six = hn::Set(d, 6.0f);
  const V near = hn::Set(d, job.near), reach = hn::Set(d, job.reach), per_square = hn::Set(d, job.per_square);
  for (size_t i = begin * brick_side; i < end * brick_side; i += static_cast<size_t>(lane_count())) {
    const auto inside = hn::Eq(degree_of(band.degree + i), six);
    const V yielded = hn::Div(one, hn::Add(one, hn::Mul(per_square, hn::Max(hn::Load(d, job.around + i), zero))));
    const V beyond = hn::Div(hn::Max(hn::Sub(hn::Abs(hn::Load(d, job.distance + i)), near), zero), reach);
    const V nearness = hn::Div(one, hn::Add(one, hn::Mul(beyond, beyond)));
    const V share = hn::IfThenElse(inside, hn::Mul(yielded, nearness), one);
    const V weight = hn::Mul(hn::Load(d, job.weight + i), share);
    hn::Store(share, d, job.share + i);
    hn::Store(weight, d, job.weight + i);
    hn::Store(hn::IfThenElseZero(inside, hn::Mul(weight, hn::Load(d, job.curvature + i))), d, job.product + i);
    hn::Store(hn::IfThenElseZero(inside, one), d, job.curvature + i);
  }
}

void inverse(const BandRows& band, const InverseJob& job, size_t begin, size_t end) {
  const D d;
  const V half = hn::Set(d, 0.5f), diffusion = hn::Set(d, job.diffusion), reaction = hn::Set(d, job.reaction);
  for (size_t r = begin; r < end; ++r) {
    for (int x = 0; x < brick_side; x += lane_count()) {
      const size_t i = r * brick_side + static_cast<size_t>(x);
      const V degree = degree_of(band.degree + i);
      V e = hn::Set(d, 1.0f), sum = degree;
      if (job.extent) {
        e = hn::Load(d, job.extent + i);
        sum = hn::Mul(half, hn::Add(hn::Mul(degree, e), neighbor_sum(Plain{job.extent}, band.neighbors[r], r, x)));
      }
      const V diagonal = hn::Add(hn::Add(hn::Mul(diffusion, sum), hn::Sqrt(hn::Mul(hn::Load(d, job.weights + i), e))),
                                 hn::Mul(reaction, e));
      // A vertex without neighbours is tied to nothing.
      hn::Store(hn::IfThenElseZero(hn::Gt(degree, hn::Zero(d)), hn::Div(hn::Set(d, job.omega), diagonal)), d,
                job.inverse + i);
    }
  }
}

/// sum_j w_ij x_j.
template <class Values, class Extended>
HWY_INLINE V coupling(const CycleJob& job, const Values& x, const Extended& extended, const Neighbors& n, size_t row,
                      int lane) {
  const D d;
  const V sum = neighbor_sum(x, n, row, lane);
  if (!job.extent) return hn::Mul(hn::Set(d, job.diffusion), sum);
  const V here = hn::Load(d, job.extent + row * brick_side + static_cast<size_t>(lane));
  return hn::Mul(hn::Set(d, 0.5f * job.diffusion), hn::Add(hn::Mul(here, sum), neighbor_sum(extended, n, row, lane)));
}

/// A brick's values at the places of its rows, 0 where it has none.
struct PlacedRows {
  HWY_ALIGN float row[brick_area][brick_side] = {};
};

/// The five coarse values below one row of fine ones, from `half` on.
HWY_INLINE void add_across(const float* fine, int half, float* row, float* right) {
#if SOAPFILM_ROW_IN_A_VECTOR
  // The fine vertices on, left and right of the coarse ones.
  HWY_ALIGN static constexpr int32_t index[2][3][brick_side] = {
      {{0, 2, 4, 6, 0, 0, 0, 0}, {0, 1, 3, 5, 7, 0, 0, 0}, {1, 3, 5, 7, 0, 0, 0, 0}},
      {{0, 0, 0, 0, 0, 2, 4, 6}, {0, 0, 0, 0, 0, 1, 3, 5}, {0, 0, 0, 0, 1, 3, 5, 7}}};
  HWY_ALIGN static constexpr float weight[2][3][brick_side] = {
      {{1, 1, 1, 1, 0, 0, 0, 0}, {0, 0.5f, 0.5f, 0.5f, 0.5f, 0, 0, 0}, {0.5f, 0.5f, 0.5f, 0.5f, 0, 0, 0, 0}},
      {{0, 0, 0, 0, 1, 1, 1, 1}, {0, 0, 0, 0, 0, 0.5f, 0.5f, 0.5f}, {0, 0, 0, 0, 0.5f, 0.5f, 0.5f, 0.5f}}};
  const D d;
  const V v = hn::Load(d, fine);
  const auto part = [&](int k) {
    const size_t upper = half / 4;
    return hn::Mul(hn::TableLookupLanes(v, hn::SetTableIndices(d, index[upper][k])), hn::Load(d, weight[upper][k]));
  };
  hn::Store(hn::Add(hn::Load(d, row), hn::Add(part(0), hn::Add(part(1), part(2)))), d, row);
#else
  for (int i = 0; i < 4; ++i)
    row[half + i] += fine[2 * i] + ((i == 0 ? 0.0f : 0.5f * fine[2 * i - 1]) + 0.5f * fine[2 * i + 1]);
  if (half == 0) row[4] += 0.5f * fine[7];
#endif
  if (half != 0) right[0] += 0.5f * fine[7];
}

/// Sums along one axis: to[k] = from[2 k] + (from[2 k - 1] + from[2 k + 1]) / 2 over rows `stride` apart, k = 0..4.
HWY_INLINE void sum_along(const float* from, size_t stride, float* to, size_t to_stride) {
  const D d;
  const V half = hn::Set(d, 0.5f);
  for (int x = 0; x < brick_side; x += lane_count()) {
    V before = hn::Zero(d);
    for (size_t k = 0; k < BrickTransfer::side - 1; ++k) {
      const V after = hn::Mul(half, hn::Load(d, from + (2 * k + 1) * stride + x));
      hn::Store(hn::Add(hn::Load(d, from + 2 * k * stride + x), hn::Add(before, after)), d, to + k * to_stride + x);
      before = after;
    }
    hn::Store(before, d, to + (BrickTransfer::side - 1) * to_stride + x);
  }
}

/// coarse += P^T fine.
HWY_INLINE void add_restricted(const PlacedRows& fine, const BrickTransfer& transfer, float* coarse) {
  constexpr size_t side = BrickTransfer::side;
  HWY_ALIGN float along_y[brick_side * side][brick_side], along_z[side * side][brick_side];
  for (size_t z = 0; z < brick_side; ++z)
    sum_along(fine.row[z * brick_side], brick_side, along_y[z * side], brick_side);
  for (size_t y = 0; y < side; ++y) sum_along(along_y[y], side * brick_side, along_z[y], side * brick_side);
  HWY_ALIGN float nowhere[brick_side] = {};  // coarse rows that are missing get nothing but zeros
  for (size_t k = 0; k < side * side; ++k) {
    if ((transfer.row[k] | transfer.right[k]) == 0) continue;
    const auto to = [&](uint32_t row) { return row == 0 ? nowhere : coarse + size_t{row} * brick_side; };
    add_across(along_z[k], transfer.half, to(transfer.row[k]), to(transfer.right[k]));
  }
}

void restrict_brick(const BrickTransfer& transfer, const float* from, float* coarse) {
  PlacedRows fine;
  for (size_t r = 0; r < transfer.count; ++r)
    std::copy_n(from + (transfer.first + r) * brick_side, brick_side, fine.row[transfer.place[r]]);
  add_restricted(fine, transfer, coarse);
}

void restrict_residual(const BandRows& band, const CycleJob& job, const BrickTransfer& transfer, float* coarse) {
  const D d;
  const Product x{job.inverse, job.b};
  const V rest = hn::Set(d, 1 - job.omega);
  PlacedRows residual;
  for (size_t k = 0; k < transfer.count; ++k) {
    const size_t r = transfer.first + k;
    for (int lane = 0; lane < brick_side; lane += lane_count()) {
      const size_t i = r * brick_side + static_cast<size_t>(lane);
      // The diagonal's share of K x is omega b.
      const V left = hn::Add(hn::Mul(rest, hn::Load(d, job.b + i)),
                             coupling(job, x, Weighted{x, job.extent}, band.neighbors[r], r, lane));
      hn::Store(hn::IfThenElseZero(hn::Gt(hn::Load(d, job.inverse + i), hn::Zero(d)), left), d,
                residual.row[transfer.place[k]] + lane);
    }
  }
  add_restricted(residual, transfer, coarse);
}

double smooth(const BandRows& band, const CycleJob& job, size_t begin, size_t end) {
  const D d;
  const V rest = hn::Set(d, 1 - job.omega);
  LaneSum sum;
  for (size_t r = begin; r < end; ++r) {
    for (int lane = 0; lane < brick_side; lane += lane_count()) {
      const size_t i = r * brick_side + static_cast<size_t>(lane);
      const V push = hn::Add(hn::Load(d, job.b + i),
                             coupling(job, Plain{job.x}, Product{job.x, job.extent}, band.neighbors[r], r, lane));
      const V out = hn::Add(hn::Mul(rest, hn::Load(d, job.x + i)), hn::Mul(hn::Load(d, job.inverse + i), push));
      hn::Store(out, d, job.out + i);
      if (job.weight) sum.add(hn::Mul(out, hn::Load(d, job.weight + i)), lane);
    }
    sum.end_row();
  }
  return sum.total();
}

HWY_INLINE V mix(V a, V b, V t) { return hn::Add(a, hn::Mul(t, hn::Sub(b, a))); }

/// Adds one row of cells; the terms of <v, what is added> go to `energy`.
HWY_INLINE void add_cells(const BandRows& band, const DataJob& job, size_t k, LaneSum& energy) {
  const D d;
  const CellRow& cells = job.cells[k];
  // The rows of the corners, y fastest, and those right of them.
  const auto next = [&](size_t row, size_t side) { return size_t{band.neighbors[row][side]}; };
  const size_t own = job.row[k], rows[4] = {own, next(own, 3), next(own, 5), next(next(own, 3), 5)};
  const size_t right[4] = {next(rows[0], 1), next(rows[1], 1), next(rows[2], 1), next(rows[3], 1)};
  const int lanes = lane_count();
  // Lanes moved up by one, round the end.
  HWY_ALIGN int32_t up[brick_side];
  for (int i = 0; i < lanes; ++i) up[i] = (i + lanes - 1) % lanes;
  const auto moved_up = hn::SetTableIndices(d, up);
  const auto all_but_last = hn::FirstN(d, static_cast<size_t>(lanes) - 1);
  const auto first = hn::FirstN(d, 1);
  const V one = hn::Set(d, 1.0f), scale = hn::Set(d, job.scale);
  float carry[4] = {};
  for (int x = 0; x < brick_side; x += lanes) {
    const V fx = hn::Load(d, cells.fraction[0] + x), fy = hn::Load(d, cells.fraction[1] + x),
            fz = hn::Load(d, cells.fraction[2] + x);
    const V nx = hn::Load(d, cells.normal[0] + x), ny = hn::Load(d, cells.normal[1] + x),
            nz = hn::Load(d, cells.normal[2] + x);
    const V weight = hn::Mul(scale, hn::Load(d, cells.weight + x));
    V value = one, gx = hn::Zero(d), gy = hn::Zero(d), gz = hn::Zero(d);
    if (job.v) {
      const auto low = [&](size_t c) { return hn::Load(d, job.v + rows[c] * brick_side + x); };
      const auto high = [&](size_t c) {
        const V above = hn::LoadU(d, job.v + rows[c] * brick_side + x + 1);
        return x + lanes < brick_side ? above
                                      : hn::IfThenElse(all_but_last, above, hn::Set(d, job.v[right[c] * brick_side]));
      };
      // Value and gradient, trilinear.
      const V l0 = low(0), l1 = low(1), l2 = low(2), l3 = low(3);
      const V d0 = hn::Sub(high(0), l0), d1 = hn::Sub(high(1), l1), d2 = hn::Sub(high(2), l2),
              d3 = hn::Sub(high(3), l3);
      const V m0 = hn::Add(l0, hn::Mul(fx, d0)), m1 = hn::Add(l1, hn::Mul(fx, d1)), m2 = hn::Add(l2, hn::Mul(fx, d2)),
              m3 = hn::Add(l3, hn::Mul(fx, d3));
      const V y0 = mix(m0, m1, fy), y1 = mix(m2, m3, fy);
      value = mix(y0, y1, fz);
      gx = mix(mix(d0, d1, fy), mix(d2, d3, fy), fz);
      gy = mix(hn::Sub(m1, m0), hn::Sub(m3, m2), fz);
      gz = hn::Sub(y1, y0);
    }
    if (job.affine) {
      gx = hn::Add(gx, nx);
      gy = hn::Add(gy, ny);
      gz = hn::Add(gz, nz);
    }
    // Half of the energy's derivatives by them.
    const V along = hn::Mul(hn::Set(d, job.slope - job.normal),
                            hn::Add(hn::Add(hn::Mul(nx, gx), hn::Mul(ny, gy)), hn::Mul(nz, gz)));
    const V across = hn::Set(d, job.normal);
    const V pv = hn::Mul(weight, value);
    const V px = hn::Mul(weight, hn::Add(hn::Mul(across, gx), hn::Mul(along, nx)));
    const V py = hn::Mul(weight, hn::Add(hn::Mul(across, gy), hn::Mul(along, ny)));
    const V pz = hn::Mul(weight, hn::Add(hn::Mul(across, gz), hn::Mul(along, nz)));
    energy.add(hn::Add(hn::Add(hn::Mul(pv, value), hn::Mul(px, gx)), hn::Add(hn::Mul(py, gy), hn::Mul(pz, gz))), x);
    // And back to the corners, the same way in reverse.
    const V qy = hn::Sub(one, fy), qx = hn::Sub(one, fx);
    const V z1 = hn::Add(hn::Mul(fz, pv), pz), z0 = hn::Sub(pv, z1);
    const V ey1 = hn::Mul(fz, py), ey0 = hn::Sub(py, ey1);
    const V ex1 = hn::Mul(fz, px), ex0 = hn::Sub(px, ex1);
    const V corner[4] = {hn::Sub(hn::Mul(qy, z0), ey0), hn::Add(hn::Mul(fy, z0), ey0), hn::Sub(hn::Mul(qy, z1), ey1),
                         hn::Add(hn::Mul(fy, z1), ey1)};
    const V slope[4] = {hn::Mul(qy, ex0), hn::Mul(fy, ex0), hn::Mul(qy, ex1), hn::Mul(fy, ex1)};
    for (size_t c = 0; c < 4; ++c) {
      const V to_low = hn::Sub(hn::Mul(qx, corner[c]), slope[c]), to_high = hn::Add(hn::Mul(fx, corner[c]), slope[c]);
      const V moved = hn::TableLookupLanes(to_high, moved_up);
      float* to = job.out + rows[c] * brick_side + x;
      const V from_left = hn::IfThenElse(first, hn::Set(d, carry[c]), moved);
      hn::Store(hn::Add(hn::Load(d, to), hn::Add(to_low, from_left)), d, to);
      carry[c] = hn::GetLane(moved);
    }
  }
  if (cells.weight[brick_side - 1] > 0)  // else there may be no such row, and row 0 is nobody's to write
    for (size_t c = 0; c < 4; ++c) job.out[right[c] * brick_side] += carry[c];
  energy.end_row();
}

double data_term(const BandRows& band, const DataJob& job, size_t begin, size_t end) {
  LaneSum energy;
  for (size_t k = begin; k < end; ++k) add_cells(band, job, k, energy);
  return energy.total();
}

void prolong_brick(const CycleJob& job, const BrickTransfer& transfer) {
  constexpr int side = BrickTransfer::side;
  const D d;
  HWY_ALIGN float coarse[side * side][brick_side];  // five values in each row
  for (size_t k = 0; k < side * side; ++k) {
    const float* from = job.x + size_t{transfer.row[k]} * brick_side + transfer.half;
    for (int x = 0; x < brick_side; x += lane_count()) hn::Store(hn::LoadU(d, from + x), d, coarse[k] + x);
    if (transfer.half != 0) coarse[k][4] = job.x[size_t{transfer.right[k]} * brick_side];
  }
  for (size_t k = 0; k < transfer.count; ++k) {
    const int y = transfer.place[k] & 7, z = transfer.place[k] >> 3;
    const int low = y / 2 + side * (z / 2), up_y = y & 1, up_z = side * (z & 1);
    const auto mean = [&](int x) {
      const auto at = [&](int row) { return hn::Load(d, coarse[low + row] + x); };
      return hn::Mul(hn::Set(d, 0.25f), hn::Add(hn::Add(at(0), at(up_y)), hn::Add(at(up_z), at(up_y + up_z))));
    };
    HWY_ALIGN float values[brick_side];
#if SOAPFILM_ROW_IN_A_VECTOR
    HWY_ALIGN static constexpr int32_t down[brick_side] = {0, 0, 1, 1, 2, 2, 3, 3};
    HWY_ALIGN static constexpr int32_t up[brick_side] = {0, 1, 1, 2, 2, 3, 3, 4};
    const V five = mean(0);
    hn::Store(hn::Mul(hn::Set(d, 0.5f), hn::Add(hn::TableLookupLanes(five, hn::SetTableIndices(d, down)),
                                                hn::TableLookupLanes(five, hn::SetTableIndices(d, up)))),
              d, values);
#else
    HWY_ALIGN float five[brick_side];
    for (int x = 0; x < brick_side; x += lane_count()) hn::Store(mean(x), d, five + x);
    for (int x = 0; x < brick_side; ++x) values[x] = 0.5f * (five[x / 2] + five[(x + 1) / 2]);
#endif
    for (int x = 0; x < brick_side; x += lane_count()) {
      const size_t i = (transfer.first + k) * brick_side + static_cast<size_t>(x);
      const V inverse = hn::Load(d, job.inverse + i);
      const V value = hn::Load(d, values + x);
      const V onto = job.b ? hn::Add(hn::Mul(inverse, hn::Load(d, job.b + i)), value) : value;
      hn::Store(hn::IfThenElseZero(hn::Gt(inverse, hn::Zero(d)), onto), d, job.out + i);
    }
  }
}

}  // namespace

inline RowKernel rows() {
  return {&laplacian,         &bend,   &curvature, &share,          &inverse,
          &restrict_residual, &smooth, &data_term, &restrict_brick, &prolong_brick};
}

}  // namespace soapfilm::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
