#include "soapfilm/orient/estimate_normals.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "soapfilm/core/box_tree.h"
#include "soapfilm/core/parallel.h"
#include "soapfilm/orient/far_planes.h"
#include "soapfilm/orient/outer_sides.h"
#include "soapfilm/orient/sign_tree.h"
#include "soapfilm/orient/sites.h"
#include "soapfilm/orient/viewpoint.h"

namespace soapfilm {

namespace {

constexpr uint32_t nobody = ~uint32_t{0};
constexpr size_t samples_per_task = 1024;

/// All sites but one within a distance.
struct WithinRadius {
  double squared;
  uint32_t excluded;
  std::vector<uint32_t> sites;

  double limit() const { return squared; }
  void add(uint32_t site, double distance) {
    if (distance < squared && site != excluded) sites.push_back(site);
  }
};

/// The whole estimate; its members are the intermediate results, in the order in which they are made.
class Estimator {
 public:
  Estimator(const std::vector<Vec3d>& positions, std::span<const uint32_t> wanted, const std::vector<Vec3f>& hints,
            std::span<const Vec3f> given, const NormalParams& params, const Context& context)
      : sites_(positions, context),
        neighbors_(std::min(static_cast<size_t>(params.neighbors), sites_.size() - 1)),
        params_(params),
        context_(context) {
    take_hints(hints);
    choose_targets(wanted, given);
    fit();
    reach_beyond_lines();
    find_sides();
  }

  EstimatedNormals take(std::span<const uint32_t> wanted) const {
    EstimatedNormals result;
    result.components = components_;
    result.from_above = from_above_;
    result.normals.reserve(wanted.size());
    for (const uint32_t sample : wanted) {
      const uint32_t slot = targets_.slot(sites_.of_sample(sample));
      result.normals.push_back(static_cast<Vec3f>(planes_[slot].normal));
      result.propagated += propagated_[slot];
      result.seen_from_above += from_above_ != FromAbove::no && !(planes_[slot].normal == Vec3d{});
      result.far_planes += far_[slot];
    }
    result.sheets_up = sides_.sheets_up;
    result.doubtful = sides_.doubtful;
    return result;
  }

 private:
  std::span<const uint32_t> near(size_t slot) const { return {near_.data() + slot * neighbors_, neighbors_}; }
  bool has_hint(uint32_t site) const { return !hint_.empty() && !(hint_[site] == Vec3f{}); }
  bool is_given(size_t slot) const { return !given_.empty() && !(given_[slot] == Vec3d{}); }

  void take_hints(const std::vector<Vec3f>& hints) {
    if (std::all_of(hints.begin(), hints.end(), [](const Vec3f& h) { return h == Vec3f{}; })) return;
    hint_.resize(sites_.size());
    for (size_t i = 0; i < hints.size(); ++i) hint_[sites_.of_sample(i)] += hints[i];
  }

  /// Of several normals given at one place the largest counts, coordinate by coordinate.
  void choose_targets(std::span<const uint32_t> wanted, std::span<const Vec3f> given) {
    std::vector<uint8_t> chosen(sites_.size(), 0);
    for (const uint32_t sample : wanted) chosen[sites_.of_sample(sample)] = 1;
    targets_ = Targets(chosen);
    if (!targets_.are_all()) {
      some_points_.reserve(targets_.size());
      for (size_t t = 0; t < targets_.size(); ++t) some_points_.push_back(sites_[targets_.site(t)]);
    }
    if (given.empty()) return;
    given_.resize(targets_.size());
    for (const uint32_t sample : wanted) {
      Vec3d& of_site = given_[targets_.slot(sites_.of_sample(sample))];
      const Vec3d own = static_cast<Vec3d>(normalized(given[sample]));
      if (of_site == Vec3d{} || std::tie(of_site.x, of_site.y, of_site.z) < std::tie(own.x, own.y, own.z))
        of_site = own;
    }
  }

