// Runs whose large arrays are on disk: the mesh is the same, byte for byte, and nothing stays behind.
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <ostream>
#include <string>

#include "soapfilm/core/context_state.h"
#include "soapfilm/error.h"
#include "soapfilm/platform/scratch.h"
#include "soapfilm/reconstruct.h"
#include "support/hash.h"
#include "support/problem.h"
#include "support/process.h"

namespace soapfilm {
namespace TEST_FILE {

using namespace test;

/// Below what a run in memory needs, above what stays in memory: where vectors of samples and triangles stay, and where
/// the program moves them, too.
constexpr double with_vectors = 0.93, without_vectors = 0.75;

struct OnDisk {
  std::string shape;
  int resolution, threads;
  Method method = Method::tv;
};
void PrintTo(const OnDisk& c, std::ostream* out) { *out << c.shape << ' ' << c.resolution << ", " << c.threads; }

ReconstructParams params_of(const OnDisk& c) {
  ReconstructParams params;
  params.method = c.method;
  params.place.resolution = c.resolution;
  return params;
}

void expect_same_mesh(const OnDisk& c) {
  const PointCloud cloud = sampled(c.shape, c.resolution, 1);
  Context in_memory(1);
  const Reconstruction expected = reconstruct(cloud, params_of(c), in_memory);
  EXPECT_EQ(pages_of(in_memory).peak_disk_bytes(), 0u);

  const test::TemporaryFolder folder;
  Context on_disk(c.threads);
  on_disk.set_scratch_folder(folder.path().string());
  on_disk.state().move_vectors = [](const std::string&) {};  // planned as in the program
  on_disk.limit_memory(static_cast<size_t>(without_vectors * static_cast<double>(expected.report.planned_bytes)));
  for (int again = 0; again < 2; ++again) {
    const Reconstruction found = reconstruct(cloud, params_of(c), on_disk);
    EXPECT_EQ(hash_mesh(found.mesh), hash_mesh(expected.mesh));
    EXPECT_GT(pages_of(on_disk).peak_disk_bytes(), size_t{4} << 20) << "too small to say anything";
    EXPECT_LT(static_cast<double>(found.report.planned_bytes),
              without_vectors * static_cast<double>(expected.report.planned_bytes));
    EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
  }
  on_disk.limit_memory({});  // the next run is in memory again
  EXPECT_EQ(hash_mesh(reconstruct(cloud, params_of(c), on_disk).mesh), hash_mesh(expected.mesh));
  EXPECT_EQ(pages_of(on_disk).peak_disk_bytes(), 0u);
}

TEST(Scratch, GivesTheSameMeshOnTwoThreads) {
  if (!has_scratch_files()) GTEST_SKIP();
  expect_same_mesh({"knot", 152, 2});
}

/// The check's memory is planned once the surface is known: what is there by then stays in memory, the rest is on disk.
TEST(Scratch, TakesARunThatTurnsOutToNeedMore) {
  if (!has_scratch_files()) GTEST_SKIP();
  const PointCloud cloud = sampled("knot", 152, 1);
  ReconstructParams params = params_of({"knot", 152, 1});
  params.checked = true;
  const Reconstruction expected = reconstruct(cloud, params, Context(1));
  const test::TemporaryFolder folder;
  Context on_disk(1);
  on_disk.limit_memory(static_cast<size_t>(0.98 * static_cast<double>(expected.report.planned_bytes)));
  EXPECT_THROW(reconstruct(cloud, params, on_disk), MemoryError);
  on_disk.set_scratch_folder(folder.path().string());
  on_disk.state().move_vectors = [](const std::string&) {};
  EXPECT_EQ(hash_mesh(reconstruct(cloud, params, on_disk).mesh), hash_mesh(expected.mesh));
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

class ScratchOf : public testing::TestWithParam<OnDisk> {};
TEST_P(ScratchOf, GivesTheSameMeshSlow) { expect_same_mesh(GetParam()); }

INSTANTIATE_TEST_SUITE_P(Shapes, ScratchOf,
                         testing::Values(OnDisk{"knot", 224, 1}, OnDisk{"part", 192, 2}, OnDisk{"torus", 224, 1},
                                         OnDisk{"torus", 224, 3}, OnDisk{"sphere", 160, 2, Method::poisson},
                                         OnDisk{"sphere", 128, 2, Method::tv_sor}));

struct ScratchRefusals : testing::Test {
  void SetUp() override {
    if (!has_scratch_files()) GTEST_SKIP();
  }
  const PointCloud cloud = sampled("knot", 152, 1);
  ReconstructParams params = [] {
    ReconstructParams p;
    p.place.resolution = 152;
    return p;
  }();

  std::string refusal(const std::string& folder) {
    Context context(1);
    const auto planned = static_cast<double>(reconstruct(cloud, params, context).report.planned_bytes);
    context.set_scratch_folder(folder);
    context.limit_memory(static_cast<size_t>(with_vectors * planned));
    try {
      reconstruct(cloud, params, context);
    } catch (const OutputError& error) {
      return error.what();
    }
    return {};
  }
};

/// The library alone.
TEST_F(ScratchRefusals, AreNoneWhereTheDiskHasRoom) {
  const test::TemporaryFolder folder;
  EXPECT_EQ(refusal(folder.path().string()), "");
}

TEST_F(ScratchRefusals, NameTheFolder) {
  const test::TemporaryFolder folder;
  const std::string absent = folder.file("absent"), file = folder.file("file");
  EXPECT_NE(refusal(absent).find(absent), std::string::npos);
  std::ofstream(file) << "no folder";
  EXPECT_NE(refusal(file).find(file), std::string::npos);
  if (geteuid() == 0) return;  // it may write anywhere
  std::filesystem::permissions(folder.path(), std::filesystem::perms::owner_read);
  EXPECT_NE(refusal(folder.path().string()).find(folder.path().string()), std::string::npos);
  std::filesystem::permissions(folder.path(), std::filesystem::perms::owner_all);
}

TEST_F(ScratchRefusals, OfFilesThatMayNotBeAsLarge) {
  const test::TemporaryFolder folder;
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
  const rlimit small{size_t{1} << 20, before.rlim_max};
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
  const std::string message = refusal(folder.path().string());
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &before), 0);
  EXPECT_NE(message.find(folder.path().string()), std::string::npos) << message;
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

/// Without a limit that it would exceed, a run leaves the folder alone: it need not even exist.
TEST(ScratchPlan, WhatFitsStaysInMemory) {
  const PointCloud cloud = sampled("knot", 152, 1);
  ReconstructParams params;
  params.place.resolution = 152;
  Context context(1);
  context.set_scratch_folder("/absent");
  reconstruct(cloud, params, context);
  EXPECT_EQ(pages_of(context).peak_disk_bytes(), 0u);
}

/// What stays in memory must fit there.
TEST(ScratchPlan, RefusesWhatDiskCannotTake) {
  if (!has_scratch_files()) GTEST_SKIP();
  const test::TemporaryFolder folder;
  const PointCloud cloud = sampled("knot", 152, 1);
  ReconstructParams params;
  params.place.resolution = 152;
  Context context(1);
  context.set_scratch_folder(folder.path().string());
  const auto planned = static_cast<double>(reconstruct(cloud, params, context).report.planned_bytes);
  context.limit_memory(static_cast<size_t>(0.3 * planned));
  EXPECT_THROW(reconstruct(cloud, params, context), MemoryError);
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

}  // namespace TEST_FILE
}  // namespace soapfilm
