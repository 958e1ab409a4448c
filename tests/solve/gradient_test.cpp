// The gradient and its adjoint as the sweep kernels compute them, against a dense copy of the grid.
#include <gtest/gtest.h>

#include "soapfilm/solve/sweep.h"
#include "support/back_ends.h"
#include "support/dense.h"
#include "support/random_level.h"

namespace soapfilm {
namespace TEST_FILE {

using namespace test;

/// Faces whose flux the band may not change: those up to an inactive brick.
bool is_fixed_face(const Level& level, size_t brick, int axis, int i) {
  return RandomLevel::is_last(i, axis) &&
         level.grid.neighbors(brick)[static_cast<size_t>(slot_up[axis])] == outside_band;
}

/// p <- p + grad u on the free faces: a dual step of length 1 with a ball too large to matter.
void apply_gradient(Level& level, const Context& context) {
  level.lambda = 1e6f;
  Sweeper(level, context).sweep({.sigma = 1, .tau = 0});
}

/// u <- 1/2 - tau (grad^T p - f) at free vertices: a primal step that the bounds do not clip.
constexpr float tau = 0.25f;
void apply_adjoint(Level& level, const Context& context) {
  for (size_t b = 0; b < level.grid.size(); ++b) std::fill_n(level.u.brick(b), brick_volume, 0.5f);
  Sweeper(level, context).sweep({.sigma = 0, .tau = tau});
}

class Gradient : public testing::TestWithParam<BackEnd> {
 protected:
  Context context = context_on(GetParam());
};

TEST_P(Gradient, IsTheForwardDifferenceAndZeroBeyondTheBand) {
  RandomLevel random(1);
  Level& level = random.level;
  const Dense<double> u = dense_u(level);
  const DenseVectors before = dense_p(level);
  apply_gradient(level, context);
  double worst = 0;
  size_t fixed_moved = 0;
  for (size_t b = 0; b < level.grid.size(); ++b)
    for (int axis = 0; axis < 3; ++axis)
      for_each_vertex(level.grid.coord(b), [&](Vec3i v, int i) {
        const double p = level.p.brick(b, axis)[i];
        const double old = before[static_cast<size_t>(axis)][v];
        if (is_fixed_face(level, b, axis, i))
          fixed_moved += p != old;
        else
          worst = std::max(worst, std::abs(p - old - gradient_at(u, v)[axis]));
      });
  EXPECT_EQ(fixed_moved, 0u) << "a fixed flux changed";
  EXPECT_LT(worst, 2e-7);
}

TEST_P(Gradient, AdjointIsTheBackwardDifferenceWithTheRimsFlux) {
  for (const RimFlux rim : {RimFlux::zero, RimFlux::random}) {
    RandomLevel random(2, {.support = 0, .rim = rim});
    Level& level = random.level;
    const DenseVectors p = dense_p(level);
    apply_adjoint(level, context);
    double worst = 0;
    for (size_t b = 0; b < level.grid.size(); ++b)
      for_each_vertex(level.grid.coord(b), [&](Vec3i v, int i) {
        if (level.box.is_free(v))
          worst = std::max(worst, std::abs((0.5 - level.u.brick(b)[i]) / tau - adjoint_at(p, v)));
        else
          ASSERT_EQ(level.u.brick(b)[i], 0.0f) << "a fixed vertex moved";
      });
    EXPECT_LT(worst, 5e-7);
  }
}

/// <grad u, p> = <u, grad^T p>, both sides from the kernels: beyond the band u and p are zero except the boundary flux.
TEST_P(Gradient, AndItsAdjointAreAdjointOnRandomBands) {
  for (const RimFlux rim : {RimFlux::zero, RimFlux::random})
    for (const uint64_t seed : {3, 5}) {
      const RandomLevelParams params{.band = 0.3 + 0.1 * static_cast<double>(seed - 3), .support = 0, .rim = rim};
      RandomLevel of_gradient(seed, params), of_adjoint(seed, params);
      const Dense<double> u = dense_u(of_gradient.level);
      const DenseVectors p = dense_p(of_gradient.level);
      apply_gradient(of_gradient.level, context);
      apply_adjoint(of_adjoint.level, context);

      double left = 0, right = 0, magnitude = 0;
      const Level& level = of_gradient.level;
      for (size_t b = 0; b < level.grid.size(); ++b) {
        for (int axis = 0; axis < 3; ++axis) {
          const auto& flux = p[static_cast<size_t>(axis)];
          for_each_vertex(level.grid.coord(b), [&](Vec3i v, int i) {
            // Through a fixed face the kernel adds nothing: there grad u = 0 - u.
            const double gradient = is_fixed_face(level, b, axis, i) ? -u[v] : level.p.brick(b, axis)[i] - flux[v];
            left += gradient * flux[v];
            magnitude += std::abs(gradient * flux[v]);
          });
          for_each_low_rim_face(level, b, axis, [&](Vec3i below, float q) { left += q * u[below + along(axis)]; });
        }
        for_each_vertex(level.grid.coord(b), [&](Vec3i v, int i) {
          if (level.box.is_free(v)) right += u[v] * (0.5 - of_adjoint.level.u.brick(b)[i]) / tau;
        });
      }
      EXPECT_NEAR(left, right, 1e-7 * magnitude);
    }
}

TEST_P(Gradient, OfAConstantIsZeroBetweenFreeVertices) {
  RandomLevel random(7, {.rim = RimFlux::zero});
  Level& level = random.level;
  for (size_t b = 0; b < level.grid.size(); ++b) {
    for_each_vertex(level.grid.coord(b),
                    [&](Vec3i v, int i) { level.u.brick(b)[i] = level.box.is_free(v) ? 0.7f : 0.0f; });
    std::fill_n(level.p.brick(b), 3 * brick_volume, 0.0f);
  }
  apply_gradient(level, context);
  size_t nonzero = 0, faces = 0;
  for (size_t b = 0; b < level.grid.size(); ++b)
    for (int axis = 0; axis < 3; ++axis)
      for_each_vertex(level.grid.coord(b), [&](Vec3i v, int i) {
        if (!level.box.is_free(v) || !level.box.is_free(v + along(axis))) return;
        if (level.grid.find(brick_of(v + along(axis))) < 0) return;
        ++faces;
        nonzero += level.p.brick(b, axis)[i] != 0;
      });
  EXPECT_GT(faces, 10000u);
  EXPECT_EQ(nonzero, 0u);
}

INSTANTIATE_TEST_SUITE_P(AllBackEnds, Gradient, testing::ValuesIn(back_ends()), back_end_name);

}  // namespace TEST_FILE
}  // namespace soapfilm
