#include "tools/scanner/patch.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace soapfilm {

namespace {

using std::numbers::pi;

double cross2(Vec2 a, Vec2 b, Vec2 c) { return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x); }
double squared_distance(Vec2 a, Vec2 b) { return (a.x - b.x) * (a.x - b.x) + (a.y - b.y) * (a.y - b.y); }

Vec2 closest_on_segment(Vec2 a, Vec2 b, Vec2 p) {
  const double dx = b.x - a.x;
  const double dy = b.y - a.y;
  const double s = std::clamp(((p.x - a.x) * dx + (p.y - a.y) * dy) / (dx * dx + dy * dy), 0.0, 1.0);
  return {a.x + s * dx, a.y + s * dy};
}

/// Even-odd rule.
bool inside_polygon(const std::vector<Vec2>& polygon, Vec2 p) {
  bool inside = false;
  for (size_t i = 0, j = polygon.size() - 1; i < polygon.size(); j = i++) {
    const Vec2 a = polygon[i];
    const Vec2 b = polygon[j];
    if ((a.y > p.y) != (b.y > p.y) && p.x < a.x + (b.x - a.x) * (p.y - a.y) / (b.y - a.y)) inside = !inside;
  }
  return inside;
}

/// Triangles of a simple polygon by ear clipping (Meisters 1975); of all ears the one with the shortest diagonal goes
/// first, which avoids slivers.
void clip_ears(const std::vector<Vec2>& points, const std::vector<uint32_t>& index, MeshBuilder& builder) {
  std::vector<size_t> ring(points.size());
  for (size_t i = 0; i < ring.size(); ++i) ring[i] = i;
  while (ring.size() > 2) {
    const size_t n = ring.size();
    size_t ear = n;
    double shortest = std::numeric_limits<double>::infinity();
    for (size_t i = 0; i < n; ++i) {
      const Vec2 a = points[ring[(i + n - 1) % n]];
      const Vec2 b = points[ring[i]];
      const Vec2 c = points[ring[(i + 1) % n]];
      const double diagonal = squared_distance(a, c);
      if (cross2(a, b, c) <= 0.0 || diagonal >= shortest) continue;
      bool empty = true;
      for (size_t k = 0; k < n && empty; ++k) {
        if (k == i || k == (i + 1) % n || k == (i + n - 1) % n) continue;
        const Vec2 p = points[ring[k]];
        empty = !(cross2(a, b, p) >= 0.0 && cross2(b, c, p) >= 0.0 && cross2(c, a, p) >= 0.0);
      }
      if (!empty) continue;
      ear = i;
      shortest = diagonal;
    }
    if (ear == n) return;  // only collinear corners are left
    builder.triangle(index[ring[(ear + n - 1) % n]], index[ring[ear]], index[ring[(ear + 1) % n]]);
    ring.erase(ring.begin() + static_cast<std::ptrdiff_t>(ear));
  }
}

}  // namespace

std::vector<Vec3d> Ring::points(int segments) const {
  std::vector<Vec3d> points;
  for (int i = 0; i < segments; ++i) {
    const double angle = 2.0 * pi * i / segments;
    points.push_back(center + u * (radius * std::cos(angle)) + v * (radius * std::sin(angle)));
  }
  return points;
}

bool FlatPatch::Circle::contains(Vec2 p) const { return squared_distance(center, p) <= radius * radius; }

Vec2 FlatPatch::Circle::closest(Vec2 p) const {
  const double d = std::sqrt(squared_distance(center, p));
  if (d == 0.0) return {center.x + radius, center.y};
  return {center.x + radius * (p.x - center.x) / d, center.y + radius * (p.y - center.y) / d};
}

FlatPatch::FlatPatch(Vec3d normal, std::vector<Vec3d> corners, std::optional<Ring> hole)
    : corners_(std::move(corners)), hole_ring_(hole) {
  const Vec3d u = normalized(corners_[1] - corners_[0]);
  frame_ = {corners_[0], u, cross(normal, u), normal};
  for (const Vec3d& corner : corners_) outline_.push_back(flatten(corner));
  if (hole_ring_) hole_ = flatten(*hole_ring_);
}

FlatPatch::FlatPatch(Vec3d normal, Ring rim, Ring hole)
    : frame_{rim.center, rim.u, cross(normal, rim.u), normal}, rim_ring_(rim), hole_ring_(hole) {
  rim_ = flatten(rim);
  hole_ = flatten(hole);
}

Vec2 FlatPatch::flatten(Vec3d p) const {
  const Vec3d local = frame_.to_local(p);
  return {local.x, local.y};
}

bool FlatPatch::contains(Vec2 p) const {
  if (hole_ && hole_->contains(p)) return false;
  return rim_ ? rim_->contains(p) : inside_polygon(outline_, p);
}

Vec3d FlatPatch::closest(Vec3d p) const {
  const Vec3d local = frame_.to_local(p);
  const Vec2 q{local.x, local.y};
  if (contains(q)) return p - frame_.w * local.z;
  Vec2 best;
  double least = std::numeric_limits<double>::infinity();
  const auto consider = [&](Vec2 candidate) {
    const double d = squared_distance(candidate, q);
    if (d >= least) return;
    least = d;
    best = candidate;
  };
  for (size_t i = 0, j = outline_.size() - 1; i < outline_.size(); j = i++)
    consider(closest_on_segment(outline_[j], outline_[i], q));
  if (rim_) consider(rim_->closest(q));
  if (hole_) consider(hole_->closest(q));
  return frame_.to_world({best.x, best.y, 0.0});
}

