// Sphere, plate and sheets: boxes with rounded edges. A ball is one whose flat parts have no extent.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "tools/scanner/mesh_builder.h"
#include "tools/scanner/shape.h"

namespace soapfilm {

namespace {

using std::numbers::pi;

struct RoundedBox {
  Vec3d center;
  Vec3d inner;  ///< half extents of the box that a ball of `radius` sweeps
  double radius;

  double signed_distance(Vec3d p, Vec3d& normal) const;
  /// Ticks of one axis from -(inner + radius) to inner + radius: each rounded edge is cut at equal angles.
  std::vector<double> ticks(int axis, int steps) const;
  void tessellate(int steps, MeshBuilder& builder) const;

  double volume() const {  // Steiner's formula
    const Vec3d s = inner * 2.0;
    return s.x * s.y * s.z + 2.0 * radius * (s.x * s.y + s.y * s.z + s.z * s.x) +
           pi * radius * radius * (s.x + s.y + s.z) + 4.0 / 3.0 * pi * radius * radius * radius;
  }
  double area() const {
    const Vec3d s = inner * 2.0;
    return 2.0 * (s.x * s.y + s.y * s.z + s.z * s.x) + 2.0 * pi * radius * (s.x + s.y + s.z) +
           4.0 * pi * radius * radius;
  }
};

double RoundedBox::signed_distance(Vec3d p, Vec3d& normal) const {
  p = p - center;
  const Vec3d core{std::clamp(p.x, -inner.x, inner.x), std::clamp(p.y, -inner.y, inner.y),
                   std::clamp(p.z, -inner.z, inner.z)};
  const Vec3d offset = p - core;
  const double length = norm(offset);
  if (length > 0.0) {
    normal = offset / length;
    return length - radius;
  }
  // Inside the inner box the closest point lies on the nearest flat face (+x at the center of a ball).
  int axis = 0;
  for (int k = 1; k < 3; ++k)
    if (inner[k] - std::abs(p[k]) < inner[axis] - std::abs(p[axis])) axis = k;
  normal = {};
  normal[axis] = p[axis] < 0.0 ? -1.0 : 1.0;
  return std::abs(p[axis]) - inner[axis] - radius;
}

std::vector<double> RoundedBox::ticks(int axis, int steps) const {
  std::vector<double> rim;  // offsets from the inner face, 0 < ... <= radius
  for (int i = 1; i <= steps; ++i) rim.push_back(radius * std::tan(0.25 * pi * i / steps));
  std::vector<double> ticks;
  for (int i = steps; i-- > 0;) ticks.push_back(-inner[axis] - rim[i]);
  if (inner[axis] > 0.0) ticks.push_back(-inner[axis]);
  ticks.push_back(inner[axis]);
  for (int i = 0; i < steps; ++i) ticks.push_back(inner[axis] + rim[i]);
  return ticks;
}

void RoundedBox::tessellate(int steps, MeshBuilder& builder) const {
  const std::array<std::vector<double>, 3> grid{ticks(0, steps), ticks(1, steps), ticks(2, steps)};
  const auto vertex = [&](Vec3d on_box) {
    Vec3d normal;
    const double d = signed_distance(center + on_box, normal);
    return builder.vertex(center + (on_box - normal * d));
  };
  for (int axis = 0; axis < 3; ++axis) {
    const int u = (axis + 1) % 3;
    const int v = (axis + 2) % 3;
    for (const bool front : {false, true}) {
      Vec3d corner;
      corner[axis] = front ? grid[axis].back() : grid[axis].front();
      std::vector<uint32_t> index;
      for (const double y : grid[v]) {
        for (const double x : grid[u]) {
          corner[u] = x;
          corner[v] = y;
          index.push_back(vertex(corner));
        }
      }
      const size_t columns = grid[u].size();
      for (size_t j = 0; j + 1 < grid[v].size(); ++j) {
        for (size_t i = 0; i + 1 < columns; ++i) {
          const std::array<uint32_t, 4> q{index[j * columns + i], index[j * columns + i + 1],
                                          index[(j + 1) * columns + i + 1], index[(j + 1) * columns + i]};
          front ? builder.quad(q[0], q[1], q[2], q[3]) : builder.quad(q[3], q[2], q[1], q[0]);
        }
      }
    }
  }
}

/// One or several rounded boxes that do not touch.
class RoundedBoxes final : public Shape {
 public:
  RoundedBoxes(Vec3d center, Vec3d half_size, std::vector<RoundedBox> boxes, ShapeFacts facts)
      : Shape(center, half_size, std::move(facts)), boxes_(std::move(boxes)) {}

