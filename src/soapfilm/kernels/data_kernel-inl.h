// The data term's kernel, compiled once per SIMD target (no include guard: see Highway's foreach_target.h). After
// row_ops-inl.h.

HWY_BEFORE_NAMESPACE();
namespace soapfilm::HWY_NAMESPACE {
namespace {

/// For every byte, how many bits below each bit are set.
struct Ranks {
  uint8_t below[256][brick_side];
};
constexpr Ranks make_ranks() {
  Ranks ranks{};
  for (unsigned bits = 0; bits < 256; ++bits)
    for (unsigned i = 1; i < brick_side; ++i)
      ranks.below[bits][i] = static_cast<uint8_t>(ranks.below[bits][i - 1] + (bits >> (i - 1) & 1));
  return ranks;
}
constexpr Ranks ranks = make_ranks();

/// The cells of a row from x on, as many as there are lanes: values are stored only for cells that exist, and are moved
/// to their lanes.
class PresentCells {
 public:
  HWY_INLINE PresentCells(const DataJob& job, size_t k, int x)
      : count_(static_cast<size_t>(std::popcount(job.present[k]))) {
    const unsigned present = job.present[k];
    const auto bits = static_cast<uint8_t>(present >> x);
    const hn::Rebind<uint8_t, D> bytes;
    const hn::Rebind<int32_t, D> integers;
    there_ = lanes_of(present, x);
    // Bits beyond the last lane's belong to other lanes and have no effect here.
    rank_ = hn::IndicesFromVec(D(), hn::PromoteTo(integers, hn::LoadU(bytes, ranks.below[bits])));
    at_ = job.cells + DataJob::values * size_t{job.first[k]} +
          static_cast<size_t>(std::popcount(present & ((1u << x) - 1)));
  }
  HWY_INLINE V load(size_t value) const {
    return hn::IfThenElseZero(there_, hn::TableLookupLanes(hn::LoadU(D(), at_ + value * count_), rank_));
  }

 private:
  size_t count_;
  const float* at_;
  hn::Mask<D> there_;
  decltype(hn::IndicesFromVec(D(), hn::Zero(hn::Rebind<int32_t, D>()))) rank_;
};

/// Adds one row of cells; the terms of <v, what is added> are added to `energy`.
HWY_INLINE void add_cells(const BandRows& band, const DataJob& job, size_t k, LaneSum& energy) {
  const D d;
  // The rows of the corners, y fastest, and those right of them.
  const auto next = [&](size_t row, size_t side) { return size_t{band.neighbors[row][side]}; };
  const size_t own = job.row[k], rows[4] = {own, next(own, 3), next(own, 5), next(next(own, 3), 5)};
  const size_t right[4] = {next(rows[0], 1), next(rows[1], 1), next(rows[2], 1), next(rows[3], 1)};
  const int lanes = lane_count();
  // Lanes moved up by one, cyclic.
  HWY_ALIGN int32_t up[brick_side];
  for (int i = 0; i < lanes; ++i) up[i] = (i + lanes - 1) % lanes;
  const auto moved_up = hn::SetTableIndices(d, up);
  const auto all_but_last = hn::FirstN(d, static_cast<size_t>(lanes) - 1);
  const auto first = hn::FirstN(d, 1);
  const V one = hn::Set(d, 1.0f), scale = hn::Set(d, job.scale);
  float carry[4] = {};
  for (int x = 0; x < brick_side; x += lanes) {
    const PresentCells cells(job, k, x);
    const V fx = cells.load(0), fy = cells.load(1), fz = cells.load(2);
    const V nx = cells.load(3), ny = cells.load(4), nz = cells.load(5);
    const V weight = hn::Mul(scale, cells.load(6));
    V value = one, gx = hn::Zero(d), gy = hn::Zero(d), gz = hn::Zero(d);
    if (job.v) {
      const auto low = [&](size_t c) { return hn::Load(d, job.v + rows[c] * brick_side + x); };
      const auto high = [&](size_t c) {
        const V above = hn::LoadU(d, job.v + rows[c] * brick_side + x + 1);
        return x + lanes < brick_side ? above
                                      : hn::IfThenElse(all_but_last, above, hn::Set(d, job.v[right[c] * brick_side]));
      };
      const Jets jets = trilinear({low(0), low(1), low(2), low(3)}, {high(0), high(1), high(2), high(3)}, fx, fy, fz);
      value = jets.value;
      gx = jets.x;
      gy = jets.y;
      gz = jets.z;
    }
    if (job.affine) {
      gx = hn::Add(gx, nx);
      gy = hn::Add(gy, ny);
      gz = hn::Add(gz, nz);
    }
    // Half of the derivatives of the energy with respect to them.
    const V along = hn::Mul(hn::Set(d, job.slope - job.normal),
                            hn::Add(hn::Add(hn::Mul(nx, gx), hn::Mul(ny, gy)), hn::Mul(nz, gz)));
    const V across = hn::Set(d, job.normal);
    const V pv = hn::Mul(weight, value);
    const V px = hn::Mul(weight, hn::Add(hn::Mul(across, gx), hn::Mul(along, nx)));
    const V py = hn::Mul(weight, hn::Add(hn::Mul(across, gy), hn::Mul(along, ny)));
    const V pz = hn::Mul(weight, hn::Add(hn::Mul(across, gz), hn::Mul(along, nz)));
    energy.add(hn::Add(hn::Add(hn::Mul(pv, value), hn::Mul(px, gx)), hn::Add(hn::Mul(py, gy), hn::Mul(pz, gz))), x);
    if (!job.out) continue;
    // Back to the corners, the same steps in reverse.
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
  energy.end_row();
  if (!job.out) return;
  if (job.present[k] >> (brick_side - 1) != 0)  // otherwise there may be no such row, and row 0 must stay 0
    for (size_t c = 0; c < 4; ++c) job.out[right[c] * brick_side] += carry[c];
}

/// Prefetches for later rows of cells: for those far ahead the neighbor indices, for nearer ones the values at corners
/// in other rows.
HWY_INLINE void fetch_corners(const BandRows& band, const DataJob& job, size_t k, size_t end) {
  constexpr size_t far = 16, near = 8;
  if (k + far < end) {
    const size_t row = job.row[k + far];
    hwy::Prefetch(&band.neighbors[row]);
    if (job.out) hwy::Prefetch(job.out + row * brick_side);
    if (job.v) hwy::Prefetch(job.v + row * brick_side);
  }
  if (k + near < end) {
    const Neighbors& n = band.neighbors[job.row[k + near]];
    for (const size_t side : {1, 3, 5}) {
      hwy::Prefetch(&band.neighbors[n[side]]);
      if (job.out) hwy::Prefetch(job.out + size_t{n[side]} * brick_side);
      if (job.v) hwy::Prefetch(job.v + size_t{n[side]} * brick_side);
    }
  }
}

double data_term(const BandRows& band, const DataJob& job, size_t begin, size_t end) {
  LaneSum energy;
  for (size_t k = begin; k < end; ++k) {
    fetch_corners(band, job, k, end);
    add_cells(band, job, k, energy);
  }
  return energy.total();
}

}  // namespace
}  // namespace soapfilm::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
