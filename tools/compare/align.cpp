#include "tools/compare/align.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "soapfilm/error.h"

namespace soapfilm {

namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

constexpr int most_iterations = 200;

double median_of(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Where the points are and how far they reach: in these units rotations and shifts weigh alike.
struct Extent {
  Vec3d center;
  double size = 0;  ///< root of the mean squared distance from the center
};

/// Throws for points that fix no position whatever the model is.
Extent extent_of(const std::vector<Vec3d>& points) {
  constexpr size_t least = 10;
  if (points.size() < least)
    throw ParameterError(fmt::format("{} points to align, must be at least {}", points.size(), least));
  const auto n = static_cast<double>(points.size());
  Extent extent;
  for (const Vec3d& p : points) extent.center += (p - points[0]) / n;
  extent.center += points[0];
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const Vec3d& p : points) {
    const Vec3d d = p - extent.center;
    const Eigen::Vector3d v(d.x, d.y, d.z);
    spread += v * v.transpose() / n;
  }
  extent.size = std::sqrt(spread.trace());
  const Eigen::Vector3d along = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(spread).eigenvalues();
  constexpr double thin = 1e-12;  // of variances: a line's width is below 1e-6 of its length
  if (!(along[1] > thin * along[2]))
    throw ParameterError("the points to align lie on a line or at one place, must spread over a surface");
  return extent;
}

/// The rotation by the vector `turn` (axis times angle), Rodrigues' formula.
RigidMotion rotation(Vec3d turn) {
  const double angle = norm(turn);
  const Vec3d axis = normalized(turn);
  RigidMotion motion;
  for (int k = 0; k < 3; ++k) {
    Vec3d unit;
    unit[k] = 1;
    const Vec3d image =
        unit * std::cos(angle) + cross(axis, unit) * std::sin(angle) + axis * (dot(axis, unit) * (1 - std::cos(angle)));
    for (size_t row = 0; row < 3; ++row) motion.rows[row][k] = image[static_cast<int>(row)];
  }
  return motion;
}

/// First `inner`, then `outer`.
RigidMotion after(const RigidMotion& outer, const RigidMotion& inner) {
  RigidMotion both;
  for (size_t row = 0; row < 3; ++row) {
    const Vec3d r = outer.rows[row];
    both.rows[row] = inner.rows[0] * r.x + inner.rows[1] * r.y + inner.rows[2] * r.z;
  }
  both.shift = outer.point(inner.shift);
  return both;
}

struct Step {
  Vector6 move;  ///< rotation about the center, then shift over the size
  int free_directions = 0;
};

/// One weighted step towards smaller distances. Directions that hardly change any distance are left out.
Step step_of(const std::vector<SignedPoint>& found, const std::vector<Vec3d>& points, const Extent& extent,
             double spread) {
  Matrix6 normal = Matrix6::Zero();
  Vector6 right = Vector6::Zero();
  for (size_t i = 0; i < found.size(); ++i) {
    const double ratio = found[i].distance / spread;
    if (std::abs(ratio) >= 1) continue;
    const double weight = (1 - ratio * ratio) * (1 - ratio * ratio);
    const Vec3d arm = (points[i] - extent.center) / extent.size, n = found[i].normal, turn = cross(arm, n);
    Vector6 row;
    row << turn.x, turn.y, turn.z, n.x, n.y, n.z;
    normal += weight * row * row.transpose();
    right -= weight * found[i].distance / extent.size * row;
  }
  const Eigen::SelfAdjointEigenSolver<Matrix6> parts(normal);
  constexpr double stiff = 1e-5;  // of the largest
  Step step{Vector6::Zero(), 0};
  for (int k = 0; k < 6; ++k) {
    const double value = parts.eigenvalues()[k];
    if (!(value > stiff * parts.eigenvalues()[5])) {
      ++step.free_directions;
      continue;
    }
    step.move += parts.eigenvectors().col(k) * (parts.eigenvectors().col(k).dot(right) / value);
  }
  return step;
}

std::vector<double> lengths_of(const std::vector<SignedPoint>& found) {
  std::vector<double> lengths;
  for (const SignedPoint& p : found) lengths.push_back(std::abs(p.distance));
  return lengths;
}

}  // namespace

double RigidMotion::angle_deg() const {
  const Vec3d axis{rows[2].y - rows[1].z, rows[0].z - rows[2].x, rows[1].x - rows[0].y};
  const double cosine = (rows[0].x + rows[1].y + rows[2].z - 1) / 2;
  return std::atan2(norm(axis) / 2, cosine) * (180 / std::numbers::pi);
}

Alignment align(const std::vector<Vec3d>& points, const SignedDistance& model, const Context& context) {
  const Extent start = extent_of(points);
  constexpr double still = 1e-10;        // of the size: the end
  constexpr double least_spread = 1e-9;  // of the size: exact points leave no spread
  constexpr double tukey = 4.685 * 1.4826;
  Alignment out;
  std::vector<Vec3d> moved = points;
  std::vector<SignedPoint> found = model(moved, context);
  out.median_before = median_of(lengths_of(found));
  for (; out.iterations < most_iterations && !out.converged; ++out.iterations) {
    context.progress().check();
    const Extent extent{out.motion.point(start.center), start.size};
    const double spread = std::max(tukey * median_of(lengths_of(found)), least_spread * start.size);
    const Step step = step_of(found, moved, extent, spread);
    out.free_directions = step.free_directions;
    RigidMotion more = rotation({step.move[0], step.move[1], step.move[2]});
    const Vec3d shift = Vec3d{step.move[3], step.move[4], step.move[5]} * start.size;
    more.shift = extent.center - more.vector(extent.center) + shift;
    out.motion = after(more, out.motion);
    for (size_t i = 0; i < points.size(); ++i) moved[i] = out.motion.point(points[i]);
    found = model(moved, context);
    out.converged = step.move.norm() < still;
  }
  out.median_after = median_of(lengths_of(found));
  constexpr double nonsense = 0.05;
  if (!(out.median_after < nonsense * start.size))
    throw ParameterError(fmt::format(
        "no fit: half of the points stay farther than {:.3g} from the model; bring them near their places first",
        out.median_after));
  return out;
}

}  // namespace soapfilm
