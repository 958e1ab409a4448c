// A trefoil knot, thickened to a tube, with three posts that join its strands where they cross.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "soapfilm/core/context_state.h"
#include "soapfilm/extract/isosurface.h"
#include "tools/scanner/shape.h"
#include "tools/scanner/trefoil.h"

namespace soapfilm {

namespace {

using std::numbers::pi;
// Lengths in the units of trefoil.h.
constexpr double tube_radius = 0.42;  // the curve's radius of curvature is at least 1.34
constexpr double post_radius = 0.40;
constexpr double strand_distance = 1.68;  // least distance between two strands of the curve

/// Box of the tube in the curve's frame: a point furthest along an axis has its tangent across that axis, so the
/// tube reaches its radius further.
Box3d tube_box() {
  Box3d box;
  constexpr int samples = 3600;
  for (int i = 0; i < samples; ++i) {
    // Near an extremum the polyline falls short by 1e-6 at most; a Newton step on the coordinate's slope corrects it.
    const double phi = 2.0 * pi * i / samples;
    const TrefoilPoint p(phi);
    for (int axis = 0; axis < 3; ++axis) {
      const double step = p.d2[axis] != 0.0 ? -p.d1[axis] / p.d2[axis] : 0.0;
      box.extend(std::abs(step) < 2.0 * pi / samples ? TrefoilPoint(phi + step).c : p.c);
    }
  }
  const Vec3d reach{tube_radius, tube_radius, tube_radius};
  return {box.lo - reach, box.hi + reach};
}

/// Signed distance to a solid and its gradient.
struct Signed {
  double distance = 0;
  Vec3d normal;
};

class Knot final : public Shape {
 public:
  Knot(Vec3d center, double unit, const Box3d& box, ShapeFacts facts)
      : Shape(center, box.size() * (0.5 * unit), std::move(facts)), unit_(unit), middle_(box.center()), curve_(box) {
    for (int k = 0; k < 3; ++k) {
      const double angle = pi / 3.0 + 2.0 * pi * k / 3.0;
      posts_[k] = {trefoil_ring * std::cos(angle), trefoil_ring * std::sin(angle), 0.0};
      for (const double side : {-1.0, 1.0}) feet_.push_back(crease(posts_[k], side));
    }
  }

 private:
  static constexpr int crease_samples = 1024;

  Signed tube(Vec3d p) const {
    const Vec3d offset = p - curve_.closest(p);
    const double length = norm(offset);
    return {length - tube_radius, length > 0.0 ? offset / length : Vec3d{0.0, 0.0, 1.0}};
  }

  /// Capsule around the vertical segment between the two strands at a crossing; its caps lie within the tube.
  static Signed post(Vec3d axis, Vec3d p) {
    const Vec3d offset = p - Vec3d{axis.x, axis.y, std::clamp(p.z, -trefoil_rise, trefoil_rise)};
    const double length = norm(offset);
    return {length - post_radius, length > 0.0 ? offset / length : Vec3d{1.0, 0.0, 0.0}};
  }

  /// The closed curve in which a post meets the tube at its upper (side 1) or lower end.
  std::vector<Vec3d> crease(Vec3d axis, double side) const {
    std::vector<Vec3d> points;
    for (int i = 0; i < crease_samples; ++i) {
      const double angle = 2.0 * pi * i / crease_samples;
      Vec3d p = axis + Vec3d{post_radius * std::cos(angle), post_radius * std::sin(angle), 0.5 * side * trefoil_rise};
      for (int k = 0; k < 50; ++k) {
        const Signed s = tube(p);
        p.z -= s.distance / std::min(side * s.normal.z, -0.05) * side;
        if (std::abs(s.distance) < 1e-14) break;
      }
      points.push_back(p);
    }
    return points;
  }

  /// Inside, a solid's closest point counts only where no other solid covers it; else a crease may be closest.
  Signed nearest_from_inside(Vec3d p, const std::array<Signed, 4>& solids) const {
    constexpr double tolerance = 1e-12;
    double least = std::numeric_limits<double>::infinity();
    Vec3d foot;
    const auto consider = [&](Vec3d candidate) {
      const double d = norm(p - candidate);
      if (d >= least) return;
      least = d;
      foot = candidate;
    };
    bool covered = false;
    for (size_t i = 0; i < solids.size(); ++i) {
      if (std::abs(solids[i].distance) >= least) continue;
      const Vec3d candidate = p - solids[i].normal * solids[i].distance;
      bool exposed = i == 0 || tube(candidate).distance >= -tolerance;
      for (size_t k = 0; k < posts_.size(); ++k)
        exposed = exposed && (k + 1 == i || post(posts_[k], candidate).distance >= -tolerance);
      exposed ? consider(candidate) : void(covered = true);
    }
    if (covered) {
      for (const std::vector<Vec3d>& crease : feet_) {
        if (norm(crease.front() - p) > least + 2.0 * (tube_radius + post_radius)) continue;
        for (size_t i = 0; i < crease.size(); ++i) {
          const Vec3d a = crease[i];
          const Vec3d along = crease[(i + 1) % crease.size()] - a;
          consider(a + along * std::clamp(dot(p - a, along) / dot(along, along), 0.0, 1.0));
        }
      }
    }
    return {-least, least > 0.0 ? (foot - p) / least : solids[0].normal};
  }

