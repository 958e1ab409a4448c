#include "soapfilm/remesh/rounds.h"

#include <algorithm>
#include <cmath>

#include "soapfilm/core/parallel.h"
#include "soapfilm/core/triangle_distance.h"

namespace soapfilm {

namespace {

constexpr double longest = 4.0 / 3, shortest = 4.0 / 5;  // of the length that is wanted
constexpr size_t vertices_per_task = 512;
constexpr double poor = 0.18;  // squared sine of 25 degrees: triangles with smaller angles are mended

struct RankedEdge {
  double rank;
  uint32_t half_edge;
};

/// Half edges in order of their rank, those of equal rank by number.
void sort_edges(std::vector<RankedEdge>& edges) {
  std::sort(edges.begin(), edges.end(), [](const RankedEdge& a, const RankedEdge& b) {
    return a.rank != b.rank ? a.rank < b.rank : a.half_edge < b.half_edge;
  });
}

}  // namespace

void Rounds::begin() {
  split_long();
  collapse_gradually();
}

void Rounds::improve(int count) {
  constexpr int flips = 3;
  for (int round = 0; round < count; ++round) {
    context_.check();
    split_long();
    collapse_short(shortest);
    flip_to_valence();
    smooth();
  }
  for (int i = 0; i < flips; ++i) {
    flip_to_angles();
    smooth();
  }
  flip_to_angles();
  mend();
}

/// The longest first, so that needles get an even shape.
void Rounds::split_long() {
  constexpr int most_passes = 64;
  std::vector<RankedEdge> edges;
  for (int pass = 0; pass < most_passes; ++pass) {
    edges.clear();
    double worst = 0;
    for (uint32_t h = 0; h < 3 * now_.mesh.triangles(); ++h) {
      if (!now_.leads(h)) continue;
      const double ratio = now_.length(h) / now_.wanted(h);
      if (!(ratio > longest)) continue;
      edges.push_back({-ratio, h});
      worst = std::max(worst, ratio);
    }
    sort_edges(edges);
    bool any = false;
    for (const auto& [rank, h] : edges) {
      if (-rank < 0.6 * worst) break;
      // Another split may have made it another edge.
      const double ratio = now_.length(h) / now_.wanted(h);
      if (ratio > longest && ratio >= 0.6 * worst) any = edit_.split(h) || any;
    }
    if (!any) return;
  }
}

void Rounds::collapse_short(double below) {
  std::vector<RankedEdge> edges;
  for (uint32_t h = 0; h < 3 * now_.mesh.triangles(); ++h) {
    if (!now_.leads(h)) continue;
    const double ratio = now_.length(h) / now_.wanted(h);
    if (ratio < below) edges.push_back({ratio, h});
  }
  sort_edges(edges);
  for (const auto& [rank, h] : edges) {
    if (!now_.mesh.is_alive(h / 3) || now_.length(h) >= below * now_.wanted(h)) continue;
    const uint32_t a = now_.mesh.from(h), b = now_.mesh.to(h);
    if (!edit_.collapse(h, b, longest)) edit_.collapse(h, a, longest);
  }
}

/// From fine to coarse in steps, so that vertices stay spread evenly. Quadrics remember what was there.
void Rounds::collapse_gradually() {
  double sum = 0, count = 0, lengths = 0;
  for (uint32_t h = 0; h < 3 * now_.mesh.triangles(); ++h)
    if (now_.leads(h)) {
      lengths += now_.length(h);
      sum += now_.length(h) / now_.wanted(h);
      ++count;
    }
  const double typical = sum > 0 ? lengths / sum : 0;  // wanted
  std::vector<Quadric> quadrics(now_.position.size());
  for (uint32_t t = 0; t < now_.mesh.triangles(); ++t) {
    if (!now_.mesh.is_alive(t)) continue;
    const Vec3d n = area_normal(now_.corners(t));
    if (!(norm(n) > 0)) continue;
    for (const uint32_t v : now_.mesh.corners(t)) quadrics[v].add_plane(normalized(n), now_.corner(t, 0), norm(n));
  }
  edit_.use_quadrics(&quadrics);
  constexpr double step = 1.4;
  double below = std::min(shortest, 0.5 * sum / std::max(count, 1.0));
  for (;; below = std::min(shortest, step * below)) {
    context_.check();
    thin_.refile(2 * below * typical);
    collapse_short(below);
    flip_to_angles();
    if (below >= shortest) break;
  }
  edit_.use_quadrics(nullptr);
  thin_.refile(2 * typical);
}

/// `better(h)`: shall the edge be flipped?
template <class Better>
void Rounds::flip(Better&& better) {
  for (uint32_t h = 0; h < 3 * now_.mesh.triangles(); ++h)
    if (now_.leads(h) && now_.mesh.twin(h) != WorkingMesh::none && !now_.is_feature(h) && better(h)) edit_.flip(h);
}

namespace {

struct Diamond {
  uint32_t a, b, c, d;
  Diamond(const Connectivity& mesh, uint32_t h)
      : a(mesh.from(h)),
        b(mesh.to(h)),
        c(mesh.from(Connectivity::previous(h))),
        d(mesh.from(Connectivity::previous(mesh.twin(h)))) {}
};

/// The smaller sharpness of the two triangles at the edge, and what it would be at the other diagonal.
std::array<double, 2> sharpness_of(const WorkingMesh& now, const Diamond& v) {
  const Vec3d a = now.position[v.a], b = now.position[v.b], c = now.position[v.c], d = now.position[v.d];
  return {std::min(squared_sharpness({a, b, c}), squared_sharpness({b, a, d})),
          std::min(squared_sharpness({a, d, c}), squared_sharpness({d, b, c}))};
}

}  // namespace

void Rounds::flip_to_valence() {
  flip([&](uint32_t h) {
    const Diamond v(now_.mesh, h);
    const auto off = [&](uint32_t vertex, int change) {
      const int wanted = now_.mesh.on_border(vertex) ? 4 : 6;
      const int by = static_cast<int>(now_.valence(vertex)) + change - wanted;
      return by * by;
    };
    const int before = off(v.a, 0) + off(v.b, 0) + off(v.c, 0) + off(v.d, 0);
    const int after = off(v.a, -1) + off(v.b, -1) + off(v.c, 1) + off(v.d, 1);
    if (after >= before) return false;
    const auto [now, then] = sharpness_of(now_, v);
    return then >= std::min(now, poor);
  });
}

void Rounds::flip_to_angles() {
  constexpr double gain = 1.01;
  flip([&](uint32_t h) {
    const auto [now, then] = sharpness_of(now_, Diamond(now_.mesh, h));
    return then > gain * now;
  });
}

/// The nearest point of the original that faces the same way.
std::optional<Vec3d> Rounds::projected(Vec3d p, Vec3d normal, double size) const {
  constexpr double same_way = 0.2;
  for (double radius = 0.25 * size; radius <= 2 * size; radius *= 2) {
    double least = radius * radius;
    std::optional<Vec3d> best;
    grid_.any_near(p, radius, [&](uint32_t f) {
      const std::array<Vec3d, 3> face{grid_.corner(f, 0), grid_.corner(f, 1), grid_.corner(f, 2)};
      const Vec3d q = nearest_point(p, face[0], face[1], face[2]);
      const double d = dot(p - q, p - q);
      if (!(d < least)) return false;
      const Vec3d n = area_normal(face);
      if (dot(n, normal) > same_way * norm(n) * norm(normal)) {
        least = d;
        best = q;
      }
      return false;
    });
    if (best) return best;
  }
  return {};
}

std::optional<Vec3d> Rounds::smoothed(uint32_t vertex) const {
  Vec3d sum;
  double weights = 0;
  now_.mesh.for_fan(vertex, [&](uint32_t h) {
    const auto t = now_.corners(h / 3);
    const double area = norm(area_normal(t));
    sum += (t[0] + t[1] + t[2]) * (area / 3);
    weights += area;
  });
  const Vec3d p = now_.position[vertex], n = normalized(now_.normal(vertex));
  if (!(weights > 0) || !(dot(n, n) > 0)) return {};
  const Vec3d step = sum / weights - p;
  return projected(p + step - n * dot(n, step), n, now_.size[vertex]);
}

/// To the middle between its neighbors on the chain.
std::optional<Vec3d> Rounds::smoothed_along(uint32_t vertex) const {
  const uint32_t chain = now_.anchor[vertex].chain;
  double sum = 0;
  int count = 0;
  now_.mesh.for_fan(vertex, [&](uint32_t h) {
    const uint32_t last = Connectivity::previous(h);
    if (now_.chain_of_edge[h] == chain) {
      sum += now_.along(chain, now_.mesh.to(h));
      ++count;
    }
    if (now_.mesh.twin(last) == WorkingMesh::none && now_.chain_of_edge[last] == chain) {
      sum += now_.along(chain, now_.mesh.from(last));
      ++count;
    }
  });
  if (count != 2) return {};
  return Vec3d{sum / 2, 0, 0};
}

/// All of the way, or else a part of it.
bool Rounds::move_towards(uint32_t vertex, Vec3d place) {
  const Vec3d from = now_.position[vertex];
  for (double part = 1; part > 0.1; part *= 0.5)
    if (edit_.move(vertex, now_.written.snapped(from + (place - from) * part))) return true;
  return false;
}

void Rounds::smooth() {
  std::vector<std::optional<Vec3d>> place(now_.position.size());
  parallel_for(context_, place.size(), vertices_per_task, [&](size_t v) {
    const auto vertex = static_cast<uint32_t>(v);
    if (!now_.mesh.is_used(vertex) || now_.anchor[v].is_fixed()) return;
    place[v] = now_.anchor[v].is_free() ? smoothed(vertex) : smoothed_along(vertex);
  });
  for (const auto& [vertex, at] : now_.features.corners)
    if (now_.mesh.is_used(vertex)) move_towards(vertex, at);
  for (uint32_t v = 0; v < place.size(); ++v) {
    if (!place[v]) continue;
    if (now_.anchor[v].is_free()) {
      edit_.move(v, now_.written.snapped(*place[v]));
    } else {
      const double along = place[v]->x;
      if (move_towards(v, now_.features.chains[now_.anchor[v].chain].place(along))) now_.anchor[v].at = along;
    }
  }
}

double Rounds::sharpest_of_fan(uint32_t vertex, Vec3d place) const {
  double least = 1;
  now_.mesh.for_fan(vertex, [&](uint32_t h) {
    std::array<Vec3d, 3> t = now_.corners(h / 3);
    t[h % 3] = place;
    least = std::min(least, squared_sharpness(t));
  });
  return least;
}

/// Tries places around it.
bool Rounds::mend_vertex(uint32_t vertex) {
  if (!now_.anchor[vertex].is_free()) return false;
  constexpr int directions = 8;
  const Vec3d n = normalized(now_.normal(vertex));
  const Vec3d u = normalized(cross(n, std::abs(n.x) < 0.6 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0})), w = cross(n, u);
  bool moved = false;
  for (double step = 0.2 * now_.size[vertex]; step > 0.02 * now_.size[vertex]; step *= 0.5) {
    const Vec3d p = now_.position[vertex];
    double best = sharpest_of_fan(vertex, p);
    std::optional<Vec3d> at;
    for (int k = 0; k < directions; ++k) {
      const double angle = k * (6.283185307179586 / directions);
      const auto q = projected(p + (u * std::cos(angle) + w * std::sin(angle)) * step, n, now_.size[vertex]);
      if (!q) continue;
      if (const double sharp = sharpest_of_fan(vertex, *q); sharp > best) {
        best = sharp;
        at = q;
      }
    }
    if (at && edit_.move(vertex, now_.written.snapped(*at))) moved = true;
  }
  return moved;
}

