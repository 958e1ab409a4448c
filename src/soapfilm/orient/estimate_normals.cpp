#include "soapfilm/orient/estimate_normals.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>
#include <utility>

#include "soapfilm/core/kd_tree.h"
#include "soapfilm/core/parallel.h"
#include "soapfilm/orient/far_planes.h"
#include "soapfilm/orient/outer_sides.h"
#include "soapfilm/orient/signed_sets.h"
#include "soapfilm/orient/sites.h"
#include "soapfilm/orient/viewpoint.h"

namespace soapfilm {

namespace {

constexpr uint32_t nobody = ~uint32_t{0};
constexpr size_t samples_per_task = 1024;

/// The whole estimate; its members are the intermediate results, in the order in which they are made.
class Estimator {
 public:
  Estimator(const std::vector<Vec3d>& positions, std::span<const uint32_t> wanted, const std::vector<Vec3f>& hints,
            std::span<const Vec3f> given, const NormalParams& params, const Context& context)
      : sites_(positions), neighbors_(static_cast<size_t>(params.neighbors)), params_(params), context_(context) {
    hint_.resize(sites_.points.size());
    for (size_t i = 0; i < positions.size(); ++i) hint_[sites_.of_sample[i]] += static_cast<Vec3d>(hints[i]);
    choose_targets(wanted, given);
    fit();
    reach_beyond_lines();
    find_sides();
  }

  EstimatedNormals take(std::span<const uint32_t> wanted) const {
    EstimatedNormals result;
    result.components = components_;
    result.from_above = from_above_;
    for (const uint32_t sample : wanted) {
      const uint32_t slot = slot_[sites_.of_sample[sample]];
      result.normals.push_back(planes_[slot].normal);
      result.propagated += propagated_[slot];
      result.seen_from_above += from_above_ != FromAbove::no && !(planes_[slot].normal == Vec3d{});
      result.far_planes += far_[slot];
    }
    result.sheets_up = sides_.sheets_up;
    result.doubtful = sides_.doubtful;
    return result;
  }

 private:
  std::span<const uint32_t> near(size_t slot) const { return {&near_[slot * neighbors_], near_count_[slot]}; }
  bool has_hint(uint32_t site) const { return !(hint_[site] == Vec3d{}); }
  bool is_given(size_t slot) const { return !given_.empty() && !(given_[slot] == Vec3d{}); }

  /// In the order of the sites. Of several normals given at one place the largest counts, coordinate by coordinate.
  void choose_targets(std::span<const uint32_t> wanted, std::span<const Vec3f> given) {
    slot_.assign(sites_.points.size(), nobody);
    for (const uint32_t sample : wanted) slot_[sites_.of_sample[sample]] = 0;
    for (uint32_t site = 0; site < slot_.size(); ++site) {
      if (slot_[site] == nobody) continue;
      slot_[site] = static_cast<uint32_t>(targets_.size());
      targets_.push_back(site);
    }
    if (given.empty()) return;
    given_.resize(targets_.size());
    for (const uint32_t sample : wanted) {
      Vec3d& of_site = given_[slot_[sites_.of_sample[sample]]];
      const Vec3d own = static_cast<Vec3d>(normalized(given[sample]));
      if (of_site == Vec3d{} || std::tie(of_site.x, of_site.y, of_site.z) < std::tie(own.x, own.y, own.z))
        of_site = own;
    }
  }

  /// Nearest neighbors and planes of the targets; those with a hint get its sign.
  void fit() {
    const KdTree tree(sites_.points);
    near_.resize(targets_.size() * neighbors_);
    near_count_.resize(targets_.size());
    planes_.resize(targets_.size());
    parallel_chunks(context_, targets_.size(), samples_per_task, [&](size_t begin, size_t end) {
      context_.check();
      std::vector<uint32_t> index(neighbors_ + 1);
      std::vector<double> distance(neighbors_ + 1);
      for (size_t t = begin; t < end; ++t) {
        const Vec3d p = sites_.points[targets_[t]];
        const size_t found = tree->knnSearch(&p.x, neighbors_ + 1, index.data(), distance.data());
        uint32_t count = 0;
        for (size_t k = 0; k < found && count < neighbors_; ++k)
          if (index[k] != targets_[t]) near_[t * neighbors_ + count++] = index[k];
        near_count_[t] = count;
        planes_[t] = fit_plane(sites_.points, p, params_.radius ? with_all_within(*params_.radius, tree, t) : near(t));
        if (is_given(t)) planes_[t].normal = given_[t];
        follow_hint(t);
      }
    });
  }

  void follow_hint(size_t t) {
    if (dot(planes_[t].normal, hint_[targets_[t]]) < 0.0) planes_[t].normal = -planes_[t].normal;
  }

  /// Where neighbors lie along a line, as on a ring of a scanner, the plane comes from beyond them.
  void reach_beyond_lines() {
    far_.assign(targets_.size(), 0);
    std::vector<uint32_t> slots, sites;
    for (uint32_t t = 0; t < targets_.size(); ++t) {
      if (is_given(t) || params_.radius || planes_[t].wide >= least_wide) continue;
      slots.push_back(t);
      sites.push_back(targets_[t]);
    }
    const std::vector<Vec3f> normals = far_planes(sites_.points, sites, context_);
    for (size_t k = 0; k < slots.size(); ++k) {
      if (normals[k] == Vec3f{}) continue;
      planes_[slots[k]] = {static_cast<Vec3d>(normals[k]), 0.0, 1.0};
      far_[slots[k]] = 1;
      follow_hint(slots[k]);
    }
  }

