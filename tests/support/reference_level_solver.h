// The iteration as loops over all vertices of the box, in float, as solve/level_solver.h writes the steps. No tiles, no
// rows that rest, no SIMD, no threads.
#pragma once

#include <algorithm>
#include <cmath>

#include "soapfilm/solve/level_solver.h"
#include "support/dense.h"

namespace soapfilm::test {

class ReferenceSolver final : public LevelSolver {
 public:
  ReferenceSolver(Level& level, const Context& context)
      : LevelSolver(level, context), u_(bits(dense_u(level))), f_(bits(dense_f(level))) {
    const DenseVectors p = dense_p(level);
    for (size_t k = 0; k < 3; ++k) p_[k] = bits(p[k]);
  }

  void sweep(StepSizes steps, int times) override {
    for (int i = 0; i < times; ++i) {
      Dense<float> u_bar(u_.size());
      for_each_active([&](Vec3i v, size_t, int) { u_bar[v] = primal_step(v, steps.tau); });
      for_each_active([&](Vec3i v, size_t, int) { dual_step(v, u_bar, steps.sigma); });
    }
  }

  void download() override {
    for_each_active([&](Vec3i v, size_t brick, int i) {
      level_.u.brick(brick)[i] = u_[v];
      for (int axis = 0; axis < 3; ++axis) level_.p.brick(brick, axis)[i] = p_[static_cast<size_t>(axis)][v];
    });
  }

 private:
  /// Back from double, in which tests keep copies: nothing is lost.
  static Dense<float> bits(const Dense<double>& values) {
    Dense<float> floats(values.size());
    values.for_each([&](Vec3i v) { floats[v] = static_cast<float>(values[v]); });
    return floats;
  }

  template <class Visit>
  void for_each_active(Visit&& visit) const {
    for (size_t b = 0; b < level_.grid.size(); ++b)
      if (!level_.is_held(static_cast<int32_t>(b)))
        for_each_vertex(level_.grid.coord(b), [&](Vec3i v, int i) { visit(v, b, i); });
  }

  float primal_step(Vec3i v, float tau) {
    const auto difference = [&](size_t k) { return p_[k].get(v - along(static_cast<int>(k))) - p_[k][v]; };
    const float grad_t_p = difference(0) + difference(1) + difference(2);
    const float old = u_[v], moved = old - tau * (grad_t_p - f_[v]);
    u_[v] = std::min(std::max(moved, 0.0f), level_.box.is_free(v) ? 1.0f : 0.0f);
    return u_[v] + u_[v] - old;
  }

  bool is_fixed(Vec3i v, int axis) const {
    const Vec3i above = v + along(axis);
    if (level_.rests(level_.grid.find(brick_of(above)))) return true;
    return level_.box.open && !(level_.box.is_free(v) && level_.box.is_free(above));
  }

  void dual_step(Vec3i v, const Dense<float>& u_bar, float sigma) {
    const float lambda = dual_radius(level_);
    std::array<float, 3> kept{}, q{};
    std::array<bool, 3> fixed{};
    for (size_t k = 0; k < 3; ++k) {
      const int axis = static_cast<int>(k);
      fixed[k] = is_fixed(v, axis);
      (fixed[k] ? kept : q)[k] = fixed[k] ? p_[k][v] : p_[k][v] + sigma * (u_bar.get(v + along(axis)) - u_bar[v]);
    }
    const auto squared = [](const std::array<float, 3>& a) { return a[0] * a[0] + a[1] * a[1] + a[2] * a[2]; };
    const float radius_squared = std::max(lambda * lambda - squared(kept), 0.0f), length_squared = squared(q);
    const float scale = length_squared > radius_squared ? std::sqrt(radius_squared) / std::sqrt(length_squared) : 1.0f;
    for (size_t k = 0; k < 3; ++k) {
      if (fixed[k]) continue;
      p_[k][v] = level_.norm == Norm::isotropic ? q[k] * scale : std::min(std::max(q[k], -lambda), lambda);
    }
  }

  Dense<float> u_, f_;
  std::array<Dense<float>, 3> p_;
};

}  // namespace soapfilm::test
