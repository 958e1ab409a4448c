// A rigid motion that brings points onto a model: ICP, its correspondences being exact closest points.
#pragma once

#include <array>
#include <vector>

#include "soapfilm/context.h"
#include "soapfilm/core/vec.h"
#include "tools/mesh/signed_distance.h"

namespace soapfilm {

/// p becomes R p + shift.
struct RigidMotion {
  std::array<Vec3d, 3> rows{Vec3d{1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, 0, 1}};  ///< of the rotation R
  Vec3d shift;

  Vec3d vector(Vec3d v) const { return {dot(rows[0], v), dot(rows[1], v), dot(rows[2], v)}; }
  Vec3d point(Vec3d p) const { return vector(p) + shift; }
  double angle_deg() const;  ///< of the rotation, [0, 180]
};

struct Alignment {
  RigidMotion motion;
  int iterations = 0;
  bool converged = false;
  int free_directions = 0;   ///< in which the points slide on the model, such as around an axis: left as they were
  double median_before = 0;  ///< of the distances, input units
  double median_after = 0;
};

/// Gauss-Newton on the signed distances, each weighed by Tukey's function of its ratio to the spread of all, so that
/// what is not on the model (a table, a clamp) does not pull; the spread shrinks with the residuals. The points must
/// be near their places: within about a tenth of the size. Part of the model is enough if it fixes the position.
/// The result does not depend on the number of threads.
///
/// Throws ParameterError for fewer than 10 points, points on a line, and when half of them stay farther from the model
/// than a twentieth of its size.
Alignment align(const std::vector<Vec3d>& points, const SignedDistance& model, const Context& context);

}  // namespace soapfilm
