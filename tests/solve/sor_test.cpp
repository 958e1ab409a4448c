// SOR against equation (8) written out in double, and the properties that its fast form must keep.
#include "soapfilm/solve/sor.h"

#include <gtest/gtest.h>

#include "soapfilm/error.h"
#include "soapfilm/solve/energy.h"
#include "support/back_ends.h"
#include "support/dense.h"
#include "support/hash.h"
#include "support/problem.h"

namespace soapfilm {
namespace TEST_FILE {

using namespace test;

constexpr double lambda = 0.01;
const Context one_thread(1);

/// A single level.
Problem tiny_problem(const std::string& shape, int resolution) {
  const PointCloud cloud = sampled(shape, resolution, 1);
  return make_problem(cloud, place_lattice(cloud.box(), voxel_of_resolution(cloud.box(), resolution, 6), 6, 1));
}

/// Boxes just too narrow for a whole run along each axis in turn, and just wide enough.
std::vector<Problem> narrow_problems() {
  std::vector<Problem> problems;
  for (int axis = 0; axis < 3; ++axis)
    for (const double width : {0.5, 2.0, 4.0, 5.0, 6.0}) {
      PointCloud cloud = sampled("part", 24, 2);
      Box3d box = cloud.box();
      for (Vec3d& p : cloud.positions)
        p[axis] = box.center()[axis] + (p - box.center())[axis] * width / 12 / box.size()[axis] * box.longest();
      problems.push_back(make_problem(cloud, place_lattice(cloud.box(), box.longest() / 12, 2, 1)));
    }
  return problems;
}

/// Equation (8) vertex by vertex, g for the whole box, everything in double.
class Reference {
 public:
  Reference(const LevelBox& box, const SupportField& support, const SorParams& params)
      : box_(box), params_(params), f_(dense_field(support, box)), u_(f_.size() + fixed_layer), g_(u_.size()) {}

  void run(int iterations) {
    for (int k = 0; k < iterations; ++k) {
      energy_.push_back(energy());
      if (k % params_.renew_every == 0) renew();
      if (params_.order == SorOrder::lexicographic) {
        u_.for_each([&](Vec3i v) { relax(v); });
      } else {
        // Counted from the corner of the fixed layer, like the box's array.
        const Vec3i corner = box_.free_lo - Vec3i{1, 1, 1};
        for (int parity = 0; parity < 2; ++parity)
          u_.for_each([&](Vec3i v) {
            const Vec3i d = v - corner;
            if ((d.x + d.y + d.z) % 2 == parity) relax(v);
          });
      }
    }
    energy_.push_back(energy());
  }

  const Dense<double>& u() const { return u_; }
  const std::vector<double>& energies() const { return energy_; }

 private:
  /// The upper vertex may be beyond the last brick; its diffusivity counts.
  static constexpr Vec3i fixed_layer{1, 1, 1};

  double energy() const {
    double sum = lambda * total_variation(u_);
    f_.for_each([&](Vec3i v) { sum -= f_[v] * u_[v]; });
    return sum;
  }

  void renew() {
    u_.for_each([&](Vec3i v) {
      double squared = params_.epsilon * params_.epsilon;
      for (int axis = 0; axis < 3; ++axis) {
        const double up = u_.get(v + along(axis));
        const double d = params_.gradient == SorGradient::central ? (up - u_.get(v - along(axis))) / 2 : up - u_[v];
        squared += d * d;
      }
      g_[v] = 1 / std::sqrt(squared);
    });
  }

  void relax(Vec3i v) {
    if (!box_.is_free(v)) return;
    double weighted = f_.get(v), weights = 0;
    for (int axis = 0; axis < 3; ++axis)
      for (const Vec3i j : {v - along(axis), v + along(axis)}) {
        const double g = (g_[v] + g_.get(j, 1 / params_.epsilon)) / 2;
        weighted += lambda * g * u_.get(j);
        weights += lambda * g;
      }
    const double u = (1 - params_.omega) * u_[v] + params_.omega * weighted / weights;
    u_[v] = u < params_.snap ? 0 : u > 1 - params_.snap ? 1 : u;
  }