  /// Nearest neighbors and planes of the targets; those with a hint get its sign.
  void fit() {
    const BoxTree tree(sites_.points(), context_);
    near_.resize(targets_.size() * neighbors_);
    planes_.resize(targets_.size());
    parallel_chunks(context_, targets_.size(), samples_per_task, [&](size_t begin, size_t end) {
      context_.check();
      NearestPoints nearest(neighbors_, [&](uint32_t a, uint32_t b) { return sites_.before(a, b); });
      for (size_t t = begin; t < end; ++t) {
        const uint32_t site = targets_.site(t);
        nearest.restart(site);
        tree.search(sites_[site], site, nearest);
        std::copy_n(nearest.found().begin(), neighbors_, near_.begin() + static_cast<std::ptrdiff_t>(t * neighbors_));
        planes_[t] = fit_plane(sites_.points(), sites_[site],
                               params_.radius ? with_all_within(*params_.radius, tree, t) : nearest.found());
        if (is_given(t)) planes_[t].normal = given_[t];
        follow_hint(t);
      }
    });
  }

  void follow_hint(size_t t) {
    if (!hint_.empty() && dot(planes_[t].normal, Vec3d(hint_[targets_.site(t)])) < 0.0)
      planes_[t].normal = -planes_[t].normal;
  }

  /// Where neighbors lie along a line, as on a ring of a scanner, the plane comes from beyond them.
  void reach_beyond_lines() {
    far_.assign(targets_.size(), 0);
    std::vector<uint32_t> slots, sites;
    for (uint32_t t = 0; t < targets_.size(); ++t) {
      if (is_given(t) || params_.radius || planes_[t].wide >= least_wide) continue;
      slots.push_back(t);
      sites.push_back(targets_.site(t));
    }
    const std::vector<Vec3f> normals = far_planes(sites_.points(), sites, context_);
    for (size_t k = 0; k < slots.size(); ++k) {
      if (normals[k] == Vec3f{}) continue;
      planes_[slots[k]] = {static_cast<Vec3d>(normals[k]), 0.0, 1.0};
      far_[slots[k]] = 1;
      follow_hint(slots[k]);
    }
  }

  PlanePoints scene() const { return {targets_.are_all() ? sites_.points() : some_points_, planes_}; }

  /// A side for each normal without a hint: by the scene as a whole where that tells it, else part by part.
  void find_sides() {
    const bool nothing_known = given_.empty() && !params_.inward && hint_.empty();
    const bool storey = nothing_known && !params_.up_is_given && is_storey(scene(), params_.up);
    if (!params_.inward && !storey) up_ = params_.up;
    if (nothing_known && !storey && params_.is_survey) look_from_above(FromAbove::survey);
    propagate();
    if (!nothing_known || storey || params_.is_survey || !mostly_sheets() || !is_flat_layer(scene(), params_.up))
      return;
    look_from_above(FromAbove::flat_layer);
    propagate();
  }

  /// Normals that are not nearly level get the sign that looks up, and say it to their neighbors.
  void look_from_above(FromAbove reason) {
    constexpr double told = 0.3;  // cosine; below it noise decides the sign
    from_above_ = reason;
    hint_.resize(sites_.size());
    for (size_t t = 0; t < targets_.size(); ++t) {
      const double towards = dot(planes_[t].normal, params_.up);
      if (std::abs(towards) < told) continue;
      if (towards < 0) planes_[t].normal = -planes_[t].normal;
      hint_[targets_.site(t)] = static_cast<Vec3f>(planes_[t].normal);
    }
  }

  bool mostly_sheets() const {
    size_t on_sheets = 0, all = 0;
    for (size_t t = 0; t < targets_.size(); ++t) {
      if (component_[t] == nobody) continue;
      ++all;
      on_sheets += sides_.is_sheet[component_[t]];
    }
    return 2 * on_sheets > all;
  }

  /// The nearest neighbors of a target or, where more lie within the radius, all of these, in their
  /// order.
  std::vector<uint32_t> with_all_within(double radius, const BoxTree& tree, size_t t) const {
    const uint32_t site = targets_.site(t);
    WithinRadius within{radius * radius, site, {}};
    tree.search(sites_[site], site, within);
    if (within.sites.size() < neighbors_)
      within.sites.assign(near(t).begin(), near(t).end());
    else
      std::sort(within.sites.begin(), within.sites.end());
    return std::move(within.sites);
  }

