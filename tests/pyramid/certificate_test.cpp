// The sparse certificate against brute force: the dual of every level spread out on the whole fine grid.
#include <gtest/gtest.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "soapfilm/border/border.h"
#include "soapfilm/core/names.h"
#include "soapfilm/pyramid/band.h"
#include "soapfilm/pyramid/coarse_to_fine.h"
#include "soapfilm/pyramid/prolong.h"
#include "soapfilm/pyramid/restrict.h"
#include "support/dense.h"
#include "support/problem.h"

namespace soapfilm {
namespace TEST_FILE {

using namespace test;

const Context one_thread(1);

/// What solve_coarse_to_fine() solves, with every level kept as it was solved. data[l] and levels[l] belong to level l.
struct KeptPyramid {
  std::vector<SupportField> data;
  std::vector<Level> levels;
};

/// The same but for what is not kept: its data is `field`, which must outlive it.
Level copy_of(const Level& level, const SupportField& field) {
  BrickMask band(level.box.bricks);
  for (size_t b = 0; b < level.grid.size(); ++b) band.set(level.grid.coord(b));
  Level copy = make_level(level.box, level.lambda, band, field.grid, field.f, one_thread, level.norm);
  copy.inside = level.inside;
  copy.outside = level.outside;
  for (size_t b = 0; b < level.grid.size(); ++b) {
    EXPECT_EQ(copy.grid.coord(b), level.grid.coord(b));
    std::copy_n(level.u.brick(b), brick_volume, copy.u.brick(b));
    for (int axis = 0; axis < 3; ++axis) {
      std::copy_n(level.p.brick(b, axis), brick_volume, copy.p.brick(b, axis));
      const float* flux = level.rim.plane(b, axis);
      float* kept = copy.rim.plane(b, axis);
      EXPECT_EQ(flux == nullptr, kept == nullptr);
      if (flux && kept) std::copy_n(flux, brick_area, kept);
    }
  }
  return copy;
}

KeptPyramid solve_and_keep(const Problem& problem, double lambda, Norm norm) {
  const Lattice& lattice = problem.lattice;
  KeptPyramid kept;
  kept.data.push_back(divergence_field(problem.samples, lattice.box(0), one_thread));
  for (int l = 1; l < lattice.levels; ++l)
    kept.data.push_back(restrict_field(kept.data.back(), lattice.box(l), one_thread));
  PyramidObserver observe;
  observe.solved = [&](const Level& level, const Lattice&) {
    const auto l = static_cast<size_t>(level.box.level);
    if (kept.levels.empty()) kept.levels.resize(l + 1);
    kept.levels[l] = copy_of(level, kept.data[l]);
  };
  solve_coarse_to_fine(lattice, kept.data[0], lambda, {}, one_thread, norm, observe);
  return kept;
}

/// The dual on every vertex of one level, and whether the vertex counts in the sparse D: inside the band when it is
/// free, outside when the vertex that it descends from was (its fixed children add terms <= 0 too many).
struct WholeDual {
  DenseVectors p;
  Dense<uint8_t> counts;
};

/// Face fluxes of the coarse dual on the fine faces, in double.
WholeDual prolonged(const WholeDual& coarse, Vec3i fine_size) {
  const Dense<double> zero(fine_size);
  WholeDual fine{{zero, zero, zero}, Dense<uint8_t>(fine_size)};
  zero.for_each([&](Vec3i v) {
    const Vec3i parent{v.x >> 1, v.y >> 1, v.z >> 1};
    fine.counts[v] = coarse.counts[parent];
    for (int axis = 0; axis < 3; ++axis) {
      const auto k = static_cast<size_t>(axis);
      const double here = coarse.p[k][parent];
      // An odd vertex's upper face lies on the coarse vertex's own, an even one's within the coarse cell.
      fine.p[k][v] = v[axis] % 2 == 1 ? here / 4 : (here + coarse.p[k].get(parent - along(axis))) / 8;
    }
  });
  return fine;
}

/// An open box has no faces beyond free vertices; the coarser level's may reach further.
void cut_off_border(const LevelBox& box, WholeDual& dual) {
  dual.counts.for_each([&](Vec3i v) {
    dual.counts[v] = dual.counts[v] && box.is_free(v);
    for (int axis = 0; axis < 3; ++axis)
      if (!(box.is_free(v) && box.is_free(v + along(axis)))) dual.p[static_cast<size_t>(axis)][v] = 0;
  });
}

WholeDual whole_dual(const KeptPyramid& pyramid) {
  WholeDual dual;
  for (size_t l = pyramid.levels.size(); l-- > 0;) {
    const Level& level = pyramid.levels[l];
    const Dense<double> zero(level.box.bricks * brick_side);
    dual = l + 1 == pyramid.levels.size() ? WholeDual{{zero, zero, zero}, Dense<uint8_t>(zero.size())}
                                          : prolonged(dual, zero.size());
    for (Dense<double>& p : dual.p) p.for_each([&](Vec3i v) { p[v] *= double{flux_kept(static_cast<int>(l))}; });
    if (level.box.open) cut_off_border(level.box, dual);
    for (size_t b = 0; b < level.grid.size(); ++b)
      for (int axis = 0; axis < 3; ++axis)
        for_each_low_rim_face(level, b, axis, [&](Vec3i v, float flux) {
          EXPECT_NEAR(flux, dual.p[static_cast<size_t>(axis)][v], 1e-6 * level.lambda) << "the rim's flux";
        });
    insert_band(level, dual.p);
    for (size_t b = 0; b < level.grid.size(); ++b)
      for_each_vertex(level.grid.coord(b), [&](Vec3i v, int) { dual.counts[v] = level.box.is_free(v); });
  }
  return dual;
}

struct Case {
  std::string shape;
  double density;
  double lambda;
  double noise_vox;
  Norm norm = Norm::isotropic;
  Border outside = Border::air;
  int levels = 0;
};

void PrintTo(const Case& c, std::ostream* out) {
  *out << c.shape << " with " << c.density << " samples per voxel^2, lambda " << c.lambda << ", noise " << c.noise_vox
       << (c.norm == Norm::isotropic ? "" : ", anisotropic") << ", outside: " << name_of(c.outside);
}

/// A sheet that ends where the box does.
void cut_in_half(PointCloud& cloud) {
  const Vec3d middle = cloud.box().center();
  std::vector<bool> keep(cloud.size());
  for (size_t i = 0; i < keep.size(); ++i) keep[i] = cloud.positions[i].x > middle.x;
  cloud.filter(keep);
}

class Certificate : public testing::TestWithParam<Case> {
 protected:
  static KeptPyramid solved(const Case& c) {
    constexpr int resolution = 60;
    PointCloud cloud = sampled(c.shape, resolution, c.density);
    add_noise(cloud, c.noise_vox / (resolution - 12), 3);
    if (c.outside == Border::solid)
      for (Vec3f& n : cloud.normals) n = -n;
    if (c.outside == Border::open) cut_in_half(cloud);
    Lattice lattice = lattice_of(cloud, resolution);
    if (c.levels > 0) lattice = place_lattice(cloud.box(), lattice.voxel, lattice.padding, c.levels);
    Problem problem = make_problem(cloud, lattice);
    problem.lattice.open = c.outside == Border::open;
    return solve_and_keep(problem, c.lambda, c.norm);
  }

