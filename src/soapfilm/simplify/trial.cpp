#include "soapfilm/simplify/trial.h"

#include <algorithm>
#include <cmath>

#include "soapfilm/core/triangle_distance.h"
#include "soapfilm/simplify/cover.h"

namespace soapfilm {

namespace {

constexpr double old_share = 0.95;      // of the distance, at the original's vertices
constexpr double new_share = 0.95;      // at samples of the new triangles
constexpr double close_share = 0.6;     // a sample beyond this: the new triangles are proved to be near
constexpr double sample_step = 2;       // units
constexpr double least_cosine = 0.2;    // cosine between a triangle's normals before and after
constexpr double least_sine2 = 0.0076;  // of the smallest angle: 5 degrees

/// Square of the sine of the smallest angle.
double sharpness(const std::array<Vec3d, 3>& t, double squared_normal) {
  const Vec3d ab = t[1] - t[0], bc = t[2] - t[1], ca = t[0] - t[2];
  const double x = dot(ab, ab), y = dot(bc, bc), z = dot(ca, ca);
  const double longer = x * y * z / std::min({x, y, z});
  return longer > 0 ? squared_normal / longer : 0;
}

struct InTriangles {
  const std::vector<std::array<Vec3d, 3>>& triangles;
  Vec3d corner(uint32_t t, size_t k) const { return triangles[t][k]; }
  template <class Visit>
  bool any(Vec3d, double, Visit&& visit) const {
    for (uint32_t t = 0; t < triangles.size(); ++t)
      if (visit(t)) return true;
    return false;
  }
};

}  // namespace

Trial::Outcome Trial::attempt(uint32_t a, uint32_t b, CollapseLog& log) {
  if (!find_edge(a, b)) return Outcome::refused;
  if (!gather_star()) return Outcome::beyond_tile;
  if (!keeps_topology()) return Outcome::refused;
  if (!choose_place()) return Outcome::refused;
  if (!tile_.holds(place_)) return Outcome::beyond_tile;
  if (!keeps_shape() || !border_is_near()) return Outcome::refused;
  is_close_call_ = false;
  if (!is_sampled(place_)) return Outcome::refused;
  if (!old_is_near()) return Outcome::refused;
  if (!new_is_near()) return Outcome::refused;
  if (run_.checks.distance && (run_.proves || is_close_call_) && !is_proved()) return Outcome::refused;
  if (run_.checks.intersections && meets_others()) return Outcome::refused;
  commit(log);
  return Outcome::done;
}

/// A border vertex is kept, at its place.
bool Trial::find_edge(uint32_t a, uint32_t b) {
  edge_ = none;
  now_.mesh.for_fan(a, [&](uint32_t h) {
    if (now_.mesh.to(h) == b) edge_ = h;
    if (now_.mesh.from(Connectivity::previous(h)) == b && now_.mesh.twin(Connectivity::previous(h)) == none)
      edge_ = Connectivity::previous(h);
  });
  if (edge_ == none) return false;
  if (now_.is_fixed(a) && now_.is_fixed(b)) return false;
  const bool keeps_b = now_.is_fixed(b) || (!now_.is_fixed(a) && !now_.mesh.on_border(a) && now_.mesh.on_border(b));
  kept_ = keeps_b ? b : a;
  gone_ = keeps_b ? a : b;
  const uint32_t twin = now_.mesh.twin(edge_);
  removed_ = {edge_ / 3, twin == none ? none : twin / 3};
  return true;
}

bool Trial::gather_fan(uint32_t vertex) {
  std::vector<uint32_t>& link = link_[vertex == kept_ ? 0 : 1];
  link.clear();
  bool inside = tile_.holds(now_.position[vertex]);
  now_.mesh.for_fan(vertex, [&](uint32_t h) {
    const uint32_t next = now_.mesh.to(h), last = now_.mesh.from(Connectivity::previous(h));
    inside = inside && tile_.holds(now_.position[next]) && tile_.holds(now_.position[last]);
    link.push_back(next);
    if (now_.mesh.twin(Connectivity::previous(h)) == none) link.push_back(last);
    if (!is_removed(h / 3)) star_.push_back(h);
  });
  return inside;
}

bool Trial::gather_star() {
  star_.clear();
  if (!gather_fan(kept_)) return false;
  star_of_kept_ = star_.size();
  return gather_fan(gone_);
}

/// The link condition (Dey, Edelsbrunner, Guha and Nekhayev 1999, Topology preserving edge contraction).
bool Trial::keeps_topology() const {
  size_t common = 0, expected = 0;
  for (const uint32_t v : link_[0]) common += std::count(link_[1].begin(), link_[1].end(), v) > 0;
  for (const uint32_t t : removed_) {
    if (t == none) continue;
    ++expected;
    const uint32_t h = edge_ / 3 == t ? edge_ : now_.mesh.twin(edge_);
    const bool ends_1 = now_.mesh.twin(Connectivity::next(h)) == none;
    const bool ends_2 = now_.mesh.twin(Connectivity::previous(h)) == none;
    if (ends_1 && ends_2) return false;
    const uint32_t apex = now_.mesh.from(Connectivity::previous(h));
    if (now_.mesh.on_border(apex)) continue;
    size_t valence = 0;
    now_.mesh.for_fan(apex, [&](uint32_t) { ++valence; });
    if (valence <= 3) return false;
  }
  if (common != expected) return false;
  const bool border_edge = now_.mesh.twin(edge_) == none;
  return border_edge || !(now_.mesh.on_border(kept_) && now_.mesh.on_border(gone_));
}

bool Trial::choose_place() {
  around_.clear();
  const auto add = [&](uint32_t t) { around_.push_back({now_.corner(t, 0), now_.corner(t, 1), now_.corner(t, 2)}); };
  for (const uint32_t h : star_) add(h / 3);
  for (const uint32_t t : removed_)
    if (t != none) add(t);
  const Vec3d kept = now_.position[kept_];
  if (now_.mesh.on_border(kept_)) {
    place_ = kept;
    return true;
  }
  Quadric sum = now_.quadric[kept_];
  sum += now_.quadric[gone_];
  place_ = now_.written.snapped(place_keeping_volume(sum, kept, now_.position[gone_], around_));
  return is_finite(place_);
}

/// No triangle turns over; none gets a smaller angle than those that are there, if that is small.
bool Trial::keeps_shape() {
  double sharpest = least_sine2;
  for (const StarCorners& t : around_) {
    const Vec3d n = cross(t.b - t.a, t.c - t.a);
    sharpest = std::min(sharpest, sharpness({t.a, t.b, t.c}, dot(n, n)));
  }
  faces_.clear();
  for (size_t i = 0; i < star_.size(); ++i) {
    const uint32_t h = star_[i], t = h / 3;
    const StarCorners& was = around_[i];
    NewFace face{t, {was.a, was.b, was.c}, {}, 0};
    face.corner[h % 3] = place_;
    face.normal = cross(face.corner[1] - face.corner[0], face.corner[2] - face.corner[0]);
    face.squared_normal = dot(face.normal, face.normal);
    const Vec3d before = cross(was.b - was.a, was.c - was.a);
    const double along = dot(face.normal, before);
    if (!(face.squared_normal > 0) || along < 0 ||
        along * along < least_cosine * least_cosine * face.squared_normal * dot(before, before))
      return false;
    if (sharpness(face.corner, face.squared_normal) < sharpest) return false;
    faces_.push_back(face);
  }
  return !faces_.empty();
}

/// The stretch of the original's border between two of its vertices is within a distance of the segment if its vertices
/// are. The reverse follows: its projection onto the segment is connected and reaches both ends.
bool Trial::border_is_near() const {
  if (now_.mesh.twin(edge_) != none) return true;
  const auto stretch_is_near = [&](uint32_t from, uint32_t to) {
    const Vec3d a = now_.original[from], b = now_.original[to];
    for (uint32_t v = from; v != to; v = now_.border[v])
      if (!(squared_distance(now_.original[v], a, b, b) <= run_.distance * run_.distance)) return false;
    return true;
  };
  const uint32_t other =
      now_.mesh.from(edge_) == gone_ ? now_.mesh.before_on_border(gone_) : now_.mesh.after_on_border(gone_);
  if (other == kept_) return false;
  return now_.mesh.from(edge_) == gone_ ? stretch_is_near(other, kept_) : stretch_is_near(kept_, other);
}

/// Each original vertex that the star owns finds a new triangle that is near.
bool Trial::old_is_near() {
  owned_.clear();
  ring_.clear();
  for (size_t i = 0; i < star_.size(); ++i)
    for (uint32_t v = now_.first_owned[star_[i] / 3]; v != none; v = now_.next_owned[v])
      if (!assign(v, i)) return false;
  for (const uint32_t t : removed_) {
    if (t == none) continue;
    for (uint32_t v = now_.first_owned[t]; v != none; v = now_.next_owned[v])
      if (!assign(v, 0)) return false;
  }
  return true;
}

bool Trial::assign(uint32_t vertex, size_t likely) {
  const Vec3d p = now_.original[vertex];
  double least = old_share * old_share * run_.distance * run_.distance;
  const double good = 0.25 * least;
  uint32_t best = none;
  std::array<Vec3d, 3> near;
  for (size_t k = 0; k < faces_.size(); ++k) {
    const NewFace& face = faces_[(likely + k) % faces_.size()];
    const double height = dot(face.normal, p - face.corner[0]);
    if (height * height > least * face.squared_normal) continue;
    const double d = squared_distance(p, face.corner[0], face.corner[1], face.corner[2]);
    if (d > least) continue;
    least = d;
    best = face.triangle;
    near = face.corner;
    if (d <= good) break;
  }
  if (best == none) return assign_beyond(vertex);
  if (least > close_share * close_share * run_.distance * run_.distance) is_close_call_ = true;
  owned_.push_back({vertex, best, near});
  return true;
}

/// To a triangle around the star.
bool Trial::assign_beyond(uint32_t vertex) {
  is_close_call_ = true;
  if (ring_.empty()) gather_ring(true);
  const double limit = old_share * old_share * run_.distance * run_.distance;
  const Vec3d p = now_.original[vertex];
  for (const uint32_t t : ring_) {
    if (squared_distance(p, now_.corner(t, 0), now_.corner(t, 1), now_.corner(t, 2)) > limit) continue;
    owned_.push_back({vertex, t, {now_.corner(t, 0), now_.corner(t, 1), now_.corner(t, 2)}});
    return true;
  }
  return false;
}

/// Lists of triangles that are not in the tile belong to their tiles.
void Trial::gather_ring(bool only_in_tile) {
  ring_.clear();
  const auto in_tile = [&](uint32_t t) {
    for (size_t k = 0; k < 3; ++k)
      if (!tile_.holds(now_.corner(t, k))) return false;
    return true;
  };
  std::vector<uint32_t> inner;
  for (const uint32_t h : star_) inner.push_back(h / 3);
  for (const uint32_t t : removed_) inner.push_back(t);
  for (const auto& link : link_)
    for (const uint32_t v : link)
      if (v != kept_ && v != gone_)
        now_.mesh.for_fan(v, [&](uint32_t h) {
          if (std::find(inner.begin(), inner.end(), h / 3) == inner.end() && (!only_in_tile || in_tile(h / 3)))
            ring_.push_back(h / 3);
        });
  std::sort(ring_.begin(), ring_.end());
  ring_.erase(std::unique(ring_.begin(), ring_.end()), ring_.end());
}

bool Trial::is_sampled(Vec3d p) {
  const double close = close_share * close_share * run_.distance * run_.distance;
  const double limit = new_share * new_share * run_.distance * run_.distance;
  bool any = false;
  const bool well_within = run_.grid.any_near(p, new_share * run_.distance, [&](uint32_t f) {
    const double d = run_.grid.squared_distance(p, f);
    any = any || d <= limit;
    return d <= close;
  });
  if (!well_within) is_close_call_ = true;
  return well_within || any;
}

/// Points of the new edges, and the middles of the triangles.
bool Trial::new_is_near() {
  for (size_t i = 0; i < star_.size(); ++i) {
    const NewFace& face = faces_[i];
    const Vec3d along = face.corner[(star_[i] + 1) % 3] - place_;
    const int steps = static_cast<int>(std::ceil(norm(along) / sample_step));
    for (int k = 0; k < steps; ++k)
      if (!is_sampled(place_ + along * ((k + 0.5) / steps))) return false;
    if (!is_sampled((face.corner[0] + face.corner[1] + face.corner[2]) / 3.0)) return false;
  }
  return true;
}

bool Trial::is_proved() {
  double most = 0;
  for (size_t i = 0; i < faces_.size() && is_close_call_; ++i)
    if (!near_.holds(faces_[i].corner, run_.distance, most)) return false;
  return !run_.proves || faces_are_near();
}

/// The original's faces at vertices that the star owns: mostly near the triangle that will own the vertex, or near
/// those of its three corners.
bool Trial::faces_are_near() {
  const double limit = run_.distance * run_.distance;
  checked_.clear();
  for (uint32_t i = 0; i < owned_.size(); ++i)
    now_.was.for_fan(owned_[i].vertex, [&](uint32_t h) {
      const std::array<Vec3d, 3>& near = owned_[i].corner;
      for (const uint32_t v : {now_.was.to(h), now_.was.from(Connectivity::previous(h))})
        if (!(squared_distance(now_.original[v], near[0], near[1], near[2]) <= limit))
          return checked_.push_back({h / 3, i});
    });
  std::sort(checked_.begin(), checked_.end());
  std::vector<std::array<Vec3d, 3>> owners, all;
  for (size_t begin = 0, end = 0; begin < checked_.size(); begin = end) {
    owners.clear();
    for (; end < checked_.size() && checked_[end][0] == checked_[begin][0]; ++end)
      owners.push_back(owned_[checked_[end][1]].corner);
    if (covers_face(checked_[begin][0], owners)) continue;
    if (all.empty()) {
      gather_ring(false);
      for (const NewFace& face : faces_) all.push_back(face.corner);
      for (const uint32_t t : ring_) all.push_back({now_.corner(t, 0), now_.corner(t, 1), now_.corner(t, 2)});
    }
    if (!covers_face(checked_[begin][0], all)) return false;
  }
  return true;
}

bool Trial::covers_face(uint32_t f, std::vector<std::array<Vec3d, 3>> triangles) const {
  const Triangle& v = now_.was.corners(f);
  const std::array<Vec3d, 3> face{now_.original[v[0]], now_.original[v[1]], now_.original[v[2]]};
  const auto is_beyond = [&](const std::array<Vec3d, 3>& t) {
    for (int k = 0; k < 3; ++k)
      if (std::min({t[0][k], t[1][k], t[2][k]}) > std::max({face[0][k], face[1][k], face[2][k]}) + run_.distance ||
          std::max({t[0][k], t[1][k], t[2][k]}) < std::min({face[0][k], face[1][k], face[2][k]}) - run_.distance)
        return true;
    return false;
  };
  std::erase_if(triangles, is_beyond);
  const InTriangles in{triangles};
  return Cover(in, run_.distance).covers(ConvexPolygon::triangle(face[0], face[1], face[2]));
}

bool Trial::meets_others() {
  Box3d box;
  for (const StarCorners& t : around_)
    for (const Vec3d& p : {t.a, t.b, t.c}) box.extend(p);
  box.extend(place_);
  at_thin_ = run_.thin.near(box);
  if (!at_thin_) return false;
  new_triangles_.clear();
  for (const NewFace& face : faces_) new_triangles_.push_back({face.corner});
  replaced_.clear();
  for (const uint32_t h : star_) replaced_.push_back(h / 3);
  for (const uint32_t t : removed_)
    if (t != none) replaced_.push_back(t);
  return run_.thin.meets(new_triangles_, replaced_);
}

void Trial::commit(CollapseLog& log) {
  const auto number = log.base + static_cast<uint32_t>(log.collapses.size());
  log.collapses.push_back({edge_, kept_, now_.position[kept_], log.before.size()});
  const auto change = [&](uint32_t t) {
    log.before.push_back({t, now_.stamp[t]});
    now_.stamp[t] = number;
    now_.first_owned[t] = none;
    if (at_thin_) run_.thin.remove(t);
  };
  for (const uint32_t h : star_) change(h / 3);
  for (const uint32_t t : removed_)
    if (t != none) change(t);
  now_.mesh.collapse(edge_, kept_);
  now_.position[kept_] = place_;
  if (at_thin_)
    for (const uint32_t h : star_) run_.thin.insert(h / 3);
  for (const Owned& o : owned_) now_.own(o.triangle, o.vertex);
  now_.quadric[kept_] += now_.quadric[gone_];
  ++now_.version[kept_];
  ++now_.version[gone_];
}

}  // namespace soapfilm
