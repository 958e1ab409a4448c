// An angle bracket: an L-shaped profile with a bore through each leg and a collar around the bore of the lower one.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "tools/scanner/patch.h"
#include "tools/scanner/shape.h"

namespace soapfilm {

namespace {

using std::numbers::pi;
// Lengths in units of the longest side (x). The lower leg lies in the plane z = 0, the upper one stands at x = 0.
constexpr double depth = 0.7;   // along y
constexpr double height = 0.7;  // of the upper leg
constexpr double leg = 0.2;     // thickness of both legs
constexpr double bore = 0.13;   // radius of both bores
constexpr double collar = 0.25;
constexpr double collar_top = 0.35;
constexpr Vec3d lower_bore{0.65, 0.5 * depth, 0.0};  // center, axis z
constexpr Vec3d upper_bore{0.0, 0.5 * depth, 0.45};  // center, axis x
constexpr double narrowest = 0.12;                   // collar wall, and leg above the upper bore

class Part final : public Shape {
 public:
  Part(Vec3d center, double size, ShapeFacts facts)
      : Shape(center, Vec3d{0.5, 0.5 * depth, 0.5 * height} * size, std::move(facts)), size_(size) {
    const Ring low = ring(lower_bore, 'z', bore);
    const Ring low_end = ring(lower_bore + Vec3d{0.0, 0.0, collar_top}, 'z', bore);
    const Ring foot = ring(lower_bore + Vec3d{0.0, 0.0, leg}, 'z', collar);
    const Ring head = ring(lower_bore + Vec3d{0.0, 0.0, collar_top}, 'z', collar);
    const Ring back = ring(upper_bore, 'x', bore);
    const Ring front = ring(upper_bore + Vec3d{leg, 0.0, 0.0}, 'x', bore);

    const auto loop = [&](std::initializer_list<Vec3d> corners) {
      std::vector<Vec3d> placed;
      for (const Vec3d& c : corners) placed.push_back(at(c));
      return placed;
    };
    const double d = depth;
    flats_.emplace_back(Vec3d{0, -1, 0},
                        loop({{0, 0, 0}, {1, 0, 0}, {1, 0, leg}, {leg, 0, leg}, {leg, 0, height}, {0, 0, height}}));
    flats_.emplace_back(Vec3d{0, 1, 0},
                        loop({{0, d, height}, {leg, d, height}, {leg, d, leg}, {1, d, leg}, {1, d, 0}, {0, d, 0}}));
    flats_.emplace_back(Vec3d{0, 0, -1}, loop({{0, 0, 0}, {0, d, 0}, {1, d, 0}, {1, 0, 0}}), low);
    flats_.emplace_back(Vec3d{1, 0, 0}, loop({{1, 0, 0}, {1, d, 0}, {1, d, leg}, {1, 0, leg}}));
    flats_.emplace_back(Vec3d{0, 0, 1}, loop({{leg, 0, leg}, {1, 0, leg}, {1, d, leg}, {leg, d, leg}}), foot);
    flats_.emplace_back(Vec3d{1, 0, 0}, loop({{leg, 0, leg}, {leg, d, leg}, {leg, d, height}, {leg, 0, height}}),
                        front);
    flats_.emplace_back(Vec3d{0, 0, 1}, loop({{0, 0, height}, {leg, 0, height}, {leg, d, height}, {0, d, height}}));
    flats_.emplace_back(Vec3d{-1, 0, 0}, loop({{0, 0, 0}, {0, 0, height}, {0, d, height}, {0, d, 0}}), back);
    flats_.emplace_back(Vec3d{0, 0, 1}, head, low_end);
    bands_.emplace_back(low, low_end, -1.0);
    bands_.emplace_back(foot, head, 1.0);
    bands_.emplace_back(back, front, -1.0);
  }

 private:
  Vec3d at(Vec3d unit) const { return unit * size_ - half_size(); }

  Ring ring(Vec3d center, char axis, double radius) const {
    const Vec3d u = axis == 'x' ? Vec3d{0, 1, 0} : Vec3d{1, 0, 0};
    const Vec3d v = axis == 'x' ? Vec3d{0, 0, 1} : Vec3d{0, 1, 0};
    return {at(center), u, v, radius * size_};
  }

