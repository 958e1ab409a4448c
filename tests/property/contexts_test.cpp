// Runs in one process share nothing: each context has its own threads, SIMD target, progress, pages and limits.
#include <gtest/gtest.h>

#include <ctime>
#include <exception>
#include <string>
#include <thread>
#include <vector>

#include "property/each_method.h"
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
};

std::vector<Task> different_runs() {
  const std::vector<std::string> targets = simd_targets();
  std::vector<Task> runs = {{sampled("knot", vertices, 1), {}, {targets.front(), 2}},
                            {sampled("torus", vertices, 2), {}, {targets.back(), 1}},
                            {sampled("part", vertices, 1), {}, {targets[targets.size() / 2], 3}}};
  for (Task& run : runs) run.params.place.resolution = vertices;
  runs[1].params.memory_limit = size_t{1} << 30;
  return runs;
}

Reconstruction result_of(const Task& run) { return reconstruct(run.cloud, run.params, context_on(run.back_end)); }

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
  runs[1].params.memory_limit = size_t{1} << 20;
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

}  // namespace TEST_FILE
}  // namespace soapfilm
