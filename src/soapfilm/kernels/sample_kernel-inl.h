// The kernel that weights samples, compiled once per SIMD target (no include guard: see Highway's foreach_target.h).
// After row_ops-inl.h. Results per sample equal those of the plain functions of robust.h and grid/trilinear.h, bit for
// bit.

HWY_BEFORE_NAMESPACE();
namespace soapfilm::HWY_NAMESPACE {
namespace {

HWY_INLINE V robust_weights(Penalty penalty, V residual, V scale) {
  const D d;
  const V one = hn::Set(d, 1.0f), r = hn::Div(hn::Abs(residual), scale);
  switch (penalty) {
    case Penalty::least_squares:
      return one;
    case Penalty::huber: {
      const V scales = hn::Set(d, huber_scales);
      return hn::IfThenElse(hn::Le(r, scales), one, hn::Div(scales, r));
    }
    case Penalty::geman_mcclure: {
      const V s = hn::Add(one, hn::Div(hn::Mul(r, r), hn::Set(d, 4.0f)));
      return hn::Div(one, hn::Mul(s, s));
    }
    case Penalty::tukey: {
      const V s = hn::Sub(one, hn::Div(hn::Mul(r, r), hn::Set(d, tukey_scales * tukey_scales)));
      return hn::IfThenElseZero(hn::Gt(s, hn::Zero(d)), hn::Mul(s, s));
    }
  }
  return one;
}

struct Vectors {
  V x, y, z;
};
HWY_INLINE V dot(const Vectors& a, const Vectors& b) {
  return hn::Add(hn::Add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y)), hn::Mul(a.z, b.z));
}
HWY_INLINE Vectors load_vectors(const Vec3f* from) {
  Vectors v;
  hn::LoadInterleaved3(D(), &from->x, v.x, v.y, v.z);
  return v;
}

/// Weights as many samples as there are lanes, of which the first `count` exist, and adds them to their cells; returns
/// how many of them have a weight below `doubt`.
HWY_INLINE size_t add_batch(const SampleJob& job, const Vec3f* local, const Vec3f* direction,
                            const float* sample_weight, const uint8_t* active, size_t count) {
  const D d;
  const hn::Rebind<int32_t, D> integers;
  const hn::Rebind<uint8_t, D> bytes;
  const V zero = hn::Zero(d), last = hn::Set(d, static_cast<float>(brick_side - 1));
  const Vectors place = load_vectors(local), toward = load_vectors(direction);

  // The cell, and the position in it.
  const auto floor = [&](V v) { return hn::Min(hn::Trunc(v), last); };
  const Vectors cell{floor(place.x), floor(place.y), floor(place.z)};
  const Vectors t{hn::Sub(place.x, cell.x), hn::Sub(place.y, cell.y), hn::Sub(place.z, cell.z)};
  const auto index = [&](int side) {
    const V s = hn::Set(d, static_cast<float>(side));
    return hn::ConvertTo(integers, hn::Add(cell.x, hn::Mul(s, hn::Add(cell.y, hn::Mul(s, cell.z)))));
  };
  const auto number = hn::GatherIndex(integers, job.cell, index(brick_side));

  // Value and gradient of phi.
  constexpr int side = SampleJob::corners;
  const auto corner = index(side);
  const auto corners = [&](int x) {
    const auto at = [&](int y, int z) { return hn::GatherIndex(d, job.phi + x + side * (y + side * z), corner); };
    return FourCorners{at(0, 0), at(1, 0), at(0, 1), at(1, 1)};
  };
  const Jets jet = trilinear(corners(0), corners(1), t.x, t.y, t.z);
  const Vectors gradient{jet.x, jet.y, jet.z};
  const V slope = hn::Sqrt(dot(gradient, gradient)), length = hn::Sqrt(dot(toward, toward));

  // The weight.
  const auto there = hn::FirstN(d, count);
  auto takes_part = hn::And(hn::And(there, hn::RebindMask(d, hn::Gt(number, hn::Zero(integers)))),
                            hn::Le(dot(toward, gradient), hn::Mul(hn::Mul(hn::Set(d, outside_cosine), length), slope)));
  if (active)
    takes_part = hn::And(
        takes_part, hn::RebindMask(d, hn::Gt(hn::PromoteTo(integers, hn::LoadU(bytes, active)), hn::Zero(integers))));
  const V distance = hn::Div(jet.value, hn::Max(slope, hn::Set(d, least_slope_of_distance)));
  const V trust = hn::IfThenElseZero(takes_part, robust_weights(job.penalty, distance, hn::Set(d, job.scale)));
  const V weight = sample_weight ? hn::Mul(trust, hn::LoadU(d, sample_weight)) : trust;

  // The normal.
  const Vectors& along = job.directions ? toward : gradient;
  const V by = job.directions ? length : hn::Neg(hn::Max(slope, hn::Set(d, least_slope_of_normal)));
  const auto known = hn::Ne(by, zero);
  const auto unit = [&](V v) { return hn::IfThenElseZero(known, hn::Div(v, by)); };

  HWY_ALIGN float added[2][4 * brick_side];
  HWY_ALIGN int32_t numbers[brick_side] = {};
  hn::StoreInterleaved4(hn::Mul(weight, t.x), hn::Mul(weight, t.y), hn::Mul(weight, t.z),
                        hn::Mul(weight, unit(along.x)), d, added[0]);
  hn::StoreInterleaved4(hn::Mul(weight, unit(along.y)), hn::Mul(weight, unit(along.z)), weight, zero, d, added[1]);
  hn::Store(number, integers, numbers);
  const hn::CappedTag<float, 4> four;
  for (size_t s = 0; s < count; ++s) {
    float* to = job.cells + SampleJob::sums * static_cast<size_t>(numbers[s]);
    for (size_t half = 0; half < 2; ++half)
      for (size_t k = 0; k < 4; k += hn::Lanes(four)) {
        float* sum = to + 4 * half + k;
        hn::Store(hn::Add(hn::Load(four, sum), hn::Load(four, added[half] + 4 * s + k)), four, sum);
      }
  }
  return hn::CountTrue(d, hn::And(there, hn::Lt(trust, hn::Set(d, job.doubt))));
}

size_t add_samples(const SampleJob& job) {
  const auto lanes = static_cast<size_t>(lane_count());
  size_t doubted = 0, s = 0;
  for (; s + lanes <= job.count; s += lanes)
    doubted += add_batch(job, job.local + s, job.direction + s, job.sample_weight ? job.sample_weight + s : nullptr,
                         job.active ? job.active + s : nullptr, lanes);
  if (const size_t rest = job.count - s; rest > 0) {
    Vec3f local[brick_side], direction[brick_side];
    float weight[brick_side] = {};
    uint8_t active[brick_side] = {};
    std::copy_n(job.local + s, rest, local);
    std::copy_n(job.direction + s, rest, direction);
    if (job.sample_weight) std::copy_n(job.sample_weight + s, rest, weight);
    if (job.active) std::copy_n(job.active + s, rest, active);
    doubted +=
        add_batch(job, local, direction, job.sample_weight ? weight : nullptr, job.active ? active : nullptr, rest);
  }
  return doubted;
}

}  // namespace
}  // namespace soapfilm::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