  bool inside(Vec3d p) const {
    const Vec3d q = (p + half_size()) / size_;
    const double to_lower = std::hypot(q.x - lower_bore.x, q.y - lower_bore.y);
    const double to_upper = std::hypot(q.y - upper_bore.y, q.z - upper_bore.z);
    const bool in_profile =
        q.x > 0 && q.z > 0 && q.y > 0 && q.y < depth && ((q.x < 1 && q.z < leg) || (q.x < leg && q.z < height));
    const bool in_collar = to_lower < collar && q.z >= leg && q.z < collar_top;
    const bool in_bore = to_lower <= bore || (to_upper <= bore && q.x <= leg);
    return (in_profile || in_collar) && !in_bore;
  }

  Nearest local_nearest(Vec3d p) const override {
    double least = std::numeric_limits<double>::infinity();
    Vec3d foot;
    Vec3d face_normal;
    const auto consider = [&](const auto& patch) {
      const Vec3d candidate = patch.closest(p);
      const double d = norm(p - candidate);
      if (d >= least) return;
      least = d;
      foot = candidate;
      face_normal = patch.normal(candidate);
    };
    for (const FlatPatch& patch : flats_) consider(patch);
    for (const BandPatch& patch : bands_) consider(patch);
    // So close to the surface that the direction of p - foot is rounding: the face's own normal.
    if (least < 1e-9 * size_) return {dot(p - foot, face_normal), face_normal};
    const double sign = inside(p) ? -1.0 : 1.0;
    return {sign * least, (p - foot) * (sign / least)};
  }

  std::optional<double> local_intersect(Vec3d origin, Vec3d direction, double length) const override {
    if (inside(origin)) return std::nullopt;
    double first = std::numeric_limits<double>::infinity();
    const auto consider = [&](const auto& patch) {
      const std::optional<double> t = patch.intersect(origin, direction);
      if (t && *t < first) first = *t;
    };
    for (const FlatPatch& patch : flats_) consider(patch);
    for (const BandPatch& patch : bands_) consider(patch);
    return first <= length ? std::optional(first) : std::nullopt;
  }

  Mesh local_tessellate(double tolerance) const override {
    const double angle = std::sqrt(8.0 * tolerance / (collar * size_));
    const int segments = 4 * std::clamp(static_cast<int>(std::ceil(0.5 * pi / angle)), 4, 250);
    MeshBuilder builder;
    for (const FlatPatch& patch : flats_) patch.tessellate(segments, builder);
    for (const BandPatch& patch : bands_) patch.tessellate(segments, builder);
    return builder.take();
  }

  double size_;
  std::vector<FlatPatch> flats_;
  std::vector<BandPatch> bands_;
};

/// Areas and volume in units of the size.
double unit_volume() {
  const double profile = leg + leg * (height - leg);
  const double bores = pi * bore * bore * (collar_top + leg);
  return profile * depth - bores + pi * collar * collar * (collar_top - leg);
}

double unit_area() {
  const double profile = leg + leg * (height - leg);
  const double perimeter = 2.0 * (1.0 + height);
  const double openings = 4.0 * pi * bore * bore;  // the collar's top replaces the disc under it
  const double bores = 2.0 * pi * bore * (collar_top + leg);
  return 2.0 * profile + perimeter * depth - openings + bores + 2.0 * pi * collar * (collar_top - leg);
}

}  // namespace

std::shared_ptr<const Shape> make_part(const ShapeParams& params) {
  const double s = params.size;
  ShapeFacts facts{"part",
                   {{"length", s},
                    {"depth", depth * s},
                    {"height", height * s},
                    {"leg", leg * s},
                    {"bore_radius", bore * s},
                    {"collar_radius", collar * s}},
                   1,
                   2,
                   narrowest * s,
                   unit_volume() * s * s * s,
                   unit_area() * s * s};
  return std::make_shared<Part>(params.center, s, std::move(facts));
}

}  // namespace soapfilm
