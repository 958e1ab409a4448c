#include "soapfilm/refine/fit/displacement.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "soapfilm/core/median.h"
#include "soapfilm/refine/fit/layers.h"

namespace soapfilm {

namespace {

/// body(i) for every value of some rows.
template <class Body>
void for_values(RowRange rows, Body&& body) {
  for (size_t i = rows.begin * brick_side; i < rows.end * brick_side; ++i) body(i);
}

}  // namespace

Displacement::Displacement(const NarrowBand& band, const RowArray& phi0, const Context& context)
    : band_(band),
      context_(context),
      multilevel_(band, context),
      phi0_(phi0),
      phi_(band.make_array()),
      residual_(band.make_array()),
      direction_(band.make_array()),
      image_(band.make_array()),
      scratch_(band.make_array()),
      share_(band.make_array()),
      target_(band.make_array()) {
  reset_curvature_weights();
  std::copy_n(phi0.data(), phi0.size(), phi_.data());
}

void Displacement::reset_curvature_weights() {
  std::fill_n(share_.data(), share_.size(), 1.0f);
  drop_target();
}

void Displacement::reweight_curvature(double medians) {
  constexpr float near = 0.5f,
                  reach = 1;      // voxels from the surface: full weight up to `near`, half of it at `reach` farther
  constexpr float follow = 0.6f;  // the target as a fraction of the local mean
  constexpr float faint = 1e-6f;  // not 0, so that the weight is positive at the band boundary too
  const RowKernel& kernel = band_.kernel();
  const BandRows rows = band_.view();
  RowArray &curvature = image_, &weight = residual_, &product = direction_, &mean = scratch_;
  const CurvatureJob bends{phi_.data(), target_.data(), reach, faint, curvature.data(), weight.data(), product.data()};
  const auto find_bends = [&](int layer) {
    const auto [begin, end] = rows_of_layer(band_, layer);
    kernel.curvature(rows, bends, begin, end);
    kernel.saddles(rows, {phi_.data(), weight.data(), product.data()}, begin, end);
  };
  if (!multilevel_.local_mean(find_bends, product, weight, weight, 1, mean, context_)) return;
  std::vector<float> squares;
  for (const size_t row : some_rows(band_))
    for (size_t i = row * brick_side; i < (row + 1) * brick_side; ++i)
      if (rows.degree[i] == 6 && std::abs(phi0_.data()[i]) < reach) squares.push_back(mean.data()[i]);
  if (squares.empty()) return;
  const auto squared_medians = static_cast<float>(medians * medians);
  const float per_square = 1 / std::max(squared_medians * median(std::move(squares)), 1e-12f);
  const ShareJob job{mean.data(),   phi0_.data(),     per_square,    near,          reach,
                     share_.data(), curvature.data(), weight.data(), product.data()};
  const auto find_shares = [&](int layer) {
    const auto [begin, end] = rows_of_layer(band_, layer);
    kernel.share(rows, job, begin, end);
  };
  const RowArray& inside = curvature;  // reused: curvature now holds the vertices with six neighbors
  multilevel_.local_mean(find_shares, product, weight, inside, follow, target_, context_);
}

void Displacement::laplacian(const LaplacianJob& job, int layer) const {
  const auto [begin, end] = rows_of_layer(band_, layer);
  band_.kernel().laplacian(band_.view(), job, begin, end);
}

/// Minus half of the energy's gradient.
void Displacement::residual(const CellSamples& data, Smoothness smoothness) {
  const RowKernel& kernel = band_.kernel();
  // beta delta + gamma (G delta - k)
  const CurvatureResidualJob job{phi_.data(),          phi0_.data(),  smoothness.slope,
                                 smoothness.curvature, share_.data(), scratch_.data()};
  const LaplacianJob outer{scratch_.data(), 0, -1, residual_.data()};
  // G is minus the Laplacian.
  const auto add_target = [bent = scratch_.data(), target = target_.data(), share = share_.data(),
                           gamma = smoothness.curvature](size_t i) { bent[i] += gamma * share[i] * target[i]; };
  const DataTerm pull = DataTerm::gradient(band_, data, phi_, -1, residual_);
  layer_by_layer(
      layers_of(band_), context_,
      [&](int layer) {
        const RowRange rows = rows_of_layer(band_, layer);
        kernel.bend(band_.view(), job, rows.begin, rows.end);
        for_values(rows, add_target);
      },
      [&](int layer) { laplacian(outer, layer); }, EvenOddStage{[&](int layer) { pull.add(layer); }});
}

void Displacement::precondition(const CellSamples& data, Smoothness smoothness) {
  std::fill_n(scratch_.data(), scratch_.size(), 0.0f);
  DataTerm::row_sums(band_, data, scratch_).add(context_);
  multilevel_.set_operator(scratch_, smoothness.slope, smoothness.curvature, context_);
}

double Displacement::search_direction(const CellSamples& data, Smoothness smoothness, float ratio, bool last) {
  if (ratio == 0) std::swap(direction_, scratch_);
  float* direction = direction_.data();
  const float* preconditioned = scratch_.data();
  LayerSums smooth(band_);  // of the energy
  const LaplacianJob inner{direction, smoothness.slope, smoothness.curvature, scratch_.data(), share_.data()};
  const LaplacianJob outer{scratch_.data(), 0, 1, image_.data()};
  const DataTerm pull = DataTerm::hessian(band_, data, direction_, last ? nullptr : &image_);
  std::vector<double> pulled = pull.make_energies();
  layer_by_layer(
      layers_of(band_), context_,
      [&](int layer) {
        if (ratio == 0) return;
        for_values(rows_of_layer(band_, layer),
                   [&](size_t i) { direction[i] = preconditioned[i] + ratio * direction[i]; });
      },
      [&](int layer) {
        smooth.add(layer,
                   [&](size_t begin, size_t end) { return band_.kernel().laplacian(band_.view(), inner, begin, end); });
      },
      [&](int layer) {
        if (!last) laplacian(outer, layer);
      },
      EvenOddStage{[&](int layer) { pull.add(layer, &pulled); }});
  return smooth.total() + pull.total(pulled);
}

int Displacement::minimize(const CellSamples& data, Smoothness smoothness, const SolveLimits& limits) {
  residual(data, smoothness);

  double first = 0, rz = 0;
  float step = 0;
  const auto add = [](RowRange rows, float factor, const RowArray& from, RowArray& to) {
    for_values(rows, [&, onto = to.data(), values = from.data()](size_t i) { onto[i] += factor * values[i]; });
  };
  int iteration = 0;
  for (bool last = false; !last && iteration < limits.iterations; ++iteration) {
    // The step is applied in the first pass of the next apply(), before that overwrites image_.
    const auto take_step = [&](int layer) {
      if (iteration == 0) return;
      add(rows_of_layer(band_, layer), step, direction_, phi_);
      add(rows_of_layer(band_, layer), -step, image_, residual_);
    };
    const double new_rz = multilevel_.apply(take_step, residual_, scratch_, image_, context_);
    if (iteration == 0) first = new_rz;
    if (!(new_rz > 0)) break;
    last = new_rz <= limits.tolerance * limits.tolerance * first || iteration + 1 == limits.iterations;
    const double curvature =
        search_direction(data, smoothness, iteration == 0 ? 0.0f : static_cast<float>(new_rz / rz), last);
    rz = new_rz;
    if (!(curvature > 0)) break;
    step = static_cast<float>(rz / curvature);
    if (last)
      for_rows(all_rows(band_), context_, [&](size_t begin, size_t end) { add({begin, end}, step, direction_, phi_); });
  }
  return iteration;
}

}  // namespace soapfilm