  PlanePoints scene() const { return {target_points_, planes_}; }

  /// A side for each normal without a hint: by the scene as a whole where that tells it, else part by part.
  void find_sides() {
    target_points_.reserve(targets_.size());
    for (const uint32_t site : targets_) target_points_.push_back(sites_.points[site]);
    const bool nothing_known = given_.empty() && !params_.inward &&
                               std::all_of(hint_.begin(), hint_.end(), [](const Vec3d& h) { return h == Vec3d{}; });
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
    for (size_t t = 0; t < targets_.size(); ++t) {
      const double towards = dot(planes_[t].normal, params_.up);
      if (std::abs(towards) < told) continue;
      if (towards < 0) planes_[t].normal = -planes_[t].normal;
      hint_[targets_[t]] = planes_[t].normal;
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

  /// The nearest neighbors of a target or, where more lie within the radius, all of these, in the order of their
  /// sites.
  std::vector<uint32_t> with_all_within(double radius, const KdTree& tree, size_t t) const {
    const Vec3d p = sites_.points[targets_[t]];
    std::vector<std::pair<uint32_t, double>> found;
    tree->radiusSearch(&p.x, radius * radius, found, nanoflann::SearchParams(0, 0, false));
    std::vector<uint32_t> sites;
    if (found.size() <= near_count_[t]) {
      sites.assign(near(t).begin(), near(t).end());
      return sites;
    }
    for (const auto& [site, squared] : found)
      if (site != targets_[t]) sites.push_back(site);
    std::sort(sites.begin(), sites.end());
    return sites;
  }

  /// Or above each other, as the two sides of a thin body?
  bool lie_beside_each_other(uint32_t a, uint32_t b) const {
    constexpr double steep = 0.7;  // cosine
    const Vec3d step = target_points_[b] - target_points_[a];
    const double height = std::max(std::abs(dot(step, planes_[a].normal)), std::abs(dot(step, planes_[b].normal)));
    return height <= steep * norm(step);
  }

  struct Edge {
    uint32_t a, b;  ///< slots
  };

  /// Pairs of neighboring targets of unknown sign, those with the most nearly parallel normals first (the weight 1 -
  /// |n_a . n_b| of Hoppe et al., in 65536 steps; equal ones in the order of their sites), and those above each other
  /// last: the way from one side of a thin body to the other is around its rim.
  std::vector<Edge> sorted_edges() const {
    constexpr size_t steps = 1 << 16;
    std::vector<Edge> edges;
    std::vector<uint16_t> weight;
    for (uint32_t a = 0; a < targets_.size(); ++a) {
      if (!propagated_[a]) continue;
      for (const uint32_t site : near(a)) {
        const uint32_t b = slot_[site];
        if (b == nobody || !propagated_[b]) continue;
        const auto of_b = near(b);
        if (b < a && std::find(of_b.begin(), of_b.end(), targets_[a]) != of_b.end()) continue;  // already found from b
        const double w = lie_beside_each_other(a, b) ? 1.0 - std::abs(dot(planes_[a].normal, planes_[b].normal)) : 1.0;
        edges.push_back({a, b});
        weight.push_back(static_cast<uint16_t>(std::clamp(w, 0.0, 1.0) * (steps - 1)));
      }
    }
    std::vector<size_t> next(steps + 1, 0);  // counting sort: stable
    for (const uint16_t w : weight) ++next[w + 1];
    std::partial_sum(next.begin(), next.end(), next.begin());
    std::vector<Edge> sorted(edges.size());
    for (size_t e = 0; e < edges.size(); ++e) sorted[next[weight[e]]++] = edges[e];
    return sorted;
  }

  /// Signs along Kruskal's minimum spanning tree, then one sign per connected component.
  void propagate() {
    propagated_.resize(targets_.size());
    for (size_t t = 0; t < targets_.size(); ++t)
      propagated_[t] = !has_hint(targets_[t]) && !(planes_[t].normal == Vec3d{});
    SignedSets sets(targets_.size());
    for (const Edge& e : sorted_edges())
      sets.join(e.a, e.b, dot(planes_[e.a].normal, planes_[e.b].normal) < 0.0 ? -1 : 1);
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
    for (size_t t = 0; t < targets_.size(); ++t) {
      if (!propagated_[t]) continue;
      for (const uint32_t site : near(t))
        if (has_hint(site)) votes[component_[t]] += dot(planes_[t].normal, normalized(hint_[site]));
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
  std::vector<Vec3d> hint_;        ///< per site: sum of its samples' hints
  std::vector<uint32_t> slot_;     ///< per site: its index among the targets, or nobody
  std::vector<uint32_t> targets_;  ///< sites whose normals are wanted
  std::vector<Vec3d> given_;       ///< per target: a normal whose sign is in doubt, or zero; empty: there are none
  std::vector<uint32_t> near_;     ///< per target: the sites nearest to it, nearest first
  std::vector<uint32_t> near_count_;
  std::vector<Plane> planes_;  ///< per target
  std::vector<uint8_t> far_;   ///< per target: its plane comes from beyond its neighbors
  std::vector<Vec3d> target_points_;
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