std::optional<double> FlatPatch::intersect(Vec3d origin, Vec3d direction) const {
  const double slope = dot(direction, frame_.w);
  if (slope >= 0.0) return std::nullopt;
  const double t = dot(frame_.origin - origin, frame_.w) / slope;
  if (t < 0.0 || !contains(flatten(origin + direction * t))) return std::nullopt;
  return t;
}

double FlatPatch::area() const {
  double area = 0.0;
  for (size_t i = 0, j = outline_.size() - 1; i < outline_.size(); j = i++)
    area += 0.5 * (outline_[j].x * outline_[i].y - outline_[i].x * outline_[j].y);
  if (rim_) area += pi * rim_->radius * rim_->radius;
  if (hole_) area -= pi * hole_->radius * hole_->radius;
  return area;
}

void FlatPatch::clip(const std::vector<Vec3d>& polygon, MeshBuilder& builder) const {
  std::vector<Vec2> flat;
  std::vector<uint32_t> index;
  for (const Vec3d& p : polygon) {
    flat.push_back(flatten(p));
    index.push_back(builder.vertex(p));
  }
  clip_ears(flat, index, builder);
}

void FlatPatch::tessellate(int segments, MeshBuilder& builder) const {
  const auto counter_clockwise = [&](const Ring& ring) {
    std::vector<Vec3d> points = ring.points(segments);
    if (dot(cross(ring.u, ring.v), frame_.w) < 0.0) std::reverse(points.begin(), points.end());
    return points;
  };
  const std::vector<Vec3d> outer = rim_ring_ ? counter_clockwise(*rim_ring_) : corners_;
  if (!hole_ring_) return clip(outer, builder);

  // Two cuts from opposite corners to the hole leave two simple polygons.
  const std::vector<Vec3d> inner = counter_clockwise(*hole_ring_);
  const auto nearest = [&](Vec3d corner) {
    size_t best = 0;
    for (size_t i = 1; i < inner.size(); ++i)
      if (norm(inner[i] - corner) < norm(inner[best] - corner)) best = i;
    return best;
  };
  const size_t opposite = outer.size() / 2;
  for (const auto& [from, to] : {std::pair{size_t{0}, opposite}, std::pair{opposite, outer.size()}}) {
    std::vector<Vec3d> polygon;
    for (size_t i = from; i <= to; ++i) polygon.push_back(outer[i % outer.size()]);
    const size_t last = nearest(polygon.front());
    for (size_t i = nearest(polygon.back()); i != last; i = (i + inner.size() - 1) % inner.size())
      polygon.push_back(inner[i]);
    polygon.push_back(inner[last]);
    clip(polygon, builder);
  }
}

BandPatch::BandPatch(Ring bottom, Ring top, double outward) : bottom_(bottom), top_(top), outward_(outward) {
  frame_ = {bottom.center, bottom.u, bottom.v, cross(bottom.u, bottom.v)};
  height_ = norm(top.center - bottom.center);
}

Vec3d BandPatch::normal(Vec3d on_patch) const {
  const Vec3d local = frame_.to_local(on_patch);
  return normalized(frame_.u * local.x + frame_.v * local.y) * outward_;
}

Vec3d BandPatch::closest(Vec3d p) const {
  Vec3d local = frame_.to_local(p);
  const double axial = std::hypot(local.x, local.y);
  const Vec3d radial = axial > 0.0 ? Vec3d{local.x / axial, local.y / axial, 0.0} : Vec3d{1.0, 0.0, 0.0};
  return frame_.to_world(radial * bottom_.radius + Vec3d{0.0, 0.0, std::clamp(local.z, 0.0, height_)});
}

std::optional<double> BandPatch::intersect(Vec3d origin, Vec3d direction) const {
  const Vec3d o = frame_.to_local(origin);
  const Vec3d d{dot(direction, frame_.u), dot(direction, frame_.v), dot(direction, frame_.w)};
  const double a = d.x * d.x + d.y * d.y;
  // The discriminant from the distance between ray and axis: no cancellation of large squares.
  const double across = o.x * d.y - o.y * d.x;
  const double discriminant = a * bottom_.radius * bottom_.radius - across * across;
  if (a == 0.0 || discriminant < 0.0) return std::nullopt;
  // A boss is entered at the near root; a bore's wall is met from within, at the far root.
  const double t = (-(o.x * d.x + o.y * d.y) - outward_ * std::sqrt(discriminant)) / a;
  const double z = o.z + t * d.z;
  if (t < 0.0 || z < 0.0 || z > height_) return std::nullopt;
  return t;
}

double BandPatch::area() const { return 2.0 * pi * bottom_.radius * height_; }

void BandPatch::tessellate(int segments, MeshBuilder& builder) const {
  const std::vector<Vec3d> low = bottom_.points(segments);
  const std::vector<Vec3d> high = top_.points(segments);
  for (size_t i = 0, j = low.size() - 1; i < low.size(); j = i++) {
    const uint32_t a = builder.vertex(low[j]);
    const uint32_t b = builder.vertex(low[i]);
    const uint32_t c = builder.vertex(high[i]);
    const uint32_t d = builder.vertex(high[j]);
    outward_ > 0.0 ? builder.quad(a, b, c, d) : builder.quad(d, c, b, a);
  }
}

}  // namespace soapfilm
