#include "soapfilm/core/parallel.h"

#include <atomic>
#include <exception>
#include <mutex>

#include "soapfilm/core/context_state.h"

namespace soapfilm {

namespace {

/// One loop for the threads: numbered chunks, each to be run once, in any order, by any thread.
class Loop {
 public:
  Loop(const Context& context, HelpersTime& helpers_time, size_t count, size_t grain, void* body, ChunkLoop::Call call)
      : context_(context), helpers_time_(helpers_time), count_(count), grain_(grain), body_(body), call_(call) {}

  size_t chunks() const { return count_ / grain_ + (count_ % grain_ != 0); }

  void run(size_t chunk) {
    context_.check();
    const size_t begin = chunk * grain_;
    call_(body_, begin, begin + std::min(grain_, count_ - begin));
  }

  /// Same as run(), but stores the exception of the lowest chunk that throws. Chunks above it are skipped and chunks
  /// below it still run, so the stored exception does not depend on the threads.
  void run_guarded(size_t chunk) noexcept {
    if (chunk > lowest_failed_.load(std::memory_order_relaxed)) return;
    const HelpersTime::Share share(&helpers_time_);
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
  const Context& context_;
  HelpersTime& helpers_time_;
  size_t count_;
  size_t grain_;
  void* body_;
  ChunkLoop::Call call_;
  std::atomic<size_t> lowest_failed_{SIZE_MAX};
  std::mutex mutex_;
  std::exception_ptr error_;
};

}  // namespace

void ChunkLoop::run(const Context& context, size_t count, size_t grain, void* body, Call call) {
  Loop loop(context, context.state().threads->helpers_time(), count, grain, body, call);
  const size_t chunks = loop.chunks();
  if (context.threads() == 1 || chunks <= 1) {
    for (size_t k = 0; k < chunks; ++k) loop.run(k);
    return;
  }
  const HelpersTime::Share own(nullptr);  // counted by the calling thread
  context.state().threads->each(chunks, [&](size_t k) { loop.run_guarded(k); });
  loop.rethrow();
}

void ChunkLoop::confine(const Context& context, void* body, Call call) {
  context.state().threads->confine([&] { call(body, 0, 1); });
}

}  // namespace soapfilm
