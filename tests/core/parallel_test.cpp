#include "soapfilm/core/parallel.h"

#include <gtest/gtest.h>

#include <atomic>
#include <mutex>
#include <set>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "soapfilm/core/gather.h"

namespace soapfilm {
namespace TEST_FILE {

class ParallelLoop : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Threads, ParallelLoop, testing::Values(1, 2, 3, 8), testing::PrintToStringParamName());

TEST_P(ParallelLoop, HasTheThreadsAskedFor) { EXPECT_EQ(Context(GetParam()).threads(), GetParam()); }

TEST_P(ParallelLoop, VisitsEveryIndexOnce) {
  const Context context(GetParam());
  for (size_t count : {1, 2, 7, 64, 1000, 4099})
    for (size_t grain : {1, 3, 64, 5000}) {
      std::vector<int> visits(count);
      parallel_for(context, count, grain, [&](size_t i) { ++visits[i]; });
      EXPECT_EQ(visits, std::vector<int>(count, 1)) << count << " by " << grain;
    }
}

TEST_P(ParallelLoop, CutsByCountAndGrainAlone) {
  const Context context(GetParam());
  std::mutex mutex;
  std::set<std::pair<size_t, size_t>> chunks;
  parallel_chunks(context, 103, 25, [&](size_t begin, size_t end) {
    const std::lock_guard lock(mutex);
    chunks.emplace(begin, end);
  });
  const std::set<std::pair<size_t, size_t>> expected{{0, 25}, {25, 50}, {50, 75}, {75, 100}, {100, 103}};
  EXPECT_EQ(chunks, expected);
}

TEST_P(ParallelLoop, ZeroCountCallsNothing) {
  parallel_chunks(Context(GetParam()), 0, 8, [](size_t, size_t) { FAIL() << "body called"; });
}

TEST_P(ParallelLoop, GrainZeroMeansOne) {
  std::vector<int> visits(5);
  parallel_chunks(Context(GetParam()), 5, 0, [&](size_t begin, size_t end) {
    EXPECT_EQ(end, begin + 1);
    ++visits[begin];
  });
  EXPECT_EQ(visits, std::vector<int>(5, 1));
}

TEST_P(ParallelLoop, HugeGrainDoesNotOverflow) {
  std::atomic<size_t> last{0};
  parallel_chunks(Context(GetParam()), 10, SIZE_MAX, [&](size_t, size_t end) { last = end; });
  EXPECT_EQ(last, 10u);
}

TEST_P(ParallelLoop, RethrowsTheExceptionOfTheLowestChunk) {
  const Context context(GetParam());
  for (int repeat = 0; repeat < 20; ++repeat) {
    try {
      parallel_for(context, 1000, 1, [](size_t i) {
        if (i % 100 == 37) throw std::runtime_error(std::to_string(i));
      });
      FAIL() << "nothing thrown";
    } catch (const std::runtime_error& error) {
      EXPECT_STREQ(error.what(), "37");
    }
  }
}

TEST_P(ParallelLoop, WorksAgainAfterAnException) {
  const Context context(GetParam());
  EXPECT_THROW(parallel_for(context, 50, 1, [](size_t) { throw std::logic_error("x"); }), std::logic_error);
  std::atomic<int> calls{0};
  parallel_for(context, 50, 1, [&](size_t) { ++calls; });
  EXPECT_EQ(calls, 50);
}

TEST_P(ParallelLoop, ConfinesACallToTheCallingThread) {
  const auto caller = std::this_thread::get_id();
  std::thread::id called;
  confine(Context(GetParam()), [&] { called = std::this_thread::get_id(); });
  EXPECT_EQ(called, caller);
  EXPECT_THROW(confine(Context(GetParam()), [] { throw std::logic_error("x"); }), std::logic_error);
}

TEST_P(ParallelLoop, NestedLoopsFinish) {
  const Context context(GetParam());
  std::vector<int> visits(20 * 30 * 4);
  parallel_for(context, 20, 1, [&](size_t i) {
    parallel_for(context, 30, 7,
                 [&](size_t j) { parallel_for(context, 4, 1, [&](size_t k) { ++visits[(i * 30 + j) * 4 + k]; }); });
  });
  EXPECT_EQ(visits, std::vector<int>(visits.size(), 1));
}

TEST_P(ParallelLoop, ANestedLoopStartsNoOuterChunkOnTheThreadThatWaits) {
  const Context context(GetParam());
  std::atomic<int> broken{0};
  static thread_local bool inside = false;
  parallel_for(context, 64, 1, [&](size_t) {
    if (inside) ++broken;
    inside = true;
    parallel_for(context, 64, 1, [](size_t) { std::this_thread::yield(); });
    inside = false;
  });
  EXPECT_EQ(broken, 0);
}

TEST_P(ParallelLoop, RunsForSeveralCallersAtOnce) {
  const Context context(GetParam());
  std::vector<std::vector<int>> visits(3, std::vector<int>(500));
  std::vector<std::jthread> callers;
  for (auto& mine : visits)
    callers.emplace_back([&] { parallel_for(context, mine.size(), 3, [&](size_t i) { ++mine[i]; }); });
  callers.clear();
  for (const auto& mine : visits) EXPECT_EQ(mine, std::vector<int>(500, 1));
}

TEST(Parallel, ALowChunkThatFailsLaterStillWins) {
  const Context context(2);
  std::atomic<bool> high_threw{false};
  try {
    parallel_for(context, 2, 1, [&](size_t i) {
      if (i == 1) {
        high_threw = true;
        throw std::runtime_error("high");
      }
      // The high chunk may come later on this very thread, so the wait has an end.
      for (int ms = 0; ms < 200 && !high_threw; ++ms) std::this_thread::sleep_for(std::chrono::milliseconds(1));
      throw std::runtime_error("low");
    });
    FAIL() << "nothing thrown";
  } catch (const std::runtime_error& error) {
    EXPECT_STREQ(error.what(), "low");
  }
}

TEST_P(ParallelLoop, ListsAndSumsAreInOrder) {
  const Context context(GetParam());
  for (const size_t count : {0, 1, 99, 1000}) {
    const auto odd = gather<size_t>(count, 7, context, [](size_t i, std::vector<size_t>& found) {
      if (i % 2 == 1) found.push_back(i);
    });
    std::vector<size_t> expected;
    for (size_t i = 1; i < count; i += 2) expected.push_back(i);
    EXPECT_EQ(odd, expected);
    // Strings add up in one order alone.
    const auto text = sum_chunks<std::string>(count, 7, context, [](size_t begin, size_t end) {
      return std::to_string(begin) + "-" + std::to_string(end) + " ";
    });
    std::string expected_text;
    for (size_t i = 0; i < count; i += 7)
      expected_text += std::to_string(i) + "-" + std::to_string(std::min(i + 7, count)) + " ";
    EXPECT_EQ(text, expected_text);
  }
}

TEST(Parallel, ZeroThreadsMeansAllThatTheProcessMayUse) { EXPECT_GE(Context(0).threads(), 1); }

TEST_P(ParallelLoop, AllThreadsTakePart) {
  const Context context(GetParam());
  const Context others(GetParam() + 1);  // Another set must neither limit nor widen this one.
  std::mutex mutex;
  std::set<std::thread::id> threads;
  const auto count = [&] {
    const std::lock_guard lock(mutex);
    threads.insert(std::this_thread::get_id());
    return threads.size();
  };
  // Chunks wait for the others, so that each comes to a thread of its own; the wait has an end.
  const auto all = static_cast<size_t>(GetParam());
  parallel_for(context, 1000, 1, [&](size_t) {
    for (int ms = 0; ms < 2 && count() < all; ++ms) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  });
  EXPECT_EQ(threads.size(), all);
}

}  // namespace TEST_FILE
}  // namespace soapfilm