 private:
  Nearest local_nearest(Vec3d p) const override {
    // A way from inside one box to another's surface crosses its own first, so the nearest of all surfaces is right.
    Nearest best;
    for (const RoundedBox& box : boxes_) {
      Vec3d normal;
      const double d = box.signed_distance(p, normal);
      if (&box == &boxes_.front() || std::abs(d) < std::abs(best.distance)) best = {d, normal};
    }
    return best;
  }

  Mesh local_tessellate(double tolerance) const override {
    MeshBuilder builder;
    for (const RoundedBox& box : boxes_) {
      // A facet of angle a along both directions lies about radius a^2 / 4 below the ball.
      const double angle = std::sqrt(4.0 * tolerance / box.radius);
      box.tessellate(std::clamp(static_cast<int>(std::ceil(0.25 * pi / angle)), 2, 1000), builder);
    }
    return builder.take();
  }

  std::vector<RoundedBox> boxes_;
};

/// A plate around `center`; its edges are rounded with a radius of a quarter of its thickness.
RoundedBox plate_at(Vec3d center, Vec3d half) {
  const double radius = 0.5 * half.z;
  return {center, half - Vec3d{radius, radius, radius}, radius};
}

}  // namespace

std::shared_ptr<const Shape> make_sphere(const ShapeParams& params) {
  const double radius = 0.5 * params.size;
  const RoundedBox ball{{}, {}, radius};
  ShapeFacts facts{"sphere", {{"radius", radius}}, 1, 0, params.size, ball.volume(), ball.area()};
  return std::make_shared<RoundedBoxes>(params.center, Vec3d{radius, radius, radius}, std::vector{ball},
                                        std::move(facts));
}

std::shared_ptr<const Shape> make_plate(const ShapeParams& params) {
  const Vec3d half = Vec3d{1.0, 0.7, params.thickness} * (0.5 * params.size);
  const RoundedBox plate = plate_at({}, half);
  ShapeFacts facts;
  facts.name = "plate";
  facts.parameters = {
      {"length", 2.0 * half.x}, {"width", 2.0 * half.y}, {"thickness", 2.0 * half.z}, {"edge_radius", plate.radius}};
  facts.narrowest = 2.0 * half.z;
  facts.volume = plate.volume();
  facts.area = plate.area();
  return std::make_shared<RoundedBoxes>(params.center, half, std::vector{plate}, std::move(facts));
}

std::shared_ptr<const Shape> make_sheets(const ShapeParams& params) {
  // So narrow that scanners all around see into the gap down to its middle.
  const Vec3d half = Vec3d{1.0, 0.45, params.thickness} * (0.5 * params.size);
  const double gap = params.gap * params.size;
  const Vec3d up{0.0, 0.0, 0.5 * gap + half.z};
  const RoundedBox upper = plate_at(up, half);
  const RoundedBox lower = plate_at(-up, half);
  ShapeFacts facts;
  facts.name = "sheets";
  facts.parameters = {{"length", 2.0 * half.x},
                      {"width", 2.0 * half.y},
                      {"thickness", 2.0 * half.z},
                      {"gap", gap},
                      {"edge_radius", upper.radius}};
  facts.components = 2;
  facts.narrowest = std::min(2.0 * half.z, gap);
  facts.volume = 2.0 * upper.volume();
  facts.area = 2.0 * upper.area();
  const Vec3d box{half.x, half.y, 0.5 * gap + 2.0 * half.z};
  return std::make_shared<RoundedBoxes>(params.center, box, std::vector{lower, upper}, std::move(facts));
}

}  // namespace soapfilm
