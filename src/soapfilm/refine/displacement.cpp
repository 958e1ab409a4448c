#include "soapfilm/refine/displacement.h"

#include <algorithm>
#include <cmath>

namespace soapfilm {

namespace {

/// a += s b.
void add_scaled(RowArray& a, float s, const RowArray& b, const Parallel& parallel) {
  parallel.for_chunks(a.size(), rows_per_task * brick_side, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) a.data()[i] += s * b.data()[i];
  });
}

}  // namespace

Displacement::Displacement(const NarrowBand& band, const RowArray& phi0, const Parallel& parallel)
    : band_(band),
      parallel_(parallel),
      multilevel_(band, parallel),
      phi0_(phi0),
      phi_(band.make_array()),
      residual_(band.make_array()),
      direction_(band.make_array()),
      image_(band.make_array()),
      scratch_(band.make_array()) {
  std::copy_n(phi0.data(), phi0.size(), phi_.data());
}

/// Minus half of the energy's gradient.
void Displacement::residual(const CellSamples& data, Smoothness smoothness) {
  // direction_ = delta, scratch_ = beta delta + gamma (G delta - k)
  for (size_t i = 0; i < phi_.size(); ++i) direction_.data()[i] = phi_.data()[i] - phi0_.data()[i];
  apply_laplacian(band_, direction_, smoothness.slope, smoothness.curvature, scratch_, parallel_);
  apply_laplacian(band_, phi0_, 0, smoothness.curvature, image_, parallel_);
  for (size_t r = 1; r <= band_.rows(); ++r) {
    const uint8_t* degree = band_.degree(static_cast<uint32_t>(r));
    for (size_t x = 0; x < brick_side; ++x)
      if (degree[x] == 6) scratch_.data()[r * brick_side + x] += image_.data()[r * brick_side + x];
  }
  apply_laplacian(band_, scratch_, 0, 1, residual_, parallel_);
  add_data_term(band_, data, phi_, true, residual_, parallel_);
  for (size_t i = 0; i < residual_.size(); ++i) residual_.data()[i] = -residual_.data()[i];
}

int Displacement::minimize(const CellSamples& data, Smoothness smoothness, const SolveLimits& limits) {
  std::fill_n(scratch_.data(), scratch_.size(), 0.0f);
  add_data_diagonal(band_, data, scratch_, parallel_);
  multilevel_.set_operator(scratch_, smoothness.slope, smoothness.curvature, parallel_);
  residual(data, smoothness);

  RowArray& z = scratch_;
  double first = 0, rz = 0;
  int iteration = 0;
  for (; iteration < limits.iterations; ++iteration) {
    multilevel_.apply(residual_, z, parallel_);
    const double new_rz = dot(residual_, z, parallel_);
    if (iteration == 0) first = new_rz;
    if (!(new_rz > limits.tolerance * limits.tolerance * first)) break;
    const float ratio = iteration == 0 ? 0.0f : static_cast<float>(new_rz / rz);
    rz = new_rz;
    parallel_.for_chunks(z.size(), rows_per_task * brick_side, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i)
        direction_.data()[i] = iteration == 0 ? z.data()[i] : z.data()[i] + ratio * direction_.data()[i];
    });
    // image = A direction
    apply_laplacian(band_, direction_, smoothness.slope, smoothness.curvature, scratch_, parallel_);
    apply_laplacian(band_, scratch_, 0, 1, image_, parallel_);
    add_data_term(band_, data, direction_, false, image_, parallel_);
    const double curvature = dot(direction_, image_, parallel_);
    if (!(curvature > 0)) break;
    const auto step = static_cast<float>(rz / curvature);
    add_scaled(phi_, step, direction_, parallel_);
    add_scaled(residual_, -step, image_, parallel_);
  }
  return iteration;
}

}  // namespace soapfilm
