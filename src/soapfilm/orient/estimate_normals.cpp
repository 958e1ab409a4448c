#include "soapfilm/orient/estimate_normals.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "soapfilm/core/kd_tree.h"
#include "soapfilm/core/parallel.h"

namespace soapfilm {

namespace {

constexpr uint32_t nobody = ~uint32_t{0};
constexpr size_t samples_per_task = 1024;

/// The different positions, relative to the first one to keep precision at large offsets, in the order in which they
/// first occur.
struct Sites {
  std::vector<Vec3d> points;
  std::vector<uint32_t> of_sample;

  explicit Sites(const std::vector<Vec3d>& positions) : of_sample(positions.size()) {
    std::vector<uint32_t> order(positions.size());
    std::iota(order.begin(), order.end(), 0u);
    std::sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) {
      const Vec3d &p = positions[a], &q = positions[b];
      if (p.x != q.x) return p.x < q.x;
      if (p.y != q.y) return p.y < q.y;
      return p.z != q.z ? p.z < q.z : a < b;
    });
    // The first sample at each sample's position.
    for (size_t k = 0; k < order.size(); ++k) {
      const bool twin = k > 0 && positions[order[k]] == positions[order[k - 1]];
      of_sample[order[k]] = twin ? of_sample[order[k - 1]] : order[k];
    }
    for (size_t i = 0; i < positions.size(); ++i) {
      if (of_sample[i] < i) {
        of_sample[i] = of_sample[of_sample[i]];
        continue;
      }
      of_sample[i] = static_cast<uint32_t>(points.size());
      points.push_back(positions[i] - positions[0]);
    }
  }
};

/// Normal of the plane through `points` around `center` (sign arbitrary), and how well they fit it.
struct Plane {
  Vec3d normal;       ///< zero when the points lie on a line or in one place
  double flat = 1.0;  ///< thickness: least over middle variance, 0 for a plane
};

Plane fit_plane(const Sites& sites, Vec3d center, std::span<const uint32_t> neighbors) {
  double radius = 0.0;
  for (const uint32_t s : neighbors) radius = std::max(radius, norm(sites.points[s] - center));
  if (!(radius > 0.0)) return {};
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  Eigen::Matrix3d moments = Eigen::Matrix3d::Zero();
  for (const uint32_t s : neighbors) {
    const Vec3d q = (sites.points[s] - center) / radius;
    const Eigen::Vector3d v(q.x, q.y, q.z);
    mean += v;
    moments += v * v.transpose();
  }
  const double count = static_cast<double>(neighbors.size()) + 1.0;  // and the center itself, at the origin
  mean /= count;
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.computeDirect(moments / count - mean * mean.transpose());
  const Eigen::Vector3d variance = solver.eigenvalues();
  constexpr double line = 1e-7;  // variance across a line, relative to that along it; the solver errs by 1e-8
  if (!(variance[1] > line * variance[2])) return {};
  const Eigen::Vector3d n = solver.eigenvectors().col(0);
  const Vec3d normal = normalized(Vec3d{n.x(), n.y(), n.z()});
  return {is_finite(normal) ? normal : Vec3d{}, std::max(variance[0], 0.0) / variance[1]};
}

/// Disjoint sets whose members know their sign relative to the set's representative.
class SignedSets {
 public:
  explicit SignedSets(size_t count) : parent_(count), sign_(count, 1) { std::iota(parent_.begin(), parent_.end(), 0u); }

  struct Root {
    uint32_t index;
    int sign;
  };
  Root find(uint32_t i) {
    uint32_t root = i;
    int sign = 1;
    while (parent_[root] != root) {
      sign *= sign_[root];
      root = parent_[root];
    }
    // Path compression: every member on the way stores the root and its sign relative to it.
    for (int rest = sign; parent_[i] != root && i != root;) {
      const uint32_t next = parent_[i];
      const int own = sign_[i];
      parent_[i] = root;
      sign_[i] = static_cast<int8_t>(rest);
      rest *= own;
      i = next;
    }
    return {root, sign};
  }
  /// Joins the sets of a and b so that b's sign is `relative` times a's; no change if they are one set already.
  void join(uint32_t a, uint32_t b, int relative) {
    const Root ra = find(a), rb = find(b);
    if (ra.index == rb.index) return;
    const auto [low, high] = std::minmax(ra.index, rb.index);
    parent_[high] = low;
    sign_[high] = static_cast<int8_t>(ra.sign * rb.sign * relative);
  }

