#include "soapfilm/remesh/edit.h"

#include <algorithm>
#include <cmath>

#include "soapfilm/core/triangle_distance.h"

namespace soapfilm {

namespace {

constexpr double least_cosine = 0.5;       // between a triangle's normals before and after
constexpr double sliver = 0.0076;          // squared sine of 5 degrees: its normal says nothing
constexpr double least_sharpness = 0.03;   // of 10 degrees: no angle gets smaller that was not
constexpr double tiny = 0.2;               // of the length that is wanted: such an edge goes also at the price of
constexpr double tiny_sharpness = 0.003;   // sharper angles for a while
constexpr double folded_cosine = 0.99996;  // of 0.5 degrees, between one side's normal and the other's reversed
constexpr double crease_cosine = 0.8;      // flatter edges may be flipped

/// The distance of the lines of two edges.
double apart(Vec3d a, Vec3d b, Vec3d c, Vec3d d) {
  const Vec3d across = cross(b - a, d - c);
  const double length = norm(across);
  return length > 0 ? std::abs(dot(across, c - a)) / length : 0;
}

}  // namespace

void Edit::begin() {
  old_.clear();
  was_.clear();
  fresh_.clear();
  changed_.clear();
}

void Edit::replace(uint32_t triangle, const std::array<Vec3d, 3>& by) {
  old_.push_back(triangle);
  changed_.push_back(triangle);
  was_.push_back(now_.corners(triangle));
  fresh_.push_back(by);
}

/// `around`: the normal to go by where a triangle was a sliver. `sharpest`: of squared sines, where none was sharper.
bool Edit::keeps_facing(Vec3d around, double sharpest) const {
  for (const uint32_t t : old_) sharpest = std::min(sharpest, squared_sharpness(now_.corners(t)));
  for (size_t i = 0; i < fresh_.size(); ++i) {
    const double becomes = squared_sharpness(fresh_[i]);
    if (!(becomes >= sharpest) || !(becomes > 0)) return false;
    const Vec3d before = squared_sharpness(was_[i]) < sliver ? around : area_normal(was_[i]),
                after = area_normal(fresh_[i]);
    const double along = dot(before, after), squares = dot(before, before) * dot(after, after);
    if (!(along > 0) || along * along < least_cosine * least_cosine * squares) return false;
  }
  return true;
}

/// Whether triangles would lie on neighbors that look the other way, which they did not before: such pairs do not
/// intersect, but mesh generators take them for overlapping.
bool Edit::folds() const { return are_folded(fresh_) && !are_folded(was_); }

/// Of triangles in the place of `old_`.
bool Edit::are_folded(const std::vector<std::array<Vec3d, 3>>& triangles) const {
  const auto opposite = [](Vec3d m, Vec3d n) {
    const double along = dot(m, n);
    return along < 0 && along * along > folded_cosine * folded_cosine * dot(m, m) * dot(n, n);
  };
  const auto has = [](const std::array<Vec3d, 3>& t, Vec3d p) { return t[0] == p || t[1] == p || t[2] == p; };
  for (size_t i = 0; i < triangles.size(); ++i)
    for (size_t j = i + 1; j < triangles.size(); ++j)
      if (has(triangles[i], triangles[j][0]) + has(triangles[i], triangles[j][1]) +
                  has(triangles[i], triangles[j][2]) ==
              2 &&
          opposite(area_normal(triangles[i]), area_normal(triangles[j])))
        return true;
  for (const uint32_t t : old_)
    for (uint32_t h = 3 * t; h < 3 * t + 3; ++h) {
      const uint32_t g = now_.mesh.twin(h);
      if (g == none || std::find(old_.begin(), old_.end(), g / 3) != old_.end()) continue;
      const Vec3d beyond = area_normal(now_.corners(g / 3));
      for (const auto& triangle : triangles)
        if (has(triangle, now_.from(h)) && has(triangle, now_.to(h)) && opposite(area_normal(triangle), beyond))
          return true;
    }
  return false;
}

bool Edit::meets_others() {
  Box3d box;
  for (const uint32_t t : old_)
    for (const Vec3d& p : now_.corners(t)) box.extend(p);
  for (const auto& t : fresh_)
    for (const Vec3d& p : t) box.extend(p);
  at_thin_ = thin_.near(box);
  if (!at_thin_) return false;
  std::vector<ThinPlaces::NewTriangle> triangles;
  for (const auto& t : fresh_) triangles.push_back({t});
  return thin_.meets(triangles, old_);
}

void Edit::take_out() {
  if (at_thin_)
    for (const uint32_t t : old_) thin_.remove(t);
}

void Edit::put_back() {
  if (at_thin_)
    for (const uint32_t t : changed_) thin_.insert(t);
}

bool Edit::split(uint32_t h) {
  const uint32_t a = now_.mesh.from(h), b = now_.mesh.to(h), g = now_.mesh.twin(h), chain = now_.chain_of_edge[h];
  Anchor anchor;
  Vec3d place = (now_.position[a] + now_.position[b]) * 0.5;
  if (chain != none) {
    anchor = {chain, 0.5 * (now_.along(chain, a) + now_.along(chain, b))};
    place = now_.features.chains[chain].place(anchor.at);
  }
  place = now_.written.snapped(place);
  begin();
  for (const uint32_t edge : {h, g}) {
    if (edge == none) continue;
    std::array<Vec3d, 3> first = now_.corners(edge / 3), second = first;
    first[Connectivity::next(edge) % 3] = place;
    second[edge % 3] = place;
    replace(edge / 3, first);
    was_.push_back(was_.back());
    fresh_.push_back(second);
  }
  // Halves of a sharp triangle are sharper: only facing counts here, and that they have an area.
  for (size_t i = 0; i < fresh_.size(); ++i)
    if (!(dot(area_normal(was_[i]), area_normal(fresh_[i])) > 0)) return false;
  if (meets_others()) return false;
  const auto flags = [&](uint32_t edge) {
    return std::array{now_.chain_of_edge[Connectivity::next(edge)], now_.chain_of_edge[Connectivity::previous(edge)]};
  };
  const auto at_h = flags(h), at_g = g == none ? at_h : flags(g);
  take_out();
  const uint32_t t = h / 3, u = g == none ? none : g / 3, v = static_cast<uint32_t>(now_.mesh.triangles());
  now_.mesh.split(h);
  now_.position.push_back(place);
  now_.anchor.push_back(anchor);
  now_.size.push_back(0.5 * (now_.size[a] + now_.size[b]));
  now_.chain_of_edge.resize(3 * now_.mesh.triangles(), none);
  const auto give = [&](uint32_t triangle, uint32_t x, uint32_t y, uint32_t z) {
    now_.chain_of_edge[3 * triangle] = x;
    now_.chain_of_edge[3 * triangle + 1] = y;
    now_.chain_of_edge[3 * triangle + 2] = z;
  };
  give(t, chain, none, at_h[1]);
  give(v, chain, at_h[0], none);
  changed_.push_back(v);
  if (u != none) {
    give(u, chain, none, at_g[1]);
    give(v + 1, chain, at_g[0], none);
    changed_.push_back(v + 1);
  }
  put_back();
  return true;
}

/// Where a scan's corner is rounded, its sharp edges meet two by two: corners with a short edge between them.
bool Edit::may_merge_corners(uint32_t h, uint32_t gone, uint32_t kept) const {
  const uint32_t chain = now_.chain_of_edge[h];
  if (!now_.anchor[kept].is_fixed() || chain == none) return false;
  for (uint32_t c = 0; c < now_.features.chains.size(); ++c) {
    const Chain& other = now_.features.chains[c];
    const uint32_t first = other.vertex.front(), last = other.vertex.back();
    if (other.border && (first == gone || last == gone)) return false;
    if (c != chain && ((first == gone && last == kept) || (first == kept && last == gone))) return false;
  }
  return true;
}

/// Along its chain a vertex may go; a corner stays, or becomes one with another.
bool Edit::may_slide(uint32_t h, uint32_t gone, uint32_t kept) const {
  const Anchor& anchor = now_.anchor[gone];
  if (anchor.is_fixed() && !may_merge_corners(h, gone, kept)) return false;
  if (!anchor.is_free() && !anchor.is_fixed() && now_.chain_of_edge[h] != anchor.chain) return false;
  // Two chains must not become one.
  for (const uint32_t edge : {h, now_.mesh.twin(h)})
    if (edge != none && now_.is_feature(Connectivity::next(edge)) && now_.is_feature(Connectivity::previous(edge)))
      return false;
  return anchor.is_free() || !now_.anchor[kept].is_free();
}

/// The link condition (Dey, Edelsbrunner, Guha and Nekhayev 1999, Topology preserving edge contraction).
bool Edit::keeps_topology(uint32_t h) const {
  const uint32_t a = now_.mesh.from(h), b = now_.mesh.to(h), g = now_.mesh.twin(h);
  if (g != none && now_.mesh.on_border(a) && now_.mesh.on_border(b)) return false;
  for (const uint32_t edge : {h, g}) {
    if (edge == none) continue;
    if (now_.mesh.twin(Connectivity::next(edge)) == none && now_.mesh.twin(Connectivity::previous(edge)) == none)
      return false;
    const uint32_t apex = now_.mesh.from(Connectivity::previous(edge));
    if (!now_.mesh.on_border(apex) && now_.valence(apex) <= 3) return false;
  }
  size_t common = 0;
  now_.for_neighbors(a, [&](uint32_t v) { now_.for_neighbors(b, [&](uint32_t w) { common += v == w; }); });
  return common == (g == none ? 1 : 2);
}

bool Edit::keeps_lengths(uint32_t kept, double longest) const {
  return std::all_of(ring_.begin(), ring_.end(), [&](uint32_t v) {
    return v == kept || norm(now_.position[v] - now_.position[kept]) <= longest * now_.wanted(v, kept);
  });
}

bool Edit::keeps_distance(uint32_t gone, uint32_t kept) const {
  const double limit = distance_ * distance_;
  if (quadrics_) {
    Quadric sum = (*quadrics_)[gone];
    sum += (*quadrics_)[kept];
    return sum.at(now_.position[kept]) <= limit * sum.weight();
  }
  return std::any_of(fresh_.begin(), fresh_.end(),
                     [&](const auto& t) { return squared_distance(now_.position[gone], t[0], t[1], t[2]) <= limit; });
}

bool Edit::collapse(uint32_t h, uint32_t kept, double longest) {
  const uint32_t g = now_.mesh.twin(h), gone = now_.mesh.from(h) == kept ? now_.mesh.to(h) : now_.mesh.from(h);
  if (!may_slide(h, gone, kept)) return false;
  ring_.clear();
  now_.for_neighbors(gone, [&](uint32_t v) { ring_.push_back(v); });
  if (!keeps_lengths(kept, longest) || !keeps_topology(h)) return false;
  begin();
  std::array<uint32_t, 2> removed{h / 3, g == none ? none : g / 3};
  Vec3d around;
  now_.mesh.for_fan(gone, [&](uint32_t edge) {
    const uint32_t t = edge / 3;
    around += area_normal(now_.corners(t));
    if (t == removed[0] || t == removed[1]) return;
    std::array<Vec3d, 3> becomes = now_.corners(t);
    becomes[edge % 3] = now_.position[kept];
    replace(t, becomes);
  });
  for (const uint32_t t : removed)
    if (t != none) old_.push_back(t);
  const double sharpest = now_.length(h) < tiny * now_.wanted(h) ? tiny_sharpness : least_sharpness;
  if (!keeps_facing(around, sharpest) || !keeps_distance(gone, kept) || !landmarks_.stay_near(gone, was_, fresh_))
    return false;
  if (folds() || meets_others()) return false;
  take_out();
  // The outer edges of a triangle that goes become one.
  for (const uint32_t edge : {h, g}) {
    if (edge == none) continue;
    const uint32_t x = Connectivity::next(edge), y = Connectivity::previous(edge);
    const uint32_t chain = now_.is_feature(x) ? now_.chain_of_edge[x] : now_.chain_of_edge[y];
    for (const uint32_t outer : {now_.mesh.twin(x), now_.mesh.twin(y)})
      if (outer != none) now_.chain_of_edge[outer] = chain;
  }
  now_.mesh.collapse(h, kept);
  if (now_.anchor[gone].is_fixed())
    for (Chain& chain : now_.features.chains) {
      if (chain.vertex.front() == gone) chain.vertex.front() = kept;
      if (chain.vertex.back() == gone) chain.vertex.back() = kept;
    }
  landmarks_.hand_over(gone, kept);
  if (quadrics_) (*quadrics_)[kept] += (*quadrics_)[gone];
  put_back();
  return true;
}

bool Edit::flip(uint32_t h) {
  const uint32_t g = now_.mesh.twin(h);
  if (g == none || now_.is_feature(h)) return false;
  const uint32_t a = now_.mesh.from(h), b = now_.mesh.to(h);
  const uint32_t c = now_.mesh.from(Connectivity::previous(h)), d = now_.mesh.from(Connectivity::previous(g));
  bool is_edge = c == d;
  now_.for_neighbors(c, [&](uint32_t v) { is_edge = is_edge || v == d; });
  if (is_edge) return false;
  const Vec3d pa = now_.position[a], pb = now_.position[b], pc = now_.position[c], pd = now_.position[d];
  begin();
  replace(h / 3, {pa, pd, pc});
  replace(g / 3, {pd, pb, pc});
  const Vec3d m = area_normal(was_[0]), n = area_normal(was_[1]), around = m + n;
  const bool has_sliver = std::min(squared_sharpness(was_[0]), squared_sharpness(was_[1])) < sliver;
  if (!has_sliver && dot(m, n) < crease_cosine * norm(m) * norm(n)) return false;
  if (apart(pa, pb, pc, pd) > 0.5 * distance_) return false;
  for (const auto& t : fresh_) {
    const Vec3d after = area_normal(t);
    if (!(dot(after, around) > least_cosine * norm(after) * norm(around))) return false;
  }
  if (folds() || meets_others()) return false;
  const uint32_t bc = now_.chain_of_edge[Connectivity::next(h)], ca = now_.chain_of_edge[Connectivity::previous(h)];
  const uint32_t ad = now_.chain_of_edge[Connectivity::next(g)], db = now_.chain_of_edge[Connectivity::previous(g)];
  take_out();
  const uint32_t t = h / 3, u = g / 3;
  now_.mesh.flip(h);
  now_.chain_of_edge[3 * t] = ad;
  now_.chain_of_edge[3 * t + 1] = none;
  now_.chain_of_edge[3 * t + 2] = ca;
  now_.chain_of_edge[3 * u] = db;
  now_.chain_of_edge[3 * u + 1] = bc;
  now_.chain_of_edge[3 * u + 2] = none;
  put_back();
  return true;
}

bool Edit::move(uint32_t vertex, Vec3d place) {
  begin();
  now_.mesh.for_fan(vertex, [&](uint32_t h) {
    std::array<Vec3d, 3> becomes = now_.corners(h / 3);
    becomes[h % 3] = place;
    replace(h / 3, becomes);
  });
  if (!keeps_facing(now_.normal(vertex), least_sharpness) || !landmarks_.stay_near(vertex, was_, fresh_)) return false;
  if (folds() || meets_others()) return false;
  take_out();
  now_.position[vertex] = place;
  put_back();
  return true;
}

}  // namespace soapfilm
