#include "soapfilm/refine/fit/cpu_band_solver.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "soapfilm/core/context_state.h"
#include "soapfilm/core/median.h"
#include "soapfilm/device/device.h"
#include "soapfilm/refine/fit/layers.h"

namespace soapfilm {

namespace {

/// body(i) for every value of some rows.
template <class Body>
void for_values(RowRange rows, Body&& body) {
  for (size_t i = rows.begin * brick_side; i < rows.end * brick_side; ++i) body(i);
}

/// to += factor from
void add(RowRange rows, float factor, const RowArray& from, RowArray& to) {
  for_values(rows, [&, onto = to.data(), values = from.data()](size_t i) { onto[i] += factor * values[i]; });
}

}  // namespace

CpuBandSolver::CpuBandSolver(const NarrowBand& band, const RowArray& phi0, const Context& context)
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
  for_values(rows_at_hand(band), [&](size_t i) { phi_.data()[i] = phi0.data()[i]; });
}

void CpuBandSolver::reset_curvature_weights() {
  for_values(rows_at_hand(band_), [&](size_t i) { share_.data()[i] = 1; });
  drop_target();
}

void CpuBandSolver::drop_target() {
  for_values(rows_at_hand(band_), [&](size_t i) { target_.data()[i] = 0; });
}

void CpuBandSolver::reweight_curvature(double medians) {
  constexpr float near = 0.5f,
                  reach = 1;      // voxels from the surface: full weight up to `near`, half of it at `reach` farther
  constexpr float follow = 0.6f;  // the target as a fraction of the local mean
  constexpr float faint = 1e-6f;  // not 0, so that the weight is positive at the band boundary too
  bring_borders(band_, phi_);
  bring_borders(band_, target_);
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
  const std::vector<uint32_t> some = some_rows(band_);
  const auto means = values_in(band_, mean, some);
  for (size_t k = 0; k < some.size(); ++k)
    for (size_t x = 0; x < brick_side; ++x)
      if (const size_t i = size_t{some[k]} * brick_side + x; rows.degree[i] == 6 && std::abs(phi0_.data()[i]) < reach)
        squares.push_back(means[k][x]);
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

void CpuBandSolver::laplacian(const LaplacianJob& job, int layer) const {
  const auto [begin, end] = rows_of_layer(band_, layer);
  band_.kernel().laplacian(band_.view(), job, begin, end);
}

void CpuBandSolver::start(const CellSamples& data, Smoothness smoothness) {
  bring_borders(band_, phi_);
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
      band_.layers_at_hand(), context_,
      [&](int layer) {
        const RowRange rows = rows_of_layer(band_, layer);
        kernel.bend(band_.view(), job, rows.begin, rows.end);
        for_values(rows, add_target);
      },
      [&](int layer) { laplacian(outer, layer); }, EvenOddStage{[&](int layer) { pull.add(layer); }});
}

void CpuBandSolver::precondition(const CellSamples& data, Smoothness smoothness) {
  for_values(rows_at_hand(band_), [&](size_t i) { scratch_.data()[i] = 0; });
  DataTerm::row_sums(band_, data, scratch_).add(context_);
  bring_borders(band_, scratch_);
  multilevel_.set_operator(scratch_, smoothness.slope, smoothness.curvature, context_);
}

double CpuBandSolver::search_direction(const CellSamples& data, Smoothness smoothness, float ratio, bool last) {
  if (ratio == 0) std::swap(direction_, scratch_);
  float* direction = direction_.data();
  const float* preconditioned = scratch_.data();
  LayerSums smooth(band_);  // of the energy
  const LaplacianJob inner{direction, smoothness.slope, smoothness.curvature, scratch_.data(), share_.data()};
  const LaplacianJob outer{scratch_.data(), 0, 1, image_.data()};
  const DataTerm pull = DataTerm::hessian(band_, data, direction_, last ? nullptr : &image_);
  std::vector<double> pulled = pull.make_energies();
  layer_by_layer(
      band_.layers_at_hand(), context_,
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

double CpuBandSolver::preconditioned() {
  const auto take_step = [&](int layer) {
    if (step_ == 0) return;
    add(rows_of_layer(band_, layer), step_, direction_, phi_);
    add(rows_of_layer(band_, layer), -step_, image_, residual_);
  };
  if (!band_.slabs()) {
    const double product = multilevel_.apply(take_step, residual_, scratch_, image_, context_);
    step_ = 0;
    return product;
  }
  layer_by_layer(band_.layers_at_hand(), context_, take_step);
  step_ = 0;
  bring_borders(band_, residual_);
  return multilevel_.apply([](int) {}, residual_, scratch_, image_, context_);
}

void CpuBandSolver::step(float length, bool last) {
  step_ = last ? 0 : length;
  if (last)
    for_rows(rows_at_hand(band_), context_, [&](size_t begin, size_t end) {
      add({begin, end}, length, direction_, phi_);
    });
}

std::shared_ptr<BandSolver> band_solver(const NarrowBand& band, const RowArray& phi0, const Context& context) {
  const Device* device = device_of(context);
  if (std::shared_ptr<BandSolver> solver = device ? device->on(band, phi0, context) : nullptr) return solver;
  return std::make_shared<CpuBandSolver>(band, phi0, context);
}

}  // namespace soapfilm