  const KeptPyramid pyramid = solved(GetParam());
  const Level& level = pyramid.levels[0];
  const WholeDual dual = whole_dual(pyramid);
  const Dense<double> f = dense_field(pyramid.data[0], level.box);
};

TEST_P(Certificate, DualIsFeasibleOnTheWholeGrid) {
  ASSERT_LT(level.grid.vertices(), 0.9 * static_cast<double>(f.values().size())) << "little is outside the band";
  double longest = 0;
  f.for_each([&](Vec3i v) { longest = std::max(longest, dual_length(vector_at(dual.p, v), level.norm)); });
  EXPECT_LE(longest, level.lambda * (1 + 1e-6));
  EXPECT_GT(longest, level.lambda * 0.9);
  if (level.box.open) {
    EXPECT_EQ(flux_beyond_border(dual.p, level.box), 0);
  }
}

TEST_P(Certificate, DualBoundIsTheOneOfTheWholeGrid) {
  const Energies e = evaluate_energy(level, {}, one_thread);
  const double same = dual_energy(dual.p, f, [&](Vec3i v) { return dual.counts[v] != 0; });
  EXPECT_NEAR(e.dual, same, 1e-9 * std::abs(same));
  // Without the terms that the sparse sum counts too many, the bound is no worse and hardly better.
  const double whole = dual_energy(dual.p, f, [&](Vec3i v) { return level.box.is_free(v); });
  EXPECT_LE(e.dual, whole + 1e-9 * std::abs(whole));
  EXPECT_NEAR(e.dual, whole, 1e-4 * std::abs(whole));
}

TEST_P(Certificate, DataLeftOutCostNoMoreThanIsAllowed) {
  const Level& coarse = pyramid.levels[1];
  const auto band_with = [&](double allowed) {
    return choose_band(coarse, level.box, pyramid.data[0], allowed, one_thread);
  };
  const auto gap_with = [&](double allowed) {
    return prolong_level(coarse, level.box, band_with(allowed), pyramid.data[0], one_thread).outside.gap;
  };
  constexpr double all = 1e9;
  const BrickMask narrow = band_with(all), wide = band_with(-1);
  EXPECT_LT(narrow.count(), wide.count());
  narrow.for_each([&](Vec3i b) { EXPECT_TRUE(wide.test(b)); });
  for (size_t b = 0; b < pyramid.data[0].grid.size(); ++b) EXPECT_TRUE(wide.test(pyramid.data[0].grid.coord(b)));
  // What is allowed is used, to the grain of a brick.
  const double none = gap_with(-1);
  for (const double allowed : {0.01, 0.1, 1.0}) EXPECT_LE(gap_with(allowed), none + allowed * (1 + 1e-9));
  if (GetParam().outside != Border::solid) {  // else the film lies around all of them
    EXPECT_GT(gap_with(all), none);
  }
}

TEST_P(Certificate, EnergiesAreThoseOfTheWholeGrid) {
  for (const std::optional<float> threshold : {std::optional<float>(), std::optional(0.5f), std::optional(0.2f)}) {
    const Energies e = evaluate_energy(level, {.threshold = threshold, .certify = false}, one_thread);
    const Dense<double> u = dense_u(level, threshold);
    const double primal = level.lambda * total_variation(u, level.norm, level.box) - inner_product(f, u);
    EXPECT_NEAR(e.primal, primal, 1e-9 * std::abs(primal));
    EXPECT_GE(e.primal, e.dual);
    // The sum of local terms is the difference but for the terms counted too many, which are in D alone or in both.
    EXPECT_NEAR(e.gap, e.primal - e.dual, 1e-4 * std::abs(e.primal));
  }
}

TEST_P(Certificate, CertifiedBoundHoldsForTheRescaledDual) {
  const Energies e = evaluate_energy(level, {.threshold = {}, .certify = true}, one_thread);
  double longest = 0;
  f.for_each([&](Vec3i v) { longest = std::max(longest, dual_length(vector_at(dual.p, v), level.norm)); });
  WholeDual scaled = dual;
  const double m = std::max(1.0, longest / level.lambda);
  for (Dense<double>& component : scaled.p) component.for_each([&](Vec3i v) { component[v] /= m; });
  const double bound = dual_energy(scaled.p, f, [&](Vec3i v) { return level.box.is_free(v); });
  EXPECT_LE(e.dual, bound + 1e-9 * std::abs(bound));
}

INSTANTIATE_TEST_SUITE_P(Shapes, Certificate,
                         testing::Values(Case{"sphere", 1, 0.02, 0}, Case{"torus", 1, 0.01, 0},
                                         Case{"part", 2, 0.02, 0}, Case{"knot", 0.5, 0.01, 0},
                                         Case{"sheets", 1, 0.02, 0.5}, Case{"sphere", 1, 0.02, 0, Norm::anisotropic},
                                         Case{"part", 2, 0.02, 0, Norm::anisotropic},
                                         Case{"sphere", 1, 0.02, 0, Norm::isotropic, Border::solid},
                                         Case{"sphere", 1, 0.02, 0, Norm::isotropic, Border::open},
                                         Case{"part", 2, 0.02, 0.3, Norm::isotropic, Border::open},
                                         Case{"torus", 2, 0.005, 0, Norm::isotropic, Border::open, 5},
                                         Case{"knot", 2, 0.02, 0, Norm::anisotropic, Border::open}),
                         [](const auto& c) {
                           return c.param.shape + (c.param.norm == Norm::isotropic ? "" : "_anisotropic") + "_" +
                                  name_of(c.param.outside);
                         });

}  // namespace TEST_FILE
}  // namespace soapfilm
