#include "soapfilm/core/parallel.h"

#include <atomic>
#include <exception>
#include <mutex>
#include <optional>

#ifdef SOAPFILM_STD_THREADS
#include <thread>
#include <vector>
#else
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>
#endif

namespace soapfilm {

namespace {

/// One loop as an executor sees it: chunks by number, each to be run once, in any order, by any thread.
class Loop {
 public:
  Loop(size_t count, size_t grain, void* body, void (*call)(void*, size_t, size_t),
       const std::array<const Progress*, 2>& progress)
      : count_(count), grain_(grain), body_(body), call_(call), progress_(progress) {}

  size_t chunks() const { return count_ / grain_ + (count_ % grain_ != 0); }

  void run(size_t chunk) {
    for (const Progress* progress : progress_)
      if (progress) progress->check();
    const size_t begin = chunk * grain_;
    call_(body_, begin, begin + std::min(grain_, count_ - begin));
  }

  /// As run(), but keeps the exception of the lowest chunk that throws. Chunks above it are skipped and chunks below
  /// it still run, so which exception is kept does not depend on the threads.
  void run_guarded(size_t chunk) noexcept {
    if (chunk > lowest_failed_.load(std::memory_order_relaxed)) return;
    try {
      run(chunk);
    } catch (...) {
      const std::lock_guard lock(mutex_);
      if (chunk > lowest_failed_.load(std::memory_order_relaxed)) return;
      lowest_failed_.store(chunk, std::memory_order_relaxed);
      error_ = std::current_exception();
    }
  }

  void rethrow() const {
    if (error_) std::rethrow_exception(error_);
  }

 private:
  size_t count_;
  size_t grain_;
  void* body_;
  void (*call_)(void*, size_t, size_t);
  std::array<const Progress*, 2> progress_;
  std::atomic<size_t> lowest_failed_{SIZE_MAX};
  std::mutex mutex_;
  std::exception_ptr error_;
};

}  // namespace

#ifdef SOAPFILM_STD_THREADS

// Threads made for each loop: nested loops make their own and cannot wait for one another.
struct Parallel::Impl {
  static int default_threads() { return static_cast<int>(std::max(1u, std::thread::hardware_concurrency())); }

  explicit Impl(int threads) : threads(threads) {}

  void run_all(Loop& loop) const {
    const size_t chunks = loop.chunks();
    std::atomic<size_t> next{0};
    // Relaxed: handing out chunks must not order them, or ThreadSanitizer would miss races between chunks.
    const auto work = [&] {
      for (size_t k; (k = next.fetch_add(1, std::memory_order_relaxed)) < chunks;) loop.run_guarded(k);
    };
    std::vector<std::jthread> helpers;
    const size_t wanted = std::min(static_cast<size_t>(threads), chunks) - 1;
    helpers.reserve(wanted);
    for (size_t t = 0; t < wanted; ++t) helpers.emplace_back(work);
    work();
  }

  /// oneTBB's threads are not ours here: who brings oneTBB along must keep it to one thread.
  template <class Body>
  void confine(const Body& body) const {
    body();
  }

  int threads;
};

#else

struct Parallel::Impl {
  static int default_threads() { return tbb::this_task_arena::max_concurrency(); }

  explicit Impl(int threads) : arena(threads) {
    // oneTBB starts no more workers than there are cores (and says so on stderr) unless allowed. The value only
    // permits: no loop takes more than its arena's threads. It is one for all, since the least of those alive counts.
    if (threads > default_threads()) allow_more.emplace(tbb::global_control::max_allowed_parallelism, 1024);
  }

  void run_all(Loop& loop) {
    arena.execute([&] {
      // Isolated: a thread that waits for a nested loop must not start an outer chunk meanwhile, whose locks or
      // thread-local state the waiting chunk may hold.
      tbb::this_task_arena::isolate(
          [&] { tbb::parallel_for(size_t{0}, loop.chunks(), [&](size_t k) { loop.run_guarded(k); }); });
    });
  }

  template <class Body>
  void confine(const Body& body) {
    arena.execute(body);
  }

  std::optional<tbb::global_control> allow_more;
  tbb::task_arena arena;
};

#endif

Parallel::Parallel(int threads, const Progress* progress)
    : threads_(threads > 0 ? threads : Impl::default_threads()),
      progress_{progress, nullptr},
      impl_(std::make_shared<Impl>(threads_)) {}

Parallel::Parallel(const Parallel& other, const Progress& progress)
    : threads_(other.threads_),
      progress_{other.progress_[0], other.progress_[0] == &progress ? nullptr : &progress},
      impl_(other.impl_) {}

Parallel::~Parallel() = default;

void Parallel::run(size_t count, size_t grain, void* body, ChunkFunction call) const {
  Loop loop(count, grain, body, call, progress_);
  const size_t chunks = loop.chunks();
  if (threads_ == 1 || chunks <= 1) {
    for (size_t k = 0; k < chunks; ++k) loop.run(k);
    return;
  }
  impl_->run_all(loop);
  loop.rethrow();
}

void Parallel::run_confined(void* body, ChunkFunction call) const {
  impl_->confine([&] { call(body, 0, 1); });
}

}  // namespace soapfilm
