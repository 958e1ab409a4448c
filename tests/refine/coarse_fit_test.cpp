#include "soapfilm/refine/choose/coarse_fit.h"

#include <gtest/gtest.h>

#include <utility>

#include "refine/band_support.h"

namespace soapfilm {
namespace TEST_FILE {

using namespace test;

const Context one_thread(1);

/// A solved shape's problem on the grid itself and on every second vertex, with fit weights that suit the latter.
struct TwoGrids {
  Solved solved;
  Start start = start_from(labels_of(solved.solution.finest, 0.5f, one_thread), 3, one_thread);
  CoarseFit coarse;

  explicit TwoGrids(Solved problem) : solved(std::move(problem)) {
    coarse.start =
        start_from(every_second_vertex(labels_of(solved.solution.finest, 0.5f, one_thread), one_thread), 3, one_thread);
    coarse.samples = on_every_second_vertex(solved.problem.samples, one_thread);
    coarse.fit_weights = choose_fit_weights(coarse.start, coarse.samples, {}, {}, one_thread, coarse.search);
  }
  bool coarse_serves() const {
    return suffices(coarse, {start, solved.problem.samples, on_half_the_voxel(coarse.fit_weights)}, {}, one_thread);
  }
};

TEST(CoarserGrid, IsUsedForASmoothShapeAndNotForAThinOne) {
  const Disturbance noise{.noise_vox = 0.8};
  const TwoGrids sphere(Solved("sphere", 90, 0.15, noise));
  EXPECT_TRUE(sphere.coarse.fit_weights.edge_preserving);
  EXPECT_TRUE(sphere.coarse_serves());
  // Three voxels thick: a cell and a half of every second vertex.
  constexpr int resolution = 90;
  const TwoGrids plate(Solved(make_shape("plate", {.thickness = 3.0 / (resolution - 12)}), resolution, 0.15, noise));
  EXPECT_TRUE(plate.coarse.fit_weights.edge_preserving);
  EXPECT_FALSE(plate.coarse_serves());
}

TEST(CoarserGrid, IsNotUsedWhereNoSampleDecides) {
  Solved inward("sphere", 60, 0.2, {.noise_vox = 0.8, .viewing = false});
  for (Vec3f& direction : inward.problem.samples.direction) direction = -direction;  // all seen from inside
  EXPECT_FALSE(TwoGrids(std::move(inward)).coarse_serves());
}

TEST(CoarserGrid, IsNotNearWhereMoreThanOneIn500VerticesMovedFarOrNotAtAll) {
  const Solved solved("sphere", 50);
  const Start start = start_from(labels_of(solved.solution.finest, 0.5f, one_thread), 3, one_thread);
  std::vector<size_t> at_surface;
  for (size_t i = 0; i < start.phi0.size(); ++i)
    if (start.phi0.data()[i] != 0 && std::abs(start.phi0.data()[i]) < 1) at_surface.push_back(i);
  ASSERT_GT(at_surface.size(), 5000u);
  // All vertices move by half a voxel, `share` of those at the surface by `step`.
  const auto near = [&](double share, float step) {
    RowArray phi = start.band.make_array();
    for (size_t i = 0; i < phi.size(); ++i) phi.data()[i] = start.phi0.data()[i] + 0.5f;
    for (size_t k = 0; k < static_cast<size_t>(share * static_cast<double>(at_surface.size())); ++k)
      phi.data()[at_surface[7 * k % at_surface.size()]] =
          start.phi0.data()[at_surface[7 * k % at_surface.size()]] + step;
    return is_near(start, phi, 2, one_thread);
  };
  EXPECT_TRUE(near(0, 0));
  EXPECT_TRUE(near(0.5, 1.9f));
  EXPECT_TRUE(near(0.0015, -2.5f));
  EXPECT_FALSE(near(0.003, -2.5f));
  EXPECT_FALSE(near(0.003, 2.5f));
  EXPECT_TRUE(near(0.0015, 0)) << "not reached by the coarser band";
  EXPECT_FALSE(near(0.003, 0));
}

}  // namespace TEST_FILE
}  // namespace soapfilm
