// Analytic solids: ground truth whose distance, topology and volume are known.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "tools/scanner/surface.h"

namespace soapfilm {

/// What is known about a shape besides its geometry.
struct ShapeFacts {
  std::string name;
  std::vector<std::pair<std::string, double>> parameters;  ///< as built, input units
  int components = 1;
  int genus = 0;                 ///< of all components together
  double narrowest = 0;          ///< thinnest wall, gap or hole, input units
  std::optional<double> volume;  ///< when known in closed form
  std::optional<double> area;    ///< when known in closed form
};

/// A closed solid with a signed distance to its surface. Implementations work in a frame whose origin is the center of
/// the box; this class transforms queries to it, so that georeferenced shapes lose no digits.
class Shape : public Surface {
 public:
  const ShapeFacts& facts() const { return facts_; }

  /// Distance to the surface, negative inside.
  double signed_distance(Vec3d p) const { return local_nearest(p - center_).distance; }

  /// A ray that starts inside the solid meets nothing.
  std::optional<SurfacePoint> intersect(Vec3d origin, Vec3d direction) const final;
  SurfacePoint closest(Vec3d p) const final;
  Box3d box() const final { return {center_ - half_size_, center_ + half_size_}; }
  Mesh tessellate(double tolerance) const final;
  std::optional<double> volume() const final { return facts_.volume; }
  std::optional<double> area() const final { return facts_.area; }

 protected:
  /// Signed distance and its gradient: the unit normal at the closest point, which is p - distance * normal.
  struct Nearest {
    double distance = 0;
    Vec3d normal;
  };

  Shape(Vec3d center, Vec3d half_size, ShapeFacts facts)
      : center_(center), half_size_(half_size), facts_(std::move(facts)) {}

  virtual Nearest local_nearest(Vec3d p) const = 0;
  virtual Mesh local_tessellate(double tolerance) const = 0;
  /// A lower bound of the signed distance, away from the surface at least a fixed fraction of it; may be cheaper.
  virtual double local_lower_bound(Vec3d p) const { return local_nearest(p).distance; }
  /// Distance along the ray to the first hit in [0, length], where the ray leaves the box. By default sphere tracing.
  virtual std::optional<double> local_intersect(Vec3d origin, Vec3d direction, double length) const;

  Vec3d half_size() const { return half_size_; }

 private:
  std::optional<double> close_in(Vec3d origin, Vec3d direction, double outside, double inside) const;

  Vec3d center_;
  Vec3d half_size_;
  ShapeFacts facts_;
};

struct ShapeParams {
  double size = 1.0;        ///< longest side of the box, input units, > 0
  Vec3d center{};           ///< of the box, input units
  double thickness = 0.12;  ///< of the plate and of each sheet, as a part of `size`; [1e-4, 0.5], sheets [1e-4, 0.25]
  double gap = 0.16;        ///< between the sheets, and the feet of the arch, as a part of `size`; [1e-4, 0.5]
};

/// Ball of diameter `size`.
std::shared_ptr<const Shape> make_sphere(const ShapeParams& params = {});
/// Tube radius 2/5 of the ring radius; genus 1, axis along z.
std::shared_ptr<const Shape> make_torus(const ShapeParams& params = {});
/// Sharp-edged angle bracket with a bore through each leg and a collar around one of them; genus 2.
std::shared_ptr<const Shape> make_part(const ShapeParams& params = {});
/// Thin box, size x 0.7 size x thickness; its edges are rounded with a radius of a quarter of the thickness.
std::shared_ptr<const Shape> make_plate(const ShapeParams& params = {});
/// Two such plates, size x 0.45 size x thickness, parallel, `gap` apart: two components.
std::shared_ptr<const Shape> make_sheets(const ShapeParams& params = {});
/// Trefoil knot as a tube, with a post between the strands at each of its three crossings; genus 4. Its distance is
/// exact outside; inside it is exact except for points closest to a post's foot, where the error is less than 1e-6
/// size.
std::shared_ptr<const Shape> make_knot(const ShapeParams& params = {});
/// Tube bent to an upside-down U in the plane y = 0: two round-ended feet, `gap` apart. Its radius is 0.18 size, or
/// less where a wide gap leaves less.
std::shared_ptr<const Shape> make_arch(const ShapeParams& params = {});

/// The names that make_shape knows, in the order above.
std::vector<std::string> shape_names();
/// By name. Throws ParameterError for an unknown name or a parameter out of range.
std::shared_ptr<const Shape> make_shape(const std::string& name, const ShapeParams& params = {});

}  // namespace soapfilm
