// A tube bent to an upside-down U: two feet that stand close together.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "tools/scanner/mesh_builder.h"
#include "tools/scanner/shape.h"

namespace soapfilm {

namespace {

using std::numbers::pi;

/// Lengths in input units; the tube's axis lies in the plane y = 0, the feet stand on z = -height / 2.
struct ArchSize {
  double tube;    ///< radius of the tube
  double bend;    ///< radius of its axis in the bend
  double height;  ///< of the box

  double bend_height() const { return 0.5 * height - bend - tube; }  ///< z of the bend's center, where the legs end
  double foot_height() const { return tube - 0.5 * height; }         ///< z of the centers of the round ends
  double leg() const { return bend_height() - foot_height(); }       ///< length of a leg's straight part
};

class Arch final : public Shape {
 public:
  Arch(Vec3d center, const ArchSize& size, ShapeFacts facts)
      : Shape(center, {size.bend + size.tube, size.tube, 0.5 * size.height}, std::move(facts)), size_(size) {}

 private:
  /// Point of the axis closest to p. Away from the axis the surface is at distance `tube` of it everywhere: exact
  /// inside too, because the bend's radius exceeds the tube's.
  Vec3d axis_point(Vec3d p) const {
    const double above = p.z - size_.bend_height();
    if (above > 0.0) {
      const double radial = std::hypot(p.x, above);
      return {size_.bend * p.x / radial, 0.0, size_.bend_height() + size_.bend * above / radial};
    }
    return {p.x < 0.0 ? -size_.bend : size_.bend, 0.0, std::max(p.z, size_.foot_height())};
  }

  Nearest local_nearest(Vec3d p) const override {
    const Vec3d offset = p - axis_point(p);
    const double length = norm(offset);
    return {length - size_.tube, length > 0.0 ? offset / length : Vec3d{0.0, 1.0, 0.0}};
  }

  Mesh local_tessellate(double tolerance) const override;

  ArchSize size_;
};

/// Rings around the axis from the left foot's pole over the bend to the right foot's.
Mesh Arch::local_tessellate(double tolerance) const {
  const auto per_quarter = [&](double radius) {
    return std::clamp(static_cast<int>(std::ceil(0.5 * pi / std::sqrt(4.0 * tolerance / radius))), 2, 1000);
  };
  const int cap = per_quarter(size_.tube);
  const int across = 4 * cap;
  const int bend = 2 * per_quarter(size_.bend + size_.tube);
  MeshBuilder builder;
  std::vector<uint32_t> previous;
  // A ring around the axis, or, in the half sphere of a foot, a smaller one at `latitude` against the plane across the
  // axis.
  const auto add_ring = [&](Vec3d center, Vec3d outer, Vec3d along, double latitude) {
    std::vector<uint32_t> ring;
    for (int j = 0; j < across; ++j) {
      const double v = 2.0 * pi * j / across;
      const Vec3d around = outer * std::cos(v) + Vec3d{0.0, std::sin(v), 0.0};
      ring.push_back(builder.vertex(center + (around * std::cos(latitude) + along * std::sin(latitude)) * size_.tube));
    }
    for (int j = 0; j < across && !previous.empty(); ++j) {
      const int next = (j + 1) % across;
      builder.quad(previous[j], ring[j], ring[next], previous[next]);
    }
    previous = std::move(ring);
  };
  const auto add_pole = [&](double x) {
    return std::vector<uint32_t>(across, builder.vertex({x, 0.0, -0.5 * size_.height}));
  };

  const Vec3d left{-size_.bend, 0.0, size_.foot_height()}, right{size_.bend, 0.0, size_.foot_height()};
  previous = add_pole(-size_.bend);
  for (int i = cap - 1; i >= 0; --i) add_ring(left, {-1, 0, 0}, {0, 0, 1}, -0.5 * pi * i / cap);
  for (int i = 0; i <= bend; ++i) {
    const double angle = pi - pi * i / bend;
    const Vec3d outer{std::cos(angle), 0.0, std::sin(angle)};
    add_ring(Vec3d{0.0, 0.0, size_.bend_height()} + outer * size_.bend, outer, {outer.z, 0.0, -outer.x}, 0.0);
  }
  for (int i = 0; i < cap; ++i) add_ring(right, {1, 0, 0}, {0, 0, -1}, 0.5 * pi * i / cap);
  const std::vector<uint32_t> pole = add_pole(size_.bend);
  for (int j = 0; j < across; ++j) builder.triangle(previous[j], pole[j], previous[(j + 1) % across]);
  return builder.take();
}

}  // namespace

std::shared_ptr<const Shape> make_arch(const ShapeParams& params) {
  constexpr double widest_tube = 0.18;
  const double gap = params.gap * params.size;
  const double tube = std::min(widest_tube * params.size, 0.25 * (params.size - gap));
  const ArchSize size{tube, 0.5 * gap + tube, params.size};
  ShapeFacts facts;
  facts.name = "arch";
  facts.parameters = {{"tube_radius", tube}, {"bend_radius", size.bend}, {"leg", size.leg()}, {"gap", gap}};
  facts.narrowest = std::min(2.0 * tube, gap);
  facts.volume = pi * tube * tube * (pi * size.bend + 2.0 * size.leg() + 4.0 / 3.0 * tube);
  facts.area = 2.0 * pi * tube * (pi * size.bend + 2.0 * size.leg() + 2.0 * tube);
  return std::make_shared<Arch>(params.center, size, std::move(facts));
}

}  // namespace soapfilm