 private:
  std::vector<uint32_t> parent_;
  std::vector<int8_t> sign_;
};

/// The whole estimate; its members are the intermediate results, in the order in which they are made.
class Estimator {
 public:
  Estimator(const std::vector<Vec3d>& positions, std::span<const uint32_t> wanted, const std::vector<Vec3f>& hints,
            std::span<const Vec3f> given, const NormalParams& params, const Context& context)
      : sites_(positions), neighbors_(static_cast<size_t>(params.neighbors)), params_(params), context_(context) {
    hint_.resize(sites_.points.size());
    for (size_t i = 0; i < positions.size(); ++i) hint_[sites_.of_sample[i]] += static_cast<Vec3d>(hints[i]);
    slot_.assign(sites_.points.size(), nobody);
    for (const uint32_t sample : wanted) {
      const uint32_t site = sites_.of_sample[sample];
      if (slot_[site] != nobody) continue;
      slot_[site] = static_cast<uint32_t>(targets_.size());
      targets_.push_back(site);
      if (!given.empty()) given_.push_back(static_cast<Vec3d>(normalized(given[sample])));
    }
    fit();
    propagate();
  }

  EstimatedNormals take(std::span<const uint32_t> wanted) const {
    EstimatedNormals result;
    result.components = components_;
    for (const uint32_t sample : wanted) {
      const uint32_t slot = slot_[sites_.of_sample[sample]];
      result.normals.push_back(planes_[slot].normal);
      result.propagated += propagated_[slot];
    }
    return result;
  }

