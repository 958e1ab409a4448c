// Ranks that share the border's trials decide alike, and as one process.
#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <string>
#include <tuple>

#include "soapfilm/border/border.h"
#include "support/problem.h"
#include "support/thread_ranks.h"

namespace soapfilm::test {
namespace TEST_FILE {

struct BorderCase {
  std::string name;
  PointCloud cloud;
  Border chosen;
};

PointCloud reversed_sphere(int resolution) {
  PointCloud cloud = sampled("sphere", resolution, 1);
  for (Vec3f& n : cloud.normals) n = -n;
  return cloud;
}

/// A flat square, seen from above.
PointCloud sheet() {
  Random random(5);
  PointCloud cloud;
  for (int i = 0; i < 9000; ++i) {
    cloud.positions.push_back({random.uniform(), random.uniform(), 0.02 * random.uniform()});
    cloud.normals.push_back({0, 0, 1});
  }
  cloud.scans.push_back({"sheet", 0, cloud.size(), {}, {}, {}});
  return cloud;
}

TEST(BorderOnRanks, IsThatOfOneProcess) {
  constexpr int resolution = sanitized ? 64 : 96;
  for (const BorderCase& c : {BorderCase{"sphere", sampled("sphere", resolution, 1), Border::air},
                              BorderCase{"reversed", reversed_sphere(resolution), Border::solid},
                              BorderCase{"sheet", sheet(), Border::open}}) {
    const Lattice lattice = lattice_of(c.cloud, resolution);
    const Problem same = make_problem(c.cloud, lattice);
    using Outcome = std::tuple<Border, std::string, std::optional<double>, std::optional<double>, std::optional<double>,
                               std::optional<double>, double, double, int, bool>;
    const auto run = [&](const Context& context) -> Outcome {
      Problem problem = make_problem(c.cloud, lattice);
      const BorderReport found =
          choose_border({lattice, problem.support, 0.02, Norm::isotropic, 1, lattice.voxel}, {}, {}, {}, context);
      EXPECT_EQ(found.chosen, c.chosen) << c.name << ": " << found.reason;
      bool restored = true;
      for (size_t b = 0; b < same.support.grid.size(); ++b)
        restored = restored && std::equal(same.support.f.brick(b), same.support.f.brick(b) + brick_volume,
                                          problem.support.f.brick(b));
      EXPECT_TRUE(restored) << c.name;
      return {found.chosen,     found.reason,    found.air,     found.solid, found.open,
              found.open_bound, found.area_cost, found.closing, found.level, found.ends};
    };
    expect_same_on_ranks<Outcome>(run);
  }
}

}  // namespace TEST_FILE
}  // namespace soapfilm::test
