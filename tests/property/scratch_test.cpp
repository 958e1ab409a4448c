// Runs whose large arrays are on disk: the mesh is the same, byte for byte, and nothing stays behind.
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <filesystem>
#include <ostream>
#include <string>
#include <vector>

#include "soapfilm/core/context_state.h"
#include "soapfilm/error.h"
#include "soapfilm/reconstruct.h"
#include "support/hash.h"
#include "support/problem.h"
#include "support/process.h"
#include "support/sanitized.h"

namespace soapfilm {
namespace TEST_FILE {

using namespace test;

/// Below what a run in memory needs, above what stays in memory.
constexpr double limited = 0.85;

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

size_t entries(const std::filesystem::path& folder) {
  size_t count = 0;
  for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(folder)) ++count;
  return count;
}

class Scratch : public testing::TestWithParam<OnDisk> {};

TEST_P(Scratch, GivesTheSameMeshOnAnyNumberOfThreads) {
  const OnDisk& c = GetParam();
  const PointCloud cloud = sampled(c.shape, c.resolution, 1);
  Context in_memory(1);
  const Reconstruction expected = reconstruct(cloud, params_of(c), in_memory);
  EXPECT_EQ(pages_of(in_memory).peak_disk_bytes(), 0u);

  const TemporaryFolder folder;
  Context on_disk(c.threads);
  on_disk.set_scratch_folder(folder.path().string());
  on_disk.limit_memory(static_cast<size_t>(limited * static_cast<double>(expected.report.planned_bytes)));
  for (int again = 0; again < 2; ++again) {
    const Reconstruction found = reconstruct(cloud, params_of(c), on_disk);
    EXPECT_EQ(hash_mesh(found.mesh), hash_mesh(expected.mesh));
    EXPECT_GT(pages_of(on_disk).peak_disk_bytes(), size_t{4} << 20) << "too small to say anything";
    EXPECT_LT(found.report.planned_bytes, limited * static_cast<double>(expected.report.planned_bytes));
    EXPECT_EQ(entries(folder.path()), 0u);
  }
  on_disk.limit_memory({});  // the next run is in memory again
  EXPECT_EQ(hash_mesh(reconstruct(cloud, params_of(c), on_disk).mesh), hash_mesh(expected.mesh));
  EXPECT_EQ(pages_of(on_disk).peak_disk_bytes(), 0u);
}

constexpr int vertices = sanitized ? 64 : 112;

INSTANTIATE_TEST_SUITE_P(Shapes, Scratch,
                         testing::Values(OnDisk{"knot", vertices, 1}, OnDisk{"knot", vertices, 2},
                                         OnDisk{"part", vertices, 2}, OnDisk{"torus", 2 * vertices, 2},
                                         OnDisk{"sphere", 48, 2, Method::poisson},
                                         OnDisk{"sphere", 48, 2, Method::tv_sor}));

struct Refusals : testing::Test {
  const PointCloud cloud = sampled("knot", 96, 1);
  ReconstructParams params = [] {
    ReconstructParams p;
    p.place.resolution = 96;
    return p;
  }();

  std::string refusal(const std::string& folder) {
    Context context(1);
    const auto planned = static_cast<double>(reconstruct(cloud, params, context).report.planned_bytes);
    context.set_scratch_folder(folder);
    context.limit_memory(static_cast<size_t>(limited * planned));
    try {
      reconstruct(cloud, params, context);
    } catch (const OutputError& error) {
      return error.what();
    }
    return {};
  }
};
using ScratchRefusals = Refusals;

TEST_F(ScratchRefusals, NameTheFolder) {
  const TemporaryFolder folder;
  const std::string absent = folder.file("absent"), file = folder.file("file");
  EXPECT_NE(refusal(absent).find(absent), std::string::npos);
  std::filesystem::copy("/proc/self/status", file);
  EXPECT_NE(refusal(file).find(file), std::string::npos);
  if (geteuid() == 0) return;  // it may write anywhere
  std::filesystem::permissions(folder.path(), std::filesystem::perms::owner_read);
  EXPECT_NE(refusal(folder.path().string()).find(folder.path().string()), std::string::npos);
  std::filesystem::permissions(folder.path(), std::filesystem::perms::owner_all);
}

TEST_F(ScratchRefusals, OfFilesThatMayNotBeAsLarge) {
  const TemporaryFolder folder;
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
  const rlimit small{size_t{1} << 20, before.rlim_max};
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
  const std::string message = refusal(folder.path().string());
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &before), 0);
  EXPECT_NE(message.find(folder.path().string()), std::string::npos) << message;
  EXPECT_EQ(entries(folder.path()), 0u);
}

/// Without a limit that it would exceed, a run leaves the folder alone: it need not even exist.
TEST(ScratchPlan, WhatFitsStaysInMemory) {
  const PointCloud cloud = sampled("knot", 96, 1);
  ReconstructParams params;
  params.place.resolution = 96;
  Context context(1);
  context.set_scratch_folder("/absent");
  reconstruct(cloud, params, context);
  EXPECT_EQ(pages_of(context).peak_disk_bytes(), 0u);
}

/// What stays in memory must fit there.
TEST(ScratchPlan, RefusesWhatDiskCannotTake) {
  const TemporaryFolder folder;
  const PointCloud cloud = sampled("knot", 96, 1);
  ReconstructParams params;
  params.place.resolution = 96;
  Context context(1);
  context.set_scratch_folder(folder.path().string());
  const auto planned = static_cast<double>(reconstruct(cloud, params, context).report.planned_bytes);
  context.limit_memory(static_cast<size_t>(0.3 * planned));
  EXPECT_THROW(reconstruct(cloud, params, context), MemoryError);
  EXPECT_EQ(entries(folder.path()), 0u);
}

}  // namespace TEST_FILE
}  // namespace soapfilm
