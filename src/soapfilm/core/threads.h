// The only file that uses the thread library: oneTBB, or std::thread when built with SOAPFILM_STD_THREADS (the build
// for ThreadSanitizer), or none when built with SOAPFILM_NO_THREADS (the build for browsers).
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>

#include "soapfilm/core/cpu_time.h"

#if defined(SOAPFILM_NO_THREADS)
// Nothing.
#elif defined(SOAPFILM_STD_THREADS)
#include <thread>
#include <vector>
#else
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <memory>
#endif

namespace soapfilm {

#if defined(SOAPFILM_NO_THREADS)

/// The calling thread alone, whatever count is asked for.
class Threads {
 public:
  explicit Threads(int /*count*/) {}

  int count() const { return 1; }
  HelpersTime& helpers_time() { return helpers_time_; }

  template <class Run>
  void each(size_t chunks, const Run& run) const {
    for (size_t k = 0; k < chunks; ++k) run(k);
  }

  template <class Body>
  void confine(const Body& body) const {
    body();
  }

 private:
  HelpersTime helpers_time_;
};

#elif defined(SOAPFILM_STD_THREADS)

/// Threads are created for each loop: nested loops create their own and cannot wait for one another.
class Threads {
 public:
  /// 0: all that this process may use.
  explicit Threads(int count) : count_(count > 0 ? count : all()) {}

  int count() const { return count_; }
  HelpersTime& helpers_time() { return helpers_time_; }

  /// run(k) for each k below `chunks`, in any order.
  template <class Run>
  void each(size_t chunks, const Run& run) const {
    std::atomic<size_t> next{0};
    // Relaxed: the counter of chunks must not order them, or ThreadSanitizer would miss races between chunks.
    const auto work = [&] {
      for (size_t k; (k = next.fetch_add(1, std::memory_order_relaxed)) < chunks;) run(k);
    };
    std::vector<std::jthread> helpers;
    const size_t wanted = std::min(static_cast<size_t>(count_), chunks) - 1;
    helpers.reserve(wanted);
    for (size_t t = 0; t < wanted; ++t) helpers.emplace_back(work);
    work();
  }

  /// oneTBB's threads are not controlled here: callers that use oneTBB must limit it to one thread.
  template <class Body>
  void confine(const Body& body) const {
    body();
  }

 private:
  static int all() { return static_cast<int>(std::max(1u, std::thread::hardware_concurrency())); }
  int count_;
  HelpersTime helpers_time_;
};

#else

/// An arena of its own, without a process-wide limit.
class Threads {
 public:
  /// 0: all that this process may use.
  explicit Threads(int count)
      : count_(count > 0 ? count : all()), allow_more_(more_than_cores(count_)), arena_(count_) {}

  int count() const { return count_; }
  HelpersTime& helpers_time() { return helpers_time_; }

  /// run(k) for each k below `chunks`, in any order.
  template <class Run>
  void each(size_t chunks, const Run& run) {
    arena_.execute([&] {
      // Isolated: a thread that waits for a nested loop must not start an outer chunk meanwhile, whose locks or
      // thread-local state the waiting chunk may hold.
      tbb::this_task_arena::isolate([&] { tbb::parallel_for(size_t{0}, chunks, run); });
    });
  }

  /// body() on the calling thread; loops of oneTBB inside use only these threads.
  template <class Body>
  void confine(const Body& body) {
    arena_.execute(body);
  }

 private:
  static int all() { return tbb::this_task_arena::max_concurrency(); }
  /// oneTBB starts no more workers than there are cores (and prints so on stderr) unless allowed before the arena
  /// begins. The value is only a limit: no loop uses more than its arena's threads. There is one object for all arenas,
  /// since the smallest value of all living objects counts.
  static std::unique_ptr<tbb::global_control> more_than_cores(int count) {
    if (count <= all()) return nullptr;
    return std::make_unique<tbb::global_control>(tbb::global_control::max_allowed_parallelism, 1024);
  }
  int count_;
  std::unique_ptr<tbb::global_control> allow_more_;
  tbb::task_arena arena_;
  HelpersTime helpers_time_;
};

#endif

}  // namespace soapfilm
