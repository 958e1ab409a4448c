#include "soapfilm/solve/profit.h"

#include <algorithm>
#include <array>
#include <numeric>

#include "soapfilm/core/parallel.h"

namespace soapfilm {

namespace {

/// A wave of p or u crosses a band within so many iterations; before that the gap may stand still until one arrives.
constexpr int least_before_stall = 128;
/// The gap counts as not fallen if it is above this fraction of the lowest one before the last third of the iterations.
constexpr double no_longer_falls = 0.9;

/// Iterations between two comparisons of the labels: a label that is about to change does so within so many.
constexpr int label_look_every = 32;
/// Labels that may change in so many iterations, per vertex^2 of the thresholded surface: the mean movement of the
/// surface, in vertices.
constexpr double labels_per_area = 0.01;
/// The thresholded gap counts as unchanged if it falls by at most this fraction between two comparisons.
constexpr double same_gap = 0.01;
/// The relaxed gap, a bound of what the dual can still gain, is at most this fraction of the thresholded one. Films
/// over wide gaps, of which open surfaces have many, lower it for hundreds of iterations without any change to the
/// mesh.
constexpr double little_to_gain = 0.125, little_for_films = 0.25;
constexpr double labels_matter = 10;  // times the tolerance

}  // namespace

std::string_view name_of(Stop stop) {
  constexpr std::array<std::string_view, 5> names = {"converged", "settled", "stalled", "limit", "spent"};
  return names[static_cast<size_t>(stop)];
}

bool Stall::found(int iterations, double gap, bool whole) {
  std::vector<Look>& looks = looks_[whole];
  double before = 0;  // lowest gap of the evaluations long enough ago, at least two; 0: none
  for (size_t k = 0; k + 1 < looks.size() && 3 * looks[k].iterations <= 2 * iterations; ++k) before = looks[k].lowest;
  const double lowest = looks.empty() ? gap : std::min(gap, looks.back().lowest);
  looks.push_back({iterations, lowest});
  return iterations >= least_before_stall && before > 0 && lowest > no_longer_falls * before;
}

bool Settling::due(int iterations, double gap, double tolerance) const {
  return gap <= labels_matter * tolerance && iterations >= iterations_ + label_look_every;
}

bool Settling::found(int iterations, const Energies& relaxed) {
  const Energies binary = evaluate_energy(level_, {.threshold = 0.5f, .certify = false}, context_);
  const bool first = iterations_ == 0;
  const double allowed = labels_per_area * binary.total_variation * (iterations - iterations_) / label_look_every;
  const bool same_labels = static_cast<double>(changed_labels()) <= allowed;
  const bool same = binary.gap >= (1 - same_gap) * gap_ && same_labels;
  iterations_ = iterations;
  gap_ = binary.gap;
  const double little = level_.box.open ? little_for_films : little_to_gain;
  return !first && same && relaxed.gap_band <= little * binary.gap;
}

size_t Settling::changed_labels() {
  inside_.resize(level_.grid.size());
  std::vector<size_t> changed(inside_.size());
  for_each_brick(changed, level_.grid, level_.slabs.get(), 64, context_, [&](size_t b) {
    const BrickBits now = BrickBits::above(level_.u.brick(b), 0.5f);
    for (size_t z = 0; z < now.layer.size(); ++z)
      changed[b] += static_cast<size_t>(count_bits(now.layer[z] ^ inside_[b].layer[z]));
    inside_[b] = now;
  });
  return std::accumulate(changed.begin(), changed.end(), size_t{0});
}

}  // namespace soapfilm