  std::array<Signed, 4> solids(Vec3d p) const {
    return {tube(p), post(posts_[0], p), post(posts_[1], p), post(posts_[2], p)};
  }

  /// The solid in which p is deepest or to which it is closest: outside, the surface's distance; inside, a bound of the
  /// depth.
  static Signed outermost(const std::array<Signed, 4>& solids) {
    return *std::min_element(solids.begin(), solids.end(),
                             [](const Signed& a, const Signed& b) { return a.distance < b.distance; });
  }

  Nearest local_nearest(Vec3d local) const override {
    const Vec3d p = middle_ + local / unit_;
    const std::array<Signed, 4> each = solids(p);
    const Signed outer = outermost(each);
    // Next to the surface the direction to it would be rounding, and the solid's own normal is right.
    const Signed s = outer.distance < -1e-9 ? nearest_from_inside(p, each) : outer;
    return {s.distance * unit_, s.normal};
  }

  double local_lower_bound(Vec3d local) const override {
    const Vec3d p = middle_ + local / unit_;
    double bound = curve_.lower_bound(p) - tube_radius;
    for (const Vec3d& axis : posts_) bound = std::min(bound, post(axis, p).distance);
    return bound * unit_;
  }

  Mesh local_tessellate(double tolerance) const override;

  double unit_;
  Vec3d middle_;
  TrefoilSearch curve_;
  std::array<Vec3d, 3> posts_;
  std::vector<std::vector<Vec3d>> feet_;
};

Mesh Knot::local_tessellate(double tolerance) const {
  // Marching cubes on the signed distance, then each vertex to its closest point. Facets of cells of size h lie
  // h^2 / (4 radius) below the tube at most.
  const Vec3d half = half_size();
  const double longest = 2.0 * std::max({half.x, half.y, half.z});
  Lattice lattice;
  lattice.padding = 2;
  lattice.voxel = std::clamp(std::sqrt(4.0 * tolerance * post_radius * unit_), longest / 256.0, longest / 60.0);
  lattice.first_vertex = half * -1.0 - Vec3d{1.5, 1.5, 1.5} * lattice.voxel;
  Vec3i bricks;
  for (int axis = 0; axis < 3; ++axis) {
    lattice.size[axis] = static_cast<int>(std::ceil(2.0 * half[axis] / lattice.voxel)) + 2 * lattice.padding;
    bricks[axis] = (lattice.size[axis] + lattice.margin()[axis]) / brick_side + 1;
  }
  const auto level = [&](Vec3d lattice_position) {
    return outermost(solids(middle_ + lattice.to_world(lattice_position) / unit_)).distance * unit_;
  };
  const auto at_center = [&](Vec3i brick) {
    return level(static_cast<Vec3d>(brick) * double{brick_side} + Vec3d{3.5, 3.5, 3.5});
  };
  const double brick_radius = 0.5 * std::sqrt(3.0) * (brick_side + 1) * lattice.voxel;
  BrickMask active(bricks);
  for (Vec3i b; b.z < bricks.z; ++b.z)
    for (b.y = 0; b.y < bricks.y; ++b.y)
      for (b.x = 0; b.x < bricks.x; ++b.x)
        if (std::abs(at_center(b)) <= brick_radius) active.set(b);

  const Context one_thread(1);
  const BrickGrid grid(active, one_thread);
  Field<float> value(grid, pages_of(one_thread));
  for (size_t b = 0; b < grid.size(); ++b) {
    for (int i = 0; i < brick_volume; ++i) {
      const Vec3i v = grid.first_vertex(b) + vertex_in_brick(i);
      value.brick(b)[i] = static_cast<float>(-level(static_cast<Vec3d>(v)));
    }
  }
  const auto missing = [&](Vec3i b) { return static_cast<float>(-at_center(b)); };
  Mesh mesh = extract_isosurface(grid, value, missing, 0.0f, lattice, one_thread);
  for (Vec3d& v : mesh.vertices) {
    const Nearest nearest = local_nearest(v);
    v = v - nearest.normal * nearest.distance;
  }
  return mesh;
}

}  // namespace

std::shared_ptr<const Shape> make_knot(const ShapeParams& params) {
  const Box3d box = tube_box();
  const double unit = params.size / box.longest();
  ShapeFacts facts;
  facts.name = "knot";
  facts.parameters = {{"torus_ring_radius", trefoil_ring * unit},
                      {"torus_tube_radius", unit},
                      {"rise", trefoil_rise * unit},
                      {"tube_radius", tube_radius * unit},
                      {"post_radius", post_radius * unit}};
  facts.genus = 4;
  facts.narrowest = 2.0 * std::min(post_radius, 0.5 * strand_distance - tube_radius) * unit;
  return std::make_shared<Knot>(params.center, unit, box, std::move(facts));
}

}  // namespace soapfilm
