// Runs in one process share nothing: each context has its own threads, SIMD target, progress, pages and limits.
#include <gtest/gtest.h>

#include <ctime>
#include <exception>
#include <filesystem>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "property/each_method.h"
#include "soapfilm/core/context_state.h"
#include "soapfilm/error.h"
#include "soapfilm/platform/memory.h"
#include "soapfilm/reconstruct.h"
#include "support/back_ends.h"
#include "support/hash.h"
#include "support/problem.h"
#include "support/sanitized.h"

namespace soapfilm {
namespace TEST_FILE {

using namespace test;

constexpr int vertices = sanitized ? 24 : 96;

struct Task {
  PointCloud cloud;
  ReconstructParams params;
  BackEnd back_end;
  std::optional<size_t> memory_limit{};
};

std::vector<Task> different_runs() {
  const std::vector<std::string> targets = simd_targets();
  std::vector<Task> runs = {{sampled("knot", vertices, 1), {}, {targets.front(), 2}, {}},
                            {sampled("torus", vertices, 2), {}, {targets.back(), 1}, {}},
                            {sampled("part", vertices, 1), {}, {targets[targets.size() / 2], 3}, {}}};
  for (Task& run : runs) run.params.place.resolution = vertices;
  runs[1].memory_limit = size_t{1} << 30;
  return runs;
}

Reconstruction result_of(const Task& run) {
  Context context = context_on(run.back_end);
  context.limit_memory(run.memory_limit);
  return reconstruct(run.cloud, run.params, context);
}

double cpu_seconds(const ReconstructReport& report) {
  double sum = 0;
  for (const StageTime& stage : report.stages) sum += stage.cpu;
  return sum;
}

TEST(Contexts, RunsOnThreadsOfTheirOwnGiveWhatEachGivesAlone) {
  const std::vector<Task> runs = different_runs();
  std::vector<Reconstruction> alone, at_once(runs.size());
  for (const Task& run : runs) alone.push_back(result_of(run));
  const std::clock_t begin = std::clock();
  {
    std::vector<std::jthread> threads;
    for (size_t k = 0; k < runs.size(); ++k) threads.emplace_back([&, k] { at_once[k] = result_of(runs[k]); });
  }
  const double process = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
  double sum = 0;
  for (size_t k = 0; k < runs.size(); ++k) {
    EXPECT_EQ(hash_mesh(at_once[k].mesh), hash_mesh(alone[k].mesh)) << k;
    EXPECT_EQ(at_once[k].report.certificate.binary.dual, alone[k].report.certificate.binary.dual) << k;
    // Each counts only the arrays of its own run.
    EXPECT_EQ(at_once[k].report.array_bytes, alone[k].report.array_bytes) << k;
    EXPECT_GT(at_once[k].report.array_bytes, 0u) << k;
    EXPECT_GT(cpu_seconds(at_once[k].report), 0) << k;
    sum += cpu_seconds(at_once[k].report);
  }
  // Each counts only the time of its own threads: the process used at least the sum.
  if (knows_cpu_time()) {
    EXPECT_LE(sum, 1.05 * process + 0.02);
  }
}

TEST(Contexts, ALimitAndACancelledRunLeaveOtherThreadsAlone) {
  std::vector<Task> runs = different_runs();
  const Reconstruction alone = result_of(runs[0]);
  runs[1].memory_limit = size_t{1} << 20;
  Progress cancelled;
  cancelled.cancel();
  Reconstruction found;
  std::exception_ptr refused, stopped;
  const auto failure_of = [](auto&& run) {
    try {
      run();
    } catch (...) {
      return std::current_exception();
    }
    return std::exception_ptr();
  };
  {
    const std::jthread first([&] { found = result_of(runs[0]); });
    const std::jthread second([&] { refused = failure_of([&] { result_of(runs[1]); }); });
    const std::jthread third(
        [&] { stopped = failure_of([&] { reconstruct(runs[2].cloud, runs[2].params, Context(2, cancelled)); }); });
  }
  EXPECT_EQ(hash_mesh(found.mesh), hash_mesh(alone.mesh));
  ASSERT_TRUE(refused && stopped);
  EXPECT_THROW(std::rethrow_exception(refused), MemoryError);
  EXPECT_THROW(std::rethrow_exception(stopped), Cancelled);
}

/// What belongs to the machine goes along with every context that is made of one.
TEST(Contexts, PartsHaveTheLimitAndTheScratchFolder) {
  Context context(1);
  EXPECT_FALSE(context.memory_limit());
  EXPECT_EQ(std::filesystem::path(context.scratch_folder()), std::filesystem::temp_directory_path());
  context.limit_memory(1000);
  context.set_scratch_folder("elsewhere");
  const auto check = [](const Context& part) {
    EXPECT_EQ(part.memory_limit(), size_t{1000});
    EXPECT_EQ(part.scratch_folder(), "elsewhere");
  };
  check(silenced(context));
  check(part_of(context, 0, 0.5));
  check(on_device(context, nullptr));
  context.set_scratch_folder({});
  EXPECT_EQ(std::filesystem::path(context.scratch_folder()), std::filesystem::temp_directory_path());
}

}  // namespace TEST_FILE
}  // namespace soapfilm
