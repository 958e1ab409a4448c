#include "soapfilm/refine/choose/held_out.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "soapfilm/core/context_state.h"
#include "soapfilm/core/median.h"
#include "soapfilm/core/portable_math.h"
#include "soapfilm/core/random.h"

namespace soapfilm {

namespace {

constexpr double assumed_noise = 0.3;             // voxels, for the robust penalty while the noise is unknown
constexpr double deviation_of_absolute = 0.6028;  // of |x|, x normal with deviation 1: sqrt(1 - 2 / pi)

/// The bricks that contain samples, whole patches in a random order, until there are enough samples. The patches are
/// the same however the axes of the lattice are permuted: fit weights near the best differ little in score, and other
/// patches would choose others.
BrickMask choose_patches(const GridSamples& samples, const HeldOutParams& params) {
  const BrickGrid& bricks = samples.bricks;
  std::map<std::pair<uint64_t, uint64_t>, std::vector<size_t>> patches;  // by random key, then by place
  for (size_t b = 0; b < bricks.size(); ++b) {
    const Vec3i c = permuted(bricks.coord(b), 3 - samples.axis_shift);  // along the world's axes
    const uint64_t place = (static_cast<uint64_t>(c.z / params.patch_bricks) << 42) +
                           (static_cast<uint64_t>(c.y / params.patch_bricks) << 21) +
                           static_cast<uint64_t>(c.x / params.patch_bricks);
    patches[{Random(params.seed ^ place * 0x9E3779B97F4A7C15ull).next(), place}].push_back(b);
  }
  BrickMask mask(bricks.bricks());
  size_t count = 0;
  for (const auto& [key, members] : patches) {
    if (count >= params.samples) break;
    for (const size_t b : members) {
      mask.set(bricks.coord(b));
      count += samples.begin[b + 1] - samples.begin[b];
    }
  }
  return mask;
}

/// The part of a band in some bricks, renumbered, in slabs where it is thick, and an array on it.
std::pair<NarrowBand, RowArray> part_of(const NarrowBand& band, const RowArray& values, const BrickMask& bricks,
                                        const Context& context) {
  BrickMask mask(band.grid().bricks());
  for (size_t b = 0; b < band.grid().size(); ++b)
    if (const Vec3i c = band.grid().coord(b); bricks.contains(c) && bricks.test(c)) mask.set(c);
  BrickGrid grid(mask, context);
  std::vector<uint8_t> vertices(grid.size() * brick_area);
  std::vector<uint32_t> rows{0};
  for (size_t b = 0; b < grid.size(); ++b) {
    const auto from = static_cast<size_t>(band.grid().find(grid.coord(b)));
    for (uint32_t r = band.first_row(from); r < band.first_row(from + 1); ++r) {
      vertices[b * brick_area + static_cast<size_t>(band.place(r))] = band.mask(r);
      rows.push_back(r);
    }
  }
  NarrowBand part(std::move(grid), vertices, context);
  part.share_out(Slabs::of(part.grid(), context));
  RowArray array = part.make_array();
  for (size_t r = 1; r < rows.size(); ++r)
    std::copy_n(values.data() + static_cast<size_t>(rows[r]) * brick_side, brick_side, array.data() + r * brick_side);
  return {std::move(part), std::move(array)};
}

double mean_of(const std::vector<float>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

}  // namespace

HeldOut::HeldOut(const Start& start, const GridSamples& samples, const RobustParams& robust,
                 const HeldOutParams& params, const Context& context)
    : robust_(robust),
      context_(context),
      patches_(choose_patches(samples, params)),
      samples_(samples.in(BrickGrid(patches_, context), context)),
      part_(part_of(start.band, start.phi0, patches_, context)),
      cells_(samples_, part_.first, context),
      displacement_(part_.first, part_.second, context),
      train_(samples_.size()),
      first_(jets_at_samples(part_.second, samples_, cells_, part_.first, context)) {
  for (size_t s = 0; s < samples_.size(); ++s) train_[s] = (samples_.sample_hash[s] & 3) != 0;  // three quarters
  robust_.rounds = 2;
  robust_.reweighting_steps = {3, 3, 8};
  robust_.slope_along_directions = robust_.slope;  // a steeper phi overstates the distances
  robust_.solve.tolerance *= 0.5;                  // the scores to compare differ by little
}

const HeldOut::Outcome& HeldOut::outcome(double smoothing, double normals) {
  const auto [it, fresh] = outcomes_.try_emplace({smoothing, normals});
  if (!fresh) return it->second;
  it->second = judge(smoothing, normals);
  // Searches try 6 to 14.
  constexpr double about = 12;
  context_.progress().advance(
      std::min(1.0, static_cast<double>(outcomes_.size()) / about),
      fmt::format("smoothing {:.2g}, held-out error {:.2g} voxel", smoothing, it->second.score));
  return it->second;
}

void HeldOut::reset_curvature_weights() {
  yield_ = false;
  displacement_.reset_curvature_weights();
  outcomes_.clear();
}

const RowArray& HeldOut::fit(const FitWeights& fit_weights) {
  std::copy_n(part_.second.data(), part_.second.size(), displacement_.phi().data());
  // Its rounds report no progress: a search makes several such fits.
  fit_robustly(displacement_, samples_, cells_, train_, fit_weights, robust_, silenced(context_));
  bring_all(part_.first, displacement_.phi());
  return displacement_.phi();
}

std::optional<double> HeldOut::mean_distance(const RowArray& phi) const {
  const std::vector<float> found = residuals(phi);
  if (found.empty()) return std::nullopt;
  return mean_of(found);
}

HeldOut::Outcome HeldOut::judge(double smoothing, double normals) {
  const auto found = residuals(fit({smoothing, normals, assumed_noise, yield_}));
  if (found.empty()) return {};
  const auto count = static_cast<double>(found.size());
  const double noise = 1.4826 * static_cast<double>(median(found));
  return {mean_of(found), noise, deviation_of_absolute * noise / std::sqrt(count), agreement()};
}

/// Distance of the held-out samples from the surface, along the normals that it had at first: a surface that folds
/// towards every sample is not near them in that direction.
std::vector<float> HeldOut::residuals(const RowArray& phi) const {
  constexpr float least_slope = 0.02f, most_distance = 3;
  const auto jets = jets_at_samples(phi, samples_, cells_, part_.first, context_);
  std::vector<float> residuals;
  for (size_t s = 0; s < jets.size(); ++s) {
    if (!jets[s] || train_[s] || !seen_from_outside(samples_.direction[s], first_[s]->gradient)) continue;
    const float slope = dot(jets[s]->gradient, normalized(first_[s]->gradient));
    residuals.push_back(std::min(std::abs(jets[s]->value) / std::clamp(slope, least_slope, 1.0f), most_distance));
  }
  return residuals;
}

/// Median angle between directions and the present surface's normals, degrees.
double HeldOut::agreement() const {
  const auto jets = jets_at_samples(displacement_.phi(), samples_, cells_, part_.first, context_);
  std::vector<float> angles;
  for (size_t s = 0; s < jets.size(); ++s)
    if (jets[s])
      angles.push_back(static_cast<float>(portable_acos(
          std::clamp(-dot(normalized(samples_.direction[s]), normalized(jets[s]->gradient)), -1.0f, 1.0f))));
  return 180 / std::numbers::pi * static_cast<double>(median(std::move(angles)));
}

}  // namespace soapfilm
