#include <algorithm>
#include <cmath>
#include <numbers>

#include "tools/scanner/mesh_builder.h"
#include "tools/scanner/shape.h"

namespace soapfilm {

namespace {

using std::numbers::pi;

/// Tube of radius `minor` around a circle of radius `major` in the plane z = 0.
class Torus final : public Shape {
 public:
  Torus(Vec3d center, double major, double minor, ShapeFacts facts)
      : Shape(center, {major + minor, major + minor, minor}, std::move(facts)), major_(major), minor_(minor) {}

 private:
  Nearest local_nearest(Vec3d p) const override {
    const double axial = std::hypot(p.x, p.y);
    const Vec3d radial = axial > 0.0 ? Vec3d{p.x / axial, p.y / axial, 0.0} : Vec3d{1.0, 0.0, 0.0};
    const Vec3d offset = p - radial * major_;
    const double length = norm(offset);
    return {length - minor_, length > 0.0 ? offset / length : Vec3d{0.0, 0.0, 1.0}};
  }

  Mesh local_tessellate(double tolerance) const override {
    const auto segments = [&](double radius) {
      return std::clamp(static_cast<int>(std::ceil(2.0 * pi / std::sqrt(4.0 * tolerance / radius))), 8, 4000);
    };
    const int around = segments(major_ + minor_);
    const int across = segments(minor_);
    MeshBuilder builder;
    std::vector<uint32_t> index;
    for (int i = 0; i < around; ++i) {
      const double u = 2.0 * pi * i / around;
      for (int j = 0; j < across; ++j) {
        const double v = 2.0 * pi * j / across;
        const double axial = major_ + minor_ * std::cos(v);
        index.push_back(builder.vertex({axial * std::cos(u), axial * std::sin(u), minor_ * std::sin(v)}));
      }
    }
    for (int i = 0; i < around; ++i) {
      const int next_i = (i + 1) % around;
      for (int j = 0; j < across; ++j) {
        const int next_j = (j + 1) % across;
        builder.quad(index[i * across + j], index[next_i * across + j], index[next_i * across + next_j],
                     index[i * across + next_j]);
      }
    }
    return builder.take();
  }

  double major_;
  double minor_;
};

}  // namespace

std::shared_ptr<const Shape> make_torus(const ShapeParams& params) {
  constexpr double ratio = 0.4;  // tube radius : ring radius
  const double major = 0.5 * params.size / (1.0 + ratio);
  const double minor = ratio * major;
  ShapeFacts facts{"torus",
                   {{"ring_radius", major}, {"tube_radius", minor}},
                   1,
                   1,
                   2.0 * std::min(minor, major - minor),
                   2.0 * pi * pi * major * minor * minor,
                   4.0 * pi * pi * major * minor};
  return std::make_shared<Torus>(params.center, major, minor, std::move(facts));
}

}  // namespace soapfilm
