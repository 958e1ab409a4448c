#include "tools/scanner/shape.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "soapfilm/error.h"

namespace soapfilm {

namespace {

/// Narrows [enter, leave] to the part of the ray in the box |p| <= half; empty when enter > leave afterwards.
void clip_to_box(Vec3d origin, Vec3d direction, Vec3d half, double& enter, double& leave) {
  for (int axis = 0; axis < 3; ++axis) {
    if (direction[axis] == 0.0) {
      if (std::abs(origin[axis]) > half[axis]) leave = -1.0;
      continue;
    }
    const double a = (-half[axis] - origin[axis]) / direction[axis];
    const double b = (half[axis] - origin[axis]) / direction[axis];
    enter = std::max(enter, std::min(a, b));
    leave = std::min(leave, std::max(a, b));
  }
}

using Maker = std::shared_ptr<const Shape> (*)(const ShapeParams&);
struct NamedMaker {
  const char* name;
  Maker make;
};
constexpr std::array<NamedMaker, 7> makers{{{"sphere", make_sphere},
                                            {"torus", make_torus},
                                            {"part", make_part},
                                            {"plate", make_plate},
                                            {"sheets", make_sheets},
                                            {"knot", make_knot},
                                            {"arch", make_arch}}};

}  // namespace

std::optional<SurfacePoint> Shape::intersect(Vec3d origin, Vec3d direction) const {
  const Vec3d local = origin - center_;
  double enter = 0.0;
  double leave = norm(local) + 2.0 * norm(half_size_);
  // The box is widened a little, so that a face lying in it is entered from outside.
  clip_to_box(local, direction, half_size_ * (1.0 + 1e-6), enter, leave);
  if (enter > leave) return std::nullopt;
  const Vec3d entry = local + direction * enter;
  const std::optional<double> t = local_intersect(entry, direction, leave - enter);
  if (!t) return std::nullopt;
  const Vec3d hit = entry + direction * *t;
  return SurfacePoint{center_ + hit, local_nearest(hit).normal, enter + *t};
}

SurfacePoint Shape::closest(Vec3d p) const {
  const Vec3d local = p - center_;
  const Nearest nearest = local_nearest(local);
  return {center_ + (local - nearest.normal * nearest.distance), nearest.normal, std::abs(nearest.distance)};
}

Mesh Shape::tessellate(double tolerance) const {
  if (!(tolerance > 0.0)) throw ParameterError(fmt::format("tolerance = {}, must be > 0", tolerance));
  Mesh mesh = local_tessellate(tolerance);
  for (Vec3d& v : mesh.vertices) v += center_;
  return mesh;
}

std::optional<double> Shape::local_intersect(Vec3d origin, Vec3d direction, double length) const {
  // Sphere tracing (Hart 1996); close to the surface Newton's step along the ray replaces the radius. It never passes
  // the surface of a convex solid; where it does pass, the root is bracketed.
  const double scale = norm(half_size_);
  const double close = 1e-3 * scale;
  const double hit = 1e-14 * scale;
  const double least_step = 1e-6 * scale;  // past a grazing contact
  constexpr int most_steps = 10000;
  double outside = 0.0;
  double t = 0.0;
  for (int i = 0; i < most_steps && t <= length; ++i) {
    const double bound = local_lower_bound(origin + direction * t);
    if (bound > close) {
      outside = t;
      t += bound;
      continue;
    }
    const Nearest nearest = local_nearest(origin + direction * t);
    if (nearest.distance < -hit) return t > 0.0 ? close_in(origin, direction, outside, t) : std::nullopt;
    if (nearest.distance <= hit) return t;
    outside = t;
    const double approach = -dot(nearest.normal, direction);
    t += nearest.distance > close ? nearest.distance
         : approach > 0.0         ? std::max(nearest.distance / std::max(approach, 0.125), hit)
                                  : std::max(nearest.distance, least_step);
  }
  return std::nullopt;
}

std::optional<double> Shape::close_in(Vec3d origin, Vec3d direction, double outside, double inside) const {
  // Regula falsi with bisection every other step, until the bracket is as narrow as doubles allow.
  double f_outside = local_nearest(origin + direction * outside).distance;
  double f_inside = local_nearest(origin + direction * inside).distance;
  for (int i = 0; i < 100 && f_outside > 0.0 && f_inside < 0.0; ++i) {
    const double middle =
        i % 2 == 0 ? outside + (inside - outside) * (f_outside / (f_outside - f_inside)) : 0.5 * (outside + inside);
    if (middle <= outside || middle >= inside) break;
    const double f = local_nearest(origin + direction * middle).distance;
    (f > 0.0 ? outside : inside) = middle;
    (f > 0.0 ? f_outside : f_inside) = f;
    if (f == 0.0) return middle;
  }
  return f_outside < -f_inside ? outside : inside;
}

std::vector<std::string> shape_names() {
  std::vector<std::string> names;
  for (const NamedMaker& maker : makers) names.emplace_back(maker.name);
  return names;
}

std::shared_ptr<const Shape> make_shape(const std::string& name, const ShapeParams& params) {
  const auto range = [](const char* what, double value, double lo, double hi) {
    if (!(value >= lo && value <= hi))
      throw ParameterError(fmt::format("{} = {}, must be in [{}, {}] times the size", what, value, lo, hi));
  };
  if (!(params.size > 0.0) || !std::isfinite(params.size))
    throw ParameterError(fmt::format("size = {}, must be > 0", params.size));
  if (!is_finite(params.center)) throw ParameterError("center: its coordinates must be finite");
  range("thickness", params.thickness, 1e-4, name == "sheets" ? 0.25 : 0.5);
  range("gap", params.gap, 1e-4, 0.5);
  for (const NamedMaker& maker : makers)
    if (name == maker.name) return maker.make(params);
  throw ParameterError(fmt::format("shape = {}, must be one of {}", name, fmt::join(shape_names(), ", ")));
}

}  // namespace soapfilm