  LevelBox box_;
  SorParams params_;
  Dense<double> f_, u_, g_;
  std::vector<double> energy_;
};

struct Case {
  std::string name;
  SorOrder order = SorOrder::lexicographic;
  SorGradient gradient = SorGradient::central;
  int renew_every = 2;
  double snap = 1e-6;
};
void PrintTo(const Case& c, std::ostream* out) { *out << c.name; }

SorParams params_of(const Case& c, int iterations) {
  SorParams params;
  params.order = c.order;
  params.gradient = c.gradient;
  params.renew_every = c.renew_every;
  params.snap = c.snap;
  params.max_iterations = iterations;
  params.tolerance = 0;
  return params;
}

const std::vector<Case> cases = {
    {"lexicographic"},
    {"red_black", SorOrder::red_black},
    {"forward", SorOrder::lexicographic, SorGradient::forward},
    {"renewed_always", SorOrder::lexicographic, SorGradient::central, 1},
    {"renewed_rarely", SorOrder::lexicographic, SorGradient::central, 5},
    {"red_black_renewed_rarely", SorOrder::red_black, SorGradient::forward, 5},
    {"without_snap", SorOrder::lexicographic, SorGradient::central, 2, 0},
    {"red_black_without_snap", SorOrder::red_black, SorGradient::central, 2, 0},
};

class SorEquation : public testing::TestWithParam<Case> {};

TEST_P(SorEquation, IsFollowedVertexByVertex) {
  constexpr int iterations = 12;
  const SorParams params = params_of(GetParam(), iterations);
  std::vector<Problem> problems = narrow_problems();
  problems.push_back(tiny_problem("part", 27));
  problems.push_back(tiny_problem("torus", 22));
  for (const Problem& problem : problems) {
    const Vec3i n = problem.lattice.size;
    SCOPED_TRACE(testing::Message() << n.x << " x " << n.y << " x " << n.z);
    const LevelBox box = problem.lattice.box(0);
    Reference reference(box, problem.support, params);
    reference.run(iterations);

    DenseField<float> u(box);
    const SorLevelReport report = relax_sor(u, box, lambda, problem.support, params, one_thread);
    EXPECT_EQ(report.iterations, iterations);
    ASSERT_EQ(report.energy.size(), reference.energies().size());
    ASSERT_EQ(report.seconds.size(), report.energy.size());
    for (size_t k = 0; k < report.energy.size(); ++k)
      EXPECT_NEAR(report.energy[k], reference.energies()[k], 1e-5 * std::abs(reference.energies()[k]))
          << k << " iterations";
    double largest = 0, top = 0;
    reference.u().for_each([&](Vec3i v) {
      largest = std::max(largest, std::abs(reference.u()[v] - double{u.get(v)}));
      top = std::max(top, reference.u()[v]);
    });
    EXPECT_GT(top, 0.1) << "nothing has moved";
    EXPECT_LT(largest, 2e-4);
  }
}

TEST_P(SorEquation, GivesTheSameBytesWhenEmptyRunsAreSkipped) {
  const Problem problem = tiny_problem("torus", 64);
  const LevelBox box = problem.lattice.box(0);
  SorParams params = params_of(GetParam(), 30);
  uint64_t hash[2];
  std::vector<double> energy[2];
  for (const bool skip : {false, true}) {
    params.skip_empty = skip;
    DenseField<float> u(box);
    energy[skip] = relax_sor(u, box, lambda, problem.support, params, one_thread).energy;
    hash[skip] = hash_bytes(std::span<const float>(u.data(), u.count()));
  }
  EXPECT_EQ(hash[0], hash[1]);
  EXPECT_EQ(energy[0], energy[1]);
}

INSTANTIATE_TEST_SUITE_P(Variants, SorEquation, testing::ValuesIn(cases), [](const auto& c) { return c.param.name; });

class SorBackEnds : public testing::TestWithParam<BackEnd> {};

TEST_P(SorBackEnds, GiveTheSameBytes) {
  const Problem problem = tiny_problem("part", 45);
  const LevelBox box = problem.lattice.box(0);
  const auto outcome = [&](SorOrder order, const Context& context) {
    SorParams params;
    params.order = order;
    params.max_iterations = 21;
    DenseField<float> u(box);
    const SorLevelReport report = relax_sor(u, box, lambda, problem.support, params, context);
    const Level level = sor_level(u, box, lambda, problem.support, params, context);
    const uint64_t p = hash_bytes(std::span<const float>(level.p.brick(0), 3 * level.grid.vertices()));
    return std::tuple(hash_bytes(std::span<const float>(u.data(), u.count())), report.energy, p);
  };
  for (const SorOrder order : {SorOrder::lexicographic, SorOrder::red_black}) {
    const auto expected = outcome(order, one_thread);
    EXPECT_EQ(outcome(order, context_on(GetParam())), expected);
  }
}

INSTANTIATE_TEST_SUITE_P(Targets, SorBackEnds, testing::ValuesIn(back_ends()), back_end_name);

TEST(Sor, StopsWhenTheEnergyHoldsStill) {
  const Problem problem = tiny_problem("sphere", 40);
  const LevelBox box = problem.lattice.box(0);
  DenseField<float> u(box);
  SorParams params;
  params.max_iterations = 2000;
  const SorLevelReport report = relax_sor(u, box, lambda, problem.support, params, one_thread);
  EXPECT_TRUE(report.converged);
  EXPECT_LT(report.iterations, params.max_iterations);
  const double last = report.energy.back(), before = report.energy[report.energy.size() - 3];
  EXPECT_LE(std::abs(last - before), 1e-6 * std::abs(last));

  // evaluate_energy() gives the same energy, and the implied dual has the right sign: its bound is near.
  const Level level = sor_level(u, box, lambda, problem.support, params, one_thread);
  const Energies energies = evaluate_energy(level, {.threshold = {}, .certify = true}, one_thread);
  EXPECT_NEAR(energies.primal, last, 1e-6 * std::abs(last));
  EXPECT_LE(energies.max_dual_norm, 1 + 1e-6);
  EXPECT_GE(energies.primal, energies.dual);
  EXPECT_LT(energies.relative_gap(lambda), 1e-2);
  EXPECT_NEAR(energies.gap, energies.primal - energies.dual, 1e-6 * std::abs(last));
}

TEST(Sor, LeavesNothingWhereNothingWasSampled) {
  const Problem problem = tiny_problem("sphere", 24);
  const LevelBox box = problem.lattice.box(0);
  SupportField nothing{problem.support.grid, Field<float>(problem.support.grid)};
  DenseField<float> u(box);
  const SorLevelReport report = relax_sor(u, box, lambda, nothing, {}, one_thread);
  EXPECT_TRUE(report.converged);
  EXPECT_EQ(report.energy.back(), 0);
  for (size_t i = 0; i < u.count(); ++i) ASSERT_EQ(u.data()[i], 0);
}

TEST(Sor, KeepsTheAxesEqual) {
  // x -> y -> z -> x. The two colors have the same neighbors; the sums round in another order.
  const PointCloud cloud = sampled("part", 40, 1);
  const PointCloud turned = transformed(
      cloud,
      [](Vec3d p) {
        return Vec3d{p.z, p.x, p.y};
      },
      [](Vec3f n) {
        return Vec3f{n.z, n.x, n.y};
      });
  const Problem problem = make_problem(cloud, unturned(lattice_of(cloud, 40))),
                turned_problem = make_problem(turned, unturned(lattice_of(turned, 40)));
  SorParams params;
  params.order = SorOrder::red_black;
  params.max_iterations = 40;
  const auto solution = [&](const Problem& p) {
    DenseField<float> u(p.lattice.box(0));
    relax_sor(u, p.lattice.box(0), lambda, p.support, params, one_thread);
    return u;
  };
  const DenseField<float> u = solution(problem), v = solution(turned_problem);
  ASSERT_EQ(v.size(), (Vec3i{u.size().z, u.size().x, u.size().y}));
  double largest = 0;
  for (int z = 0; z < u.size().z; ++z)
    for (int y = 0; y < u.size().y; ++y)
      for (int x = 0; x < u.size().x; ++x)
        largest = std::max(largest, std::abs(double{u.row(y, z)[x]} - double{v.row(x, y)[z]}));
  EXPECT_LT(largest, 1e-3);
}

TEST(Sor, MirrorsASymmetricSphere) {
  // A few samples and their images under all symmetries of the cube; the grid's center is the cube's.
  const PointCloud seed = sample_surface(*make_shape("sphere"), 60, 3);
  const Vec3d center = make_shape("sphere")->box().center();
  PointCloud cloud;
  constexpr int orders[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}};
  for (size_t i = 0; i < seed.size(); ++i)
    for (const auto& order : orders)
      for (int signs = 0; signs < 8; ++signs) {
        Vec3d position, normal;
        for (int axis = 0; axis < 3; ++axis) {
          const double sign = (signs >> axis) & 1 ? -1 : 1;
          position[axis] = center[axis] + sign * (seed.positions[i] - center)[order[axis]];
          normal[axis] = sign * Vec3d(seed.normals[i])[order[axis]];
        }
        cloud.positions.push_back(position);
        cloud.normals.push_back(Vec3f(normal));
      }
  const Problem problem = make_problem(cloud, 40);
  const LevelBox box = problem.lattice.box(0);
  DenseField<float> u(box);
  SorParams params;
  params.tolerance = 0;
  params.max_iterations = 1000;
  relax_sor(u, box, lambda, problem.support, params, one_thread);
  const Vec3i last = u.size() - Vec3i{1, 1, 1};
  ASSERT_EQ(u.size().x, u.size().y);
  ASSERT_EQ(u.size().x, u.size().z);
  double largest = 0, top = 0;
  for (int z = 0; z <= last.z; ++z)
    for (int y = 0; y <= last.y; ++y)
      for (int x = 0; x <= last.x; ++x) {
        const double value = u.row(y, z)[x];
        top = std::max(top, value);
        largest = std::max({largest, std::abs(value - double{u.row(y, z)[last.x - x]}),
                            std::abs(value - double{u.row(last.y - y, last.z - z)[x]}),
                            std::abs(value - double{u.row(x, y)[z]})});
      }
  EXPECT_GT(top, 0.99);
  EXPECT_LT(largest, 2e-3);
}

TEST(Sor, RefusesParametersOutOfRange) {
  const auto message = [](auto&& change) -> std::string {
    SorParams params;
    change(params);
    try {
      validate(params);
    } catch (const ParameterError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(message([](SorParams&) {}), "");
  EXPECT_EQ(message([](SorParams& p) { p.omega = 2; }), "omega = 2, must be > 0 and < 2");
  EXPECT_EQ(message([](SorParams& p) { p.epsilon = 0; }), "epsilon = 0, must be > 0");
  EXPECT_EQ(message([](SorParams& p) { p.renew_every = 0; }), "renew_every = 0, must be >= 1");
  EXPECT_EQ(message([](SorParams& p) { p.levels = 0; }), "levels = 0, must be >= 1");
  EXPECT_EQ(message([](SorParams& p) { p.tolerance = -1; }), "tolerance = -1, must be >= 0");
  EXPECT_EQ(message([](SorParams& p) { p.max_iterations = 0; }), "max_iterations = 0, must be >= 1");
  EXPECT_EQ(message([](SorParams& p) { p.snap = 0.5; }), "snap = 0.5, must be >= 0 and < 0.5");
}

}  // namespace TEST_FILE
}  // namespace soapfilm
