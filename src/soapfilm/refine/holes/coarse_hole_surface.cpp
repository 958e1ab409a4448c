#include "soapfilm/refine/holes/coarse_hole_surface.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "soapfilm/core/context_state.h"

namespace soapfilm {

namespace {

constexpr int most_rounds = 12;
constexpr double most_held = 0.03;     // refused by the topology over changed, where changes become more than at first
constexpr size_t rest_of_first = 300;  // ends when fewer labels change than in the first round divided by this
constexpr double reach = 2;            // of the band on the half-resolution grid
constexpr double least_of_holes = 0.02, most_of_holes = 1;
constexpr double noise_to_follow = 0.1;  // voxels; with less, the smallest smoothing
constexpr double slope_of_curvature = 0.002;

void set_with_neighbors(BrickMask& bricks, Vec3i vertex) {
  for (int slot = 0; slot < 27; ++slot)
    if (const Vec3i b = brick_of(vertex) + slot_offset(slot); bricks.contains(b)) bricks.set(b);
}

}  // namespace

CoarseHoleSurface::CoarseHoleSurface(const Labels& fine, const HoleFinder& finder, const FitWeights& fit_weights,
                                     const Context& context)
    : fine_(fine), finder_(finder), context_(context) {
  // In units of the half-resolution grid, where the surface has a quarter of the vertices.
  fit_weights_.noise = fit_weights.noise / 2;
  fit_weights_.smoothing = fit_weights.noise > noise_to_follow
                               ? std::clamp(fit_weights.smoothing / 4, least_of_holes, most_of_holes)
                               : least_of_holes;
  robust_.slope_of_curvature = slope_of_curvature;
  robust_.solve = {60, 0.01};
}

float CoarseHoleSurface::distance(Vec3i v) const {
  const float far = static_cast<float>(reach) + 1;
  const bool inside = labels_.grid.find(brick_of(v)) >= 0 ? labels_.test(v) : fine_.test(2 * v);
  return value_at(start_.band, phi_, v, inside ? far : -far);
}

/// The labels on the bricks that are needed now; parts already curved are kept.
void CoarseHoleSurface::make_labels() {
  const BrickMask wanted = with_neighbors(bricks_);
  Labels next = every_second_vertex(fine_, context_, &wanted);
  for (size_t b = 0; b < labels_.grid.size(); ++b)
    if (const int32_t n = next.grid.find(labels_.grid.coord(b)); n >= 0)
      next.bits[static_cast<size_t>(n)] = labels_.bits[b];
  labels_ = std::move(next);
}

/// Fits, and updates the labels.
FlipCount CoarseHoleSurface::step() {
  make_labels();
  start_ = start_from(labels_, reach, context_, &bricks_);
  SignBits signs = signs_of(labels_, start_, context_);
  {
    const GridSamples samples = on_every_second_vertex(finder_.samples(), context_, &bricks_);
    Displacement displacement(start_.band, start_.phi0, context_);
    CellSamples cells(samples, start_.band, context_);
    fit_robustly(displacement, samples, cells, {}, fit_weights_, robust_, silenced(context_));
    phi_ = std::move(displacement.phi());
  }
  // Where there are samples near the surface, the labels of the solve are kept.
  for_each_vertex(start_.band, [&](Vec3i v, size_t k) {
    const bool inside = signs.test(v);
    float& value = phi_.data()[k];
    if ((value > 0) != inside && finder_.is_sampled(v)) value = inside ? held_distance : -held_distance;
  });
  const SignBits before = signs;
  const FlipCount flips = follow(phi_, start_.band, signs, held_distance, 0);
  moving_.resize(start_.grid.size());
  for (size_t b = 0; b < moving_.size(); ++b) moving_[b] = (signs.bits(b) ^ before.bits(b)).count();
  for (size_t b = 0; b < start_.grid.size(); ++b)
    if (const int32_t n = labels_.grid.find(start_.grid.coord(b)); n >= 0)
      labels_.bits[static_cast<size_t>(n)] = signs.bits(b);
  for_each_vertex(start_.band, [&](Vec3i v, size_t k) {
    if (std::abs(phi_.data()[k]) < 1 && !finder_.is_sampled(v) && signs.test(v) != fine_.test(2 * v))
      set_with_neighbors(bricks_, v);
  });
  return flips;
}

bool CoarseHoleSurface::bend(const std::vector<HoleSurface>& holes, HoleReport& report) {
  bricks_ = BrickMask(Vec3i{fine_.box.bricks.x + 1, fine_.box.bricks.y + 1, fine_.box.bricks.z + 1} / 2);
  for (const HoleSurface& surface : holes)
    for (const Vec3i v : surface) set_with_neighbors(bricks_, v);
  size_t first = 0;
  for (report.rounds = 1; report.rounds <= most_rounds; ++report.rounds) {
    const FlipCount flips = step();
    context_.progress().advance(static_cast<double>(report.rounds) / most_rounds,
                                fmt::format("curvature over holes, round {}", report.rounds));
    const size_t turned = flips.wanted - flips.refused;
    if (report.rounds == 1) first = turned;
    if (turned > first && static_cast<double>(flips.refused) > most_held * static_cast<double>(turned)) return false;
    // The last vertices change back and forth.
    if (turned <= first / rest_of_first) return true;
  }
  report.rounds = most_rounds;
  return true;
}

}  // namespace soapfilm
