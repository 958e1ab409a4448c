// The sparse certificate against brute force: the dual of every level spread out on the whole fine grid.
#include <gtest/gtest.h>

#include <utility>
#include <vector>

#include "soapfilm/pyramid/band.h"
#include "soapfilm/pyramid/coarse_to_fine.h"
#include "soapfilm/pyramid/prolong.h"
#include "soapfilm/pyramid/restrict.h"
#include "soapfilm/select/border.h"
#include "support/dense.h"
#include "support/problem.h"

namespace soapfilm {
namespace TEST_FILE {

using namespace test;

const Parallel one_thread(1);

constexpr double allowed_outside = 1;  // of the gap, for data that the finest band leaves out
constexpr float flux_kept = 0.8f;      // of a level's, before a finer one but the finest starts from it

/// solve_coarse_to_fine, with every level kept. data[l] and levels[l] belong to level l; the flux of levels 2 and up is
/// scaled by then.
struct KeptPyramid {
  std::vector<SupportField> data;
  std::vector<Level> levels;
};

KeptPyramid solve_and_keep(const Problem& problem, double lambda, Norm norm) {
  const PrimalDualParams params;
  const Lattice& lattice = problem.lattice;
  KeptPyramid kept;
  const auto count = static_cast<size_t>(lattice.levels);
  kept.data.resize(count);
  kept.levels.resize(count);
  kept.data[0] = divergence_field(problem.samples, lattice.box(0), one_thread);
  for (size_t l = 1; l < count; ++l)
    kept.data[l] = restrict_field(kept.data[l - 1], lattice.box(static_cast<int>(l)), one_thread);

  Progress progress;
  for (size_t l = count; l-- > 0;) {
    const LevelBox box = lattice.box(static_cast<int>(l));
    Level& level = kept.levels[l];
    if (l + 1 == count) {
      const double scale = std::pow(4.0, static_cast<double>(l));
      level = make_level(box, static_cast<float>(lambda * scale), BrickMask::whole(box.bricks), kept.data[l].grid,
                         kept.data[l].f, one_thread, norm);
      solve_primal_dual(level, params, one_thread, progress);
      continue;
    }
    Level& coarse = kept.levels[l + 1];
    if (l > 0) scale_flux(coarse, flux_kept, one_thread);
    BrickMask band = choose_band(coarse, box, kept.data[l], allowed_outside, one_thread);
    level = prolong_level(coarse, box, band, kept.data[l], one_thread);
    solve_primal_dual(level, params, one_thread, progress);
    for (BrickMask grown = growth(level, coarse.grid, Parallel(2)); grown.count() > 0;
         grown = growth(level, coarse.grid, Parallel(2))) {
      band |= grown;
      level = prolong_level(coarse, box, band, kept.data[l], one_thread, std::move(level));
      solve_primal_dual(level, params, one_thread, progress);
    }
  }
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
    if (l > 1)
      for (Dense<double>& p : dual.p) p.for_each([&](Vec3i v) { p[v] *= flux_kept; });
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
  const Vec3d middle = cloud.box().centre();
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