  /// Signs along a minimum spanning tree, then one sign per connected component.
  void propagate() {
    propagated_.resize(targets_.size());
    for (size_t t = 0; t < targets_.size(); ++t)
      propagated_[t] = !has_hint(targets_.site(t)) && !(planes_[t].normal == Vec3d{});
    SignedSets sets = spread_signs({sites_, targets_, near_, neighbors_, planes_, propagated_}, context_);
    context_.check();
    component_.assign(targets_.size(), nobody);  // at representatives first
    components_ = 0;
    for (uint32_t t = 0; t < targets_.size(); ++t) {
      if (!propagated_[t]) continue;
      const SignedSets::Root root = sets.find(t);
      if (root.sign < 0) planes_[t].normal = -planes_[t].normal;
      if (component_[root.index] == nobody) component_[root.index] = static_cast<uint32_t>(components_++);
      component_[t] = component_[root.index];
    }
    const std::vector<double> outward = component_votes();
    for (size_t t = 0; t < targets_.size(); ++t)
      if (propagated_[t] && outward[component_[t]] < 0.0) planes_[t].normal = -planes_[t].normal;
  }

  /// Per component: positive if most of the given normals have the present sign, negative if most have the opposite
  /// one, by more than chance allows for random signs; else 0.
  std::vector<double> given_votes() const {
    std::vector<double> votes(components_, 0.0);
    if (given_.empty()) return votes;
    std::vector<double> count(components_, 0.0);
    for (size_t t = 0; t < targets_.size(); ++t) {
      if (!propagated_[t] || !is_given(t)) continue;
      votes[component_[t]] += dot(planes_[t].normal, given_[t]) < 0.0 ? -1.0 : 1.0;
      count[component_[t]] += 1.0;
    }
    constexpr double majority = 0.2;  // of 60 to 40
    constexpr double chance = 4.0;    // standard deviations
    for (size_t c = 0; c < components_; ++c)
      if (std::abs(votes[c]) < std::max(majority * count[c], chance * std::sqrt(count[c]))) votes[c] = 0.0;
    return votes;
  }

  /// Positive where a component's normals already look outward: by neighbors whose direction is known, else by the
  /// given normals, else by its shape.
  std::vector<double> component_votes() {
    std::vector<double> votes(components_, 0.0);
    for (size_t t = 0; t < targets_.size() && !hint_.empty(); ++t) {
      if (!propagated_[t]) continue;
      for (const uint32_t site : near(t))
        if (has_hint(site)) votes[component_[t]] += dot(planes_[t].normal, normalized(Vec3d(hint_[site])));
    }
    const std::vector<double> by_given = given_votes();
    for (size_t c = 0; c < components_; ++c)
      if (votes[c] == 0.0) votes[c] = by_given[c];
    std::vector<uint32_t> open = component_;
    for (uint32_t& c : open)
      if (c != nobody && votes[c] != 0.0) c = nobody;
    sides_ = find_outer_sides({scene(), open, components_}, up_);
    for (size_t c = 0; c < components_; ++c)
      if (votes[c] == 0.0) votes[c] = params_.inward ? -sides_.votes[c] : sides_.votes[c];
    return votes;
  }

  Sites sites_;
  size_t neighbors_;
  const NormalParams& params_;
  const Context& context_;
  std::vector<Vec3f> hint_;          ///< per site: sum of its samples' hints; empty: there are none
  Targets targets_;                  ///< sites whose normals are wanted
  std::vector<Vec3d> some_points_;   ///< of targets that are not all sites
  std::vector<Vec3d> given_;         ///< per target: a normal whose sign is in doubt, or zero; empty: there are none
  std::vector<uint32_t> near_;       ///< per target: the sites nearest to it, nearest first
  std::vector<Plane> planes_;        ///< per target
  std::vector<uint8_t> far_;         ///< per target: its plane comes from beyond its neighbors
  std::vector<uint8_t> propagated_;  ///< per target: its sign comes from its neighbors
  std::vector<uint32_t> component_;  ///< per target: its connected part of those, or nobody
  size_t components_ = 0;
  std::optional<Vec3d> up_;  ///< where sheets were seen from
  FromAbove from_above_ = FromAbove::no;
  OuterSides sides_;  ///< of the parts without another vote
};

}  // namespace

EstimatedNormals estimate_normals(const std::vector<Vec3d>& positions, std::span<const uint32_t> wanted,
                                  const std::vector<Vec3f>& hints, std::span<const Vec3f> given,
                                  const NormalParams& params, const Context& context) {
  if (wanted.empty()) return {};
  return Estimator(positions, wanted, hints, given, params, context).take(wanted);
}

}  // namespace soapfilm
