// The kernels of a multigrid cycle, compiled once per SIMD target (no include guard: see Highway's foreach_target.h):
// the preconditioner's diagonals and damped Jacobi steps, restriction and prolongation. After row_ops-inl.h.

#include <algorithm>

// If a row is one vector, its lanes are shuffled in registers.
#undef SOAPFILM_ROW_IN_A_VECTOR
#define SOAPFILM_ROW_IN_A_VECTOR (HWY_ARCH_X86 && HWY_MAX_BYTES >= 32)

HWY_BEFORE_NAMESPACE();
namespace soapfilm::HWY_NAMESPACE {
namespace {

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
      // A vertex without neighbors has no equation: 0.
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

/// A brick's values in the order of its rows, 0 for rows that it does not have.
struct PlacedRows {
  HWY_ALIGN float row[brick_area][brick_side] = {};
};

/// The five coarse values below one row of fine ones, from `half` on.
HWY_INLINE void add_across(const float* fine, int half, float* row, float* right) {
#if SOAPFILM_ROW_IN_A_VECTOR
  // The fine vertices at, left of and right of the coarse ones.
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
  HWY_ALIGN float nowhere[brick_side] = {};  // used for missing coarse rows, which only get zeros
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

/// The factor by which a Jacobi step of uniform length reduces a value, at vertices with so many neighbors.
HWY_INLINE V kept_by_even_step(const CycleJob& job, V degree) {
  const D d;
  return hn::Sub(hn::Set(d, 1 - job.step * job.reaction), hn::Mul(hn::Set(d, job.step * job.diffusion), degree));
}

/// The residual after one Jacobi step from zero, which gave x, in one brick.
template <class Values>
void residual_of_step(const BandRows& band, const CycleJob& job, const BrickTransfer& transfer, const Values& x,
                      PlacedRows& residual) {
  const D d;
  const V rest = hn::Set(d, 1 - job.omega);
  for (size_t k = 0; k < transfer.count; ++k) {
    const size_t r = transfer.first + k;
    x.fetch(band.neighbors[r + rows_ahead]);
    for (int lane = 0; lane < brick_side; lane += lane_count()) {
      const size_t i = r * brick_side + static_cast<size_t>(lane);
      // The diagonal's part of K x is omega b.
      const V left = hn::Add(hn::Mul(rest, hn::Load(d, job.b + i)),
                             coupling(job, x, Plain{job.extended}, band.neighbors[r], r, lane));
      hn::Store(hn::IfThenElseZero(hn::Gt(hn::Load(d, job.inverse + i), hn::Zero(d)), left), d,
                residual.row[transfer.place[k]] + lane);
    }
  }
}

void residual_of_even_step(const BandRows& band, const CycleJob& job, const BrickTransfer& transfer,
                           PlacedRows& residual) {
  const D d;
  const V around = hn::Set(d, job.step * job.diffusion);
  for (size_t k = 0; k < transfer.count; ++k) {
    const size_t r = transfer.first + k;
    fetch_neighbors(job.b, band.neighbors[r + rows_ahead]);
    for (int lane = 0; lane < brick_side; lane += lane_count()) {
      const size_t i = r * brick_side + static_cast<size_t>(lane);
      const V degree = degree_of(band.degree + i);
      const V left = hn::Add(hn::Mul(kept_by_even_step(job, degree), hn::Load(d, job.b + i)),
                             hn::Mul(around, neighbor_sum(Plain{job.b}, band.neighbors[r], r, lane)));
      hn::Store(hn::IfThenElseZero(hn::Gt(degree, hn::Zero(d)), left), d, residual.row[transfer.place[k]] + lane);
    }
  }
}

void restrict_residual(const BandRows& band, const CycleJob& job, const BrickTransfer& transfer, float* coarse) {
  PlacedRows residual;
  if (!job.inverse)
    residual_of_even_step(band, job, transfer, residual);
  else if (job.extent)
    residual_of_step(band, job, transfer, Plain{job.x}, residual);
  else
    residual_of_step(band, job, transfer, Product{job.inverse, job.b}, residual);
  add_restricted(residual, transfer, coarse);
}

double smooth_evenly(const BandRows& band, const CycleJob& job, size_t begin, size_t end) {
  const D d;
  const V step = hn::Set(d, job.step), diffusion = hn::Set(d, job.diffusion);
  LaneSum sum;
  for (size_t r = begin; r < end; ++r) {
    for (int lane = 0; lane < brick_side; lane += lane_count()) {
      const size_t i = r * brick_side + static_cast<size_t>(lane);
      const V degree = degree_of(band.degree + i);
      const V around = hn::Mul(diffusion, neighbor_sum(Plain{job.x}, band.neighbors[r], r, lane));
      const V push = hn::Mul(step, hn::Add(hn::Load(d, job.b + i), around));
      const V moved = hn::Add(hn::Mul(kept_by_even_step(job, degree), hn::Load(d, job.x + i)), push);
      const V out = hn::IfThenElseZero(hn::Gt(degree, hn::Zero(d)), moved);
      hn::Store(out, d, job.out + i);
      if (job.weight) sum.add(hn::Mul(out, hn::Load(d, job.weight + i)), lane);
    }
    sum.end_row();
  }
  return sum.total();
}

double smooth(const BandRows& band, const CycleJob& job, size_t begin, size_t end) {
  if (!job.inverse) return smooth_evenly(band, job, begin, end);
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

/// Where the four coarse rows around a fine row at y + 8 z start among the 25 above a brick.
constexpr auto coarse_slots = [] {
  std::array<std::array<uint16_t, 4>, brick_area> table{};
  for (size_t place = 0; place < brick_area; ++place) {
    const size_t y = place % brick_side, z = place / brick_side;
    for (size_t k = 0; k < 4; ++k)
      table[place][k] =
          static_cast<uint16_t>(((y + (k & 1)) / 2 + BrickTransfer::side * ((z + k / 2) / 2)) * brick_side);
  }
  return table;
}();

void prolong_brick(const BandRows& band, const CycleJob& job, const BrickTransfer& transfer) {
  constexpr int side = BrickTransfer::side;
  const D d;
  HWY_ALIGN float coarse[side * side * brick_side];  // row after row, five values in each
  for (size_t k = 0; k < side * side; ++k) {
    float* row = coarse + k * brick_side;
    const float* from = job.x + size_t{transfer.row[k]} * brick_side + transfer.half;
    for (int x = 0; x < brick_side; x += lane_count()) hn::Store(hn::LoadU(d, from + x), d, row + x);
    if (transfer.half != 0) row[4] = job.x[size_t{transfer.right[k]} * brick_side];
  }
  const size_t first = transfer.first * size_t{brick_side};
  const float *inverses = job.inverse ? job.inverse + first : nullptr, *b = job.b ? job.b + first : nullptr;
  const uint8_t* degrees = band.degree + first;
  float* out = job.out + first;
  const uint8_t* place = transfer.place;
  const size_t count = transfer.count;
  for (size_t k = 0; k < count; ++k) {
    const std::array<uint16_t, 4>& slots = coarse_slots[place[k]];
    const auto mean = [&](int x) {
      const auto at = [&](size_t corner) { return hn::Load(d, coarse + slots[corner] + x); };
      return hn::Mul(hn::Set(d, 0.25f), hn::Add(hn::Add(at(0), at(1)), hn::Add(at(2), at(3))));
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
      const size_t i = k * brick_side + static_cast<size_t>(x);
      const V inverse = inverses
                            ? hn::Load(d, inverses + i)
                            : hn::IfThenElseZero(hn::Gt(degree_of(degrees + i), hn::Zero(d)), hn::Set(d, job.step));
      const V value = hn::Load(d, values + x);
      const V onto = b ? hn::Add(hn::Mul(inverse, hn::Load(d, b + i)), value) : value;
      hn::Store(hn::IfThenElseZero(hn::Gt(inverse, hn::Zero(d)), onto), d, out + i);
    }
  }
}

}  // namespace
}  // namespace soapfilm::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