bool Rounds::mend_triangle(uint32_t t) {
  for (uint32_t h = 3 * t; h < 3 * t + 3; ++h) {
    if (now_.mesh.twin(h) == WorkingMesh::none || now_.is_feature(h)) continue;
    const auto [now, then] = sharpness_of(now_, Diamond(now_.mesh, h));
    if (then > now && edit_.flip(h)) return true;
  }
  uint32_t short_one = 3 * t;
  for (uint32_t h = 3 * t; h < 3 * t + 3; ++h)
    if (now_.length(h) < now_.length(short_one)) short_one = h;
  if (now_.length(short_one) < shortest * now_.wanted(short_one)) {
    constexpr double longer = 1.4;
    const uint32_t a = now_.mesh.from(short_one), b = now_.mesh.to(short_one);
    if (edit_.collapse(short_one, b, longer) || edit_.collapse(short_one, a, longer)) return true;
  }
  bool moved = false;
  const Triangle corners = now_.mesh.corners(t);
  for (const uint32_t v : corners) moved = mend_vertex(v) || moved;
  return moved;
}

void Rounds::mend() {
  constexpr int most_passes = 4;
  for (int pass = 0; pass < most_passes; ++pass) {
    bool any = false;
    for (uint32_t t = 0; t < now_.mesh.triangles(); ++t)
      if (now_.mesh.is_alive(t) && squared_sharpness(now_.corners(t)) < poor) any = mend_triangle(t) || any;
    if (!any) return;
  }
}

}  // namespace soapfilm
