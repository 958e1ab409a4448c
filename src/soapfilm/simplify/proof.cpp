#include "soapfilm/simplify/proof.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "soapfilm/core/gather.h"
#include "soapfilm/core/parallel.h"
#include "soapfilm/simplify/cover.h"
#include "soapfilm/simplify/thin_places.h"

namespace soapfilm {

namespace {

constexpr size_t proofs_per_task = 512;

/// Some triangles of the mesh as it is now.
struct InList {
  const CollapsedMesh& now;
  std::vector<uint32_t> triangles;
  Vec3d corner(uint32_t t, size_t k) const { return now.corner(t, k); }
  template <class Visit>
  bool any(Vec3d, double, Visit&& visit) const {
    return std::any_of(triangles.begin(), triangles.end(), visit);
  }
};

}  // namespace

struct Proof::Failures {
  std::vector<uint32_t> stamps;  ///< the numbers of collapses to be taken back
  double most = 0;               ///< distance that was accepted
};

Proof::Proof(CollapsedMesh& now, const FaceGrid& grid, double distance, const SimplifyChecks& checks,
             const Context& context)
    : now_(now), grid_(grid), distance_(distance), checks_(checks), context_(context) {}

bool Proof::holds() {
  context_.check();
  mark_changed();
  std::vector<uint32_t> failed = failures();
  first_new_stamp_ = now_.next_stamp;
  ++calls_;
  if (!failed.empty()) take_back(std::move(failed));
  return touched_.empty();
}

/// Triangles of new collapses or of those that were taken back.
void Proof::mark_changed() {
  open_.assign(now_.mesh.triangles(), 0);
  near_open_.assign(now_.mesh.triangles(), 0);
  for (const uint32_t t : touched_) open_[t] = 1;
  for (uint32_t t = 0; t < open_.size(); ++t) {
    open_[t] = now_.mesh.is_alive(t) && (open_[t] || now_.stamp[t] >= first_new_stamp_);
    if (!open_[t]) continue;
    for (const uint32_t v : now_.mesh.corners(t)) now_.mesh.for_fan(v, [&](uint32_t h) { near_open_[h / 3] = 1; });
  }
  touched_.clear();
}

std::vector<uint32_t> Proof::failures() {
  std::vector<uint32_t> failed;
  const auto prove_all = [&](auto&& prove_one) {
    const auto found = join_chunks<Failures>(
        now_.mesh.triangles(), proofs_per_task, context_,
        [&](size_t begin, size_t end) {
          Failures part;
          NearOriginal near(now_, grid_);
          for (size_t i = begin; i < end; ++i) prove_one(static_cast<uint32_t>(i), near, part);
          return part;
        },
        [](Failures& all, const Failures& part) {
          all.stamps.insert(all.stamps.end(), part.stamps.begin(), part.stamps.end());
          all.most = std::max(all.most, part.most);
        });
    failed.insert(failed.end(), found.stamps.begin(), found.stamps.end());
    proved_ = std::max(proved_, found.most);
  };
  if (checks_.distance) {
    prove_all([&](uint32_t f, NearOriginal&, Failures& part) {
      const Triangle& v = now_.was.corners(f);
      if (!near_open_[now_.owner[v[0]]] && !near_open_[now_.owner[v[1]]] && !near_open_[now_.owner[v[2]]]) return;
      if (!face_is_near(f, part.most)) part.stamps.push_back(blamed(f));
    });
    prove_all([&](uint32_t t, NearOriginal& near, Failures& part) {
      if (!open_[t] || !now_.is_changed(t)) return;
      if (!near.holds({now_.corner(t, 0), now_.corner(t, 1), now_.corner(t, 2)}, distance_, part.most))
        part.stamps.push_back(now_.stamp[t]);
    });
  }
  if (checks_.intersections)
    for (const auto& [t, u] : meeting_pairs(now_, open_, context_))
      if (const uint32_t last = std::max(now_.stamp[t], now_.stamp[u]); last != 0) failed.push_back(last);
  return failed;
}

/// Mostly all three corners are near the triangle that owns one of them.
bool Proof::face_is_near(uint32_t f, double& most) const {
  if (is_as_it_was(f)) return true;
  const Triangle& v = now_.was.corners(f);
  const Vec3d a = now_.original[v[0]], b = now_.original[v[1]], c = now_.original[v[2]];
  const double limit = distance_ * distance_;
  for (const uint32_t corner : v) {
    const uint32_t t = now_.owner[corner];
    double farthest = 0;
    for (const Vec3d p : {a, b, c})
      farthest = std::max(farthest, squared_distance(p, now_.corner(t, 0), now_.corner(t, 1), now_.corner(t, 2)));
    if (!(farthest <= limit)) continue;
    most = std::max(most, std::sqrt(farthest));
    return true;
  }
  const ConvexPolygon face = ConvexPolygon::triangle(a, b, c);
  for (const bool more : {false, true}) {
    const InList list{now_, more ? triangles_around(v) : owners_of(v)};
    Cover cover(list, distance_);
    if (!cover.covers(face)) continue;
    most = std::max(most, std::sqrt(cover.most()));
    return true;
  }
  return false;
}

std::vector<uint32_t> Proof::owners_of(const Triangle& face) const {
  return {now_.owner[face[0]], now_.owner[face[1]], now_.owner[face[2]]};
}

std::vector<uint32_t> Proof::triangles_around(const Triangle& face) const {
  std::vector<uint32_t> around;
  for (const uint32_t t : owners_of(face))
    for (const uint32_t end : now_.mesh.corners(t))
      now_.mesh.for_fan(end, [&](uint32_t h) { around.push_back(h / 3); });
  std::sort(around.begin(), around.end());
  around.erase(std::unique(around.begin(), around.end()), around.end());
  return around;
}

/// The last collapse at one of its corners; if nothing there changed, or that did not help for long, the face's own.
uint32_t Proof::blamed(uint32_t face) const {
  constexpr int patient = 12;
  uint32_t last = 0;
  for (const uint32_t t : owners_of(now_.was.corners(face))) last = std::max(last, now_.stamp[t]);
  return last != 0 && calls_ < patient ? last : now_.stamp[face];
}

void Proof::take_back(std::vector<uint32_t> failed) {
  std::sort(failed.begin(), failed.end(), std::greater<>());
  for (const uint32_t number : failed)
    if (now_.is_done(number)) now_.undo(number, touched_);
  changed_vertices_.assign(now_.position.size(), 0);
  for (const uint32_t t : touched_)
    if (now_.mesh.is_alive(t))
      for (const uint32_t v : now_.mesh.corners(t)) changed_vertices_[v] = 1;
  context_.progress().detail(
      fmt::format("proof {}: {} places fail, {} triangles are changed back", calls_, failed.size(), touched_.size()));
}

}  // namespace soapfilm