 private:
  std::span<const uint32_t> near(size_t slot) const { return {&near_[slot * neighbors_], near_count_[slot]}; }
  bool has_hint(uint32_t site) const { return !(hint_[site] == Vec3d{}); }
  bool is_given(size_t slot) const { return !given_.empty() && !(given_[slot] == Vec3d{}); }

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
        planes_[t] = fit_plane(sites_, p, params_.radius ? with_all_within(*params_.radius, tree, t) : near(t));
        if (is_given(t)) planes_[t].normal = given_[t];
        if (dot(planes_[t].normal, hint_[targets_[t]]) < 0.0) planes_[t].normal = -planes_[t].normal;
      }
    });
  }

  /// The nearest neighbors of a target or, where more lie within the radius, all of these, in the order of their
  /// samples.
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

  struct Edge {
    uint32_t a, b;  ///< slots
  };

  /// Pairs of neighboring targets of unknown sign, those with the most nearly parallel normals first (the weight 1 -
  /// |n_a . n_b| of Hoppe et al., in 65536 steps; equal ones in the order of their samples).
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
        const double w = 1.0 - std::abs(dot(planes_[a].normal, planes_[b].normal));
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
    std::vector<uint32_t> component(targets_.size(), nobody);  // at representatives
    for (uint32_t t = 0; t < targets_.size(); ++t) {
      if (!propagated_[t]) continue;
      const SignedSets::Root root = sets.find(t);
      if (root.sign < 0) planes_[t].normal = -planes_[t].normal;
      if (component[root.index] == nobody) component[root.index] = static_cast<uint32_t>(components_++);
      component[t] = component[root.index];
    }
    const std::vector<double> outward = component_votes(component);
    for (size_t t = 0; t < targets_.size(); ++t)
      if (propagated_[t] && outward[component[t]] < 0.0) planes_[t].normal = -planes_[t].normal;
  }

  /// Per component: positive if most of the given normals have the present sign, negative if most have the opposite
  /// one, by more than chance allows for random signs; else 0.
  std::vector<double> given_votes(const std::vector<uint32_t>& component) const {
    std::vector<double> votes(components_, 0.0);
    if (given_.empty()) return votes;
    std::vector<double> count(components_, 0.0);
    for (size_t t = 0; t < targets_.size(); ++t) {
      if (!propagated_[t] || !is_given(t)) continue;
      votes[component[t]] += dot(planes_[t].normal, given_[t]) < 0.0 ? -1.0 : 1.0;
      count[component[t]] += 1.0;
    }
    constexpr double majority = 0.2;  // of 60 to 40
    constexpr double chance = 4.0;    // standard deviations
    for (size_t c = 0; c < components_; ++c)
      if (std::abs(votes[c]) < std::max(majority * count[c], chance * std::sqrt(count[c]))) votes[c] = 0.0;
    return votes;
  }

  /// Positive where a component's normals already look outward.
  std::vector<double> component_votes(const std::vector<uint32_t>& component) const {
    // By neighbors whose direction is known.
    std::vector<double> votes(components_, 0.0);
    for (size_t t = 0; t < targets_.size(); ++t) {
      if (!propagated_[t]) continue;
      for (const uint32_t site : near(t))
        if (has_hint(site)) votes[component[t]] += dot(planes_[t].normal, normalized(hint_[site]));
    }
    const std::vector<double> by_given = given_votes(component);
    for (size_t c = 0; c < components_; ++c)
      if (votes[c] == 0.0) votes[c] = by_given[c];
    // Without any: the farthest sample along a direction looks in it. Twenty-six directions vote, and samples that do
    // not lie in a plane with their neighbors (outliers) only where there are almost no others (noise).
    constexpr double flat_enough = 0.05;
    constexpr double hardly = 0.1;  // share of the component
    std::vector<double> flat_count(components_, 0.0), count(components_, 0.0);
    for (size_t t = 0; t < targets_.size(); ++t) {
      if (!propagated_[t]) continue;
      count[component[t]] += 1.0;
      flat_count[component[t]] += planes_[t].flat <= flat_enough ? 1.0 : 0.0;
    }
    constexpr double never = -std::numeric_limits<double>::infinity();
    std::vector<double> extremes(components_, 0.0);
    struct Furthest {
      double reach = never;
      bool flat = false;
      double vote = 0.0;
    };
    for (int code = 0; code < 27; ++code) {
      const Vec3d towards = normalized(static_cast<Vec3d>(Vec3i{code % 3 - 1, code / 3 % 3 - 1, code / 9 - 1}));
      std::vector<Furthest> furthest(components_);
      for (size_t t = 0; t < targets_.size(); ++t) {
        if (!propagated_[t]) continue;
        const uint32_t c = component[t];
        Furthest& best = furthest[c];
        const double reach = dot(sites_.points[targets_[t]], towards);
        const bool flat = planes_[t].flat <= flat_enough || flat_count[c] < hardly * count[c];
        if (flat > best.flat || (flat == best.flat && reach > best.reach))
          best = {reach, flat, dot(planes_[t].normal, towards)};
      }
      for (size_t c = 0; c < components_; ++c) extremes[c] += furthest[c].vote;
    }
    for (size_t c = 0; c < components_; ++c)
      if (votes[c] == 0.0) votes[c] = params_.inward ? -extremes[c] : extremes[c];
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
  std::vector<Plane> planes_;        ///< per target
  std::vector<uint8_t> propagated_;  ///< per target: its sign comes from its neighbors
  size_t components_ = 0;
};

}  // namespace

EstimatedNormals estimate_normals(const std::vector<Vec3d>& positions, std::span<const uint32_t> wanted,
                                  const std::vector<Vec3f>& hints, std::span<const Vec3f> given,
                                  const NormalParams& params, const Context& context) {
  if (wanted.empty()) return {};
  return Estimator(positions, wanted, hints, given, params, context).take(wanted);
}

}  // namespace soapfilm
