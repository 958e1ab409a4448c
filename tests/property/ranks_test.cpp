// Runs on several ranks: the mesh and the report are those of one process.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <ostream>
#include <string>

#include "soapfilm/reconstruct.h"
#include "soapfilm/report.h"
#include "support/hash.h"
#include "support/problem.h"
#include "support/sanitized.h"
#include "support/thread_ranks.h"

namespace soapfilm {
namespace TEST_FILE {

using namespace test;

struct OnRanks {
  std::string name, shape;
  int resolution;
  double noise;  ///< voxels
  ReconstructParams params{};
};
void PrintTo(const OnRanks& c, std::ostream* out) { *out << c.name; }

std::vector<OnRanks> cases() {
  std::vector<OnRanks> all;
  all.push_back({"clean", "torus", sanitized ? 40 : 80, 0});
  all.push_back({"noisy", "knot", sanitized ? 36 : 72, 0.25});
  all.back().params.surface.gap = true;
  all.push_back({"anisotropic", "plate", sanitized ? 40 : 90, 0.1});
  all.back().params.energy.norm = Norm::anisotropic;
  all.push_back({"open", "sphere", sanitized ? 36 : 60, 0.1});
  all.back().params.border.outside = Border::open;
  all.push_back({"volumes", "sphere", sanitized ? 30 : 48, 0.1});
  all.back().params.surface.volume_interval = 1e-3;
  for (OnRanks& c : all) c.params.place.resolution = c.resolution;
  return all;
}

/// What a run gives, but for what differs from run to run.
struct Outcome {
  uint64_t mesh = 0;
  std::string report;
  bool operator==(const Outcome&) const = default;
};

Outcome outcome_of(const PointCloud& cloud, const ReconstructParams& params, const Context& context) {
  const Reconstruction found = reconstruct(cloud, params, context);
  if (found.mesh.triangles.empty()) return {};  // of a rank whose work is done
  auto json = nlohmann::json::parse(to_json(found.report));
  for (const char* key : {"seconds", "cpu_seconds", "memory", "ranks"}) json.erase(key);
  return {hash_mesh(found.mesh), json.dump()};
}

class RunOnRanks : public testing::TestWithParam<OnRanks> {};

TEST_P(RunOnRanks, GivesTheBytesOfOneProcess) {
  PointCloud cloud = sampled(GetParam().shape, GetParam().resolution, 1.5);
  if (GetParam().noise > 0) add_noise(cloud, GetParam().noise / (GetParam().resolution - 12), 1);
  const auto run_it = [&](const Context& context) { return outcome_of(cloud, GetParam().params, context); };
  const Outcome alone = run_it(Context(1));
  ASSERT_NE(alone.mesh, 0u);
  struct Group {
    int count, threads;
    Cuts cuts;
  };
  for (const Group& group : {Group{2, 1, {}}, Group{3, 2, {}}, Group{4, 1, {7}}, Group{7, 1, {8}}, Group{2, 1, {9}}}) {
    const std::vector<Outcome> found = on_ranks<Outcome>(group.count, group.threads, group.cuts, run_it);
    EXPECT_EQ(found[0], alone) << group.count << " ranks, cuts " << group.cuts.seed;
    for (size_t r = 1; r < found.size(); ++r) EXPECT_EQ(found[r].mesh, 0u) << "rank 0 alone makes the mesh";
  }
}

INSTANTIATE_TEST_SUITE_P(Cases, RunOnRanks, testing::ValuesIn(cases()),
                         [](const testing::TestParamInfo<OnRanks>& info) { return info.param.name; });

}  // namespace TEST_FILE
}  // namespace soapfilm
