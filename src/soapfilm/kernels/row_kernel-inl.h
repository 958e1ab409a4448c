// The loops over rows, compiled once per SIMD target (no include guard: see Highway's foreach_target.h).
// No fused multiply-add, no reciprocal estimates, sums by lane of the row: every target rounds in the same way.

#include "soapfilm/kernels/row_ops-inl.h"
//
#include "soapfilm/kernels/cycle_kernel-inl.h"
#include "soapfilm/kernels/data_kernel-inl.h"
#include "soapfilm/kernels/sample_kernel-inl.h"

HWY_BEFORE_NAMESPACE();
namespace soapfilm::HWY_NAMESPACE {
namespace {

double laplacian(const BandRows& band, const LaplacianJob& job, size_t begin, size_t end) {
  const D d;
  const V weight_v = hn::Set(d, job.weight_v), weight_g = hn::Set(d, job.weight_g);
  LaneSum sum;
  for (size_t r = begin; r < end; ++r) {
    fetch_neighbors(job.v, band.neighbors[r + rows_ahead]);
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

/// R v: differences to neighbors whose opposite neighbor is not in the band; outside the band v is 0.
HWY_INLINE V one_sided(const BandRows& band, const float* v, size_t row, int x) {
  const D d;
  const Neighbors& n = band.neighbors[row];
  const AxisSums sums = axis_sums(Plain{v}, n, row, x);
  const V here = hn::Load(d, v + row * brick_side + static_cast<size_t>(x));
  const unsigned own = band.mask[row];
  const unsigned below = own << 1 | band.mask[n[0]] >> 7, above = own >> 1 | (band.mask[n[1]] & 1u) << 7;
  const auto where = [&](unsigned one_of_two, V sum) {
    return hn::IfThenElseZero(lanes_of(one_of_two, x), hn::Sub(here, sum));
  };
  return hn::Add(where(below ^ above, sums.x), hn::Add(where(band.mask[n[2]] ^ band.mask[n[3]], sums.y),
                                                       where(band.mask[n[4]] ^ band.mask[n[5]], sums.z)));
}

void bend(const BandRows& band, const CurvatureResidualJob& job, size_t begin, size_t end) {
  const D d;
  const V beta = hn::Set(d, job.beta), gamma = hn::Set(d, job.gamma);
  for (size_t r = begin; r < end; ++r) {
    fetch_neighbors(job.v, band.neighbors[r + rows_ahead]);
    fetch_neighbors(job.start, band.neighbors[r + rows_ahead]);
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
      hn::Store(hn::IfThenElseZero(hn::Gt(degree, hn::Zero(d)), c), d, job.curvature + i);
      hn::Store(weight, d, job.weight + i);
      hn::Store(hn::IfThenElseZero(inside, hn::Mul(hn::Mul(weight, off), off)), d, job.product + i);
    }
  }
}

/// Bits of the vertices of a row that have both neighbors along x in the band.
HWY_INLINE unsigned inner_along_x(const BandRows& band, size_t row) {
  const unsigned own = band.mask[row], below = band.mask[band.neighbors[row][0]],
                 above = band.mask[band.neighbors[row][1]];
  return (own << 1 | below >> 7) & (own >> 1 | above << 7);
}

/// For a row: whether the eighteen vertices around each one are in the band. `diagonal`: the rows at -y -z, +y -z, -y
/// +z and +y +z.
HWY_INLINE unsigned surrounded(const BandRows& band, size_t row, const std::array<uint32_t, 4>& diagonal) {
  const Neighbors& n = band.neighbors[row];
  unsigned bits = band.mask[row] & inner_along_x(band, row);
  for (size_t k = 2; k < 6; ++k) bits &= band.mask[n[k]] & inner_along_x(band, n[k]);
  for (const uint32_t d : diagonal) bits &= band.mask[d];
  return bits;
}

/// (k1 - k2)^2 of the vertices from x on in a row, 2 |D^2 v|^2 - (laplacian v)^2 by central differences.
HWY_INLINE V squared_saddles(const BandRows& band, const float* v, size_t row, const std::array<uint32_t, 4>& diagonal,
                             int x) {
  const D d;
  const Neighbors& n = band.neighbors[row];
  const V two = hn::Set(d, 2.0f), quarter = hn::Set(d, 0.25f);
  const auto at = [&](size_t r) { return hn::Load(d, v + r * brick_side + static_cast<size_t>(x)); };
  const auto along_x = [&](size_t r) { return sides(Plain{v}, band.neighbors[r], r, x); };
  const V here = hn::Mul(two, at(row));
  const auto second = [&](V above, V below) { return hn::Sub(hn::Add(above, below), here); };
  const auto mixed = [&](V pp, V mm, V mp, V pm) {
    return hn::Mul(quarter, hn::Sub(hn::Sub(hn::Add(pp, mm), mp), pm));
  };
  const Sides own = along_x(row), y0 = along_x(n[2]), y1 = along_x(n[3]), z0 = along_x(n[4]), z1 = along_x(n[5]);
  const V xx = second(own.above, own.below), yy = second(at(n[3]), at(n[2])), zz = second(at(n[5]), at(n[4]));
  const V xy = mixed(y1.above, y0.below, y1.below, y0.above), xz = mixed(z1.above, z0.below, z1.below, z0.above),
          yz = mixed(at(diagonal[3]), at(diagonal[0]), at(diagonal[1]), at(diagonal[2]));
  const V pure = hn::Add(hn::Add(hn::Mul(xx, xx), hn::Mul(yy, yy)), hn::Mul(zz, zz));
  const V cross = hn::Add(hn::Add(hn::Mul(xy, xy), hn::Mul(xz, xz)), hn::Mul(yz, yz));
  const V sum = hn::Add(hn::Add(xx, yy), zz);
  const V square = hn::Sub(hn::Mul(two, hn::Add(pure, hn::Mul(two, cross))), hn::Mul(sum, sum));
  return hn::Max(square, hn::Zero(d));
}

void saddles(const BandRows& band, const SaddleJob& job, size_t begin, size_t end) {
  const D d;
  const V one = hn::Set(d, 1.0f);
  for (size_t r = begin; r < end; ++r) {
    bool near = false;
    for (int x = 0; x < brick_side; x += lane_count())
      near |= !hn::AllFalse(d, hn::Eq(hn::Load(d, job.weight + r * brick_side + static_cast<size_t>(x)), one));
    if (!near) continue;
    const Neighbors& n = band.neighbors[r];
    const std::array<uint32_t, 4> diagonal = {band.neighbors[n[2]][4], band.neighbors[n[3]][4], band.neighbors[n[2]][5],
                                              band.neighbors[n[3]][5]};
    const unsigned known = surrounded(band, r, diagonal);
    if (known == 0) continue;
    for (int x = 0; x < brick_side; x += lane_count()) {
      const size_t i = r * brick_side + static_cast<size_t>(x);
      const V square = hn::IfThenElseZero(lanes_of(known, x), squared_saddles(band, job.v, r, diagonal, x));
      const V sum = hn::Add(hn::Load(d, job.product + i), hn::Mul(hn::Load(d, job.weight + i), square));
      hn::Store(sum, d, job.product + i);
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

}  // namespace

inline RowKernel rows() {
  return {&laplacian,         &bend,   &curvature, &saddles,     &share,          &inverse,
          &restrict_residual, &smooth, &data_term, &add_samples, &restrict_brick, &prolong_brick};
}

}  // namespace soapfilm::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
