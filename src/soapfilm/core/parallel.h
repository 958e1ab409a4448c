// The one place that knows the thread library. Work is cut into chunks whose bounds depend on nothing but `count` and
// `grain`, so what a chunk computes is the same for any number of threads and for both executors.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <memory>
#include <type_traits>
#include <utility>

#include "soapfilm/core/progress.h"

namespace soapfilm {

/// A set of threads to run loops on. oneTBB by default; std::thread when built with SOAPFILM_STD_THREADS (the build
/// for ThreadSanitizer). Cheap to pass by reference; it owns its arena and sets no process-wide limit.
class Parallel {
 public:
  /// `threads` >= 1, or 0 for all that this process may use. When `progress` is given and cancelled, a loop throws
  /// Cancelled before its next chunk: so every stage that loops can be stopped within milliseconds.
  explicit Parallel(int threads = 0, const Progress* progress = nullptr);
  /// The same threads as `other`, whose loops stop when `progress` is cancelled, too.
  Parallel(const Parallel& other, const Progress& progress);
  ~Parallel();
  Parallel(const Parallel&) = delete;
  Parallel& operator=(const Parallel&) = delete;

  int threads() const { return threads_; }

  /// body(begin, end) for the chunks [k * grain, min((k + 1) * grain, count)), by one thread in order; returns when all
  /// are done. An exception from the body is rethrown here; with several, the one of the lowest chunk.
  template <class Body>
  void for_chunks(size_t count, size_t grain, Body&& body) const {
    using Stored = std::remove_reference_t<Body>;
    run(count, std::max<size_t>(grain, 1), const_cast<void*>(static_cast<const void*>(std::addressof(body))),
        [](void* stored, size_t begin, size_t end) { (*static_cast<Stored*>(stored))(begin, end); });
  }

  /// body(i) for each i in [0, count), `grain` of them per task.
  template <class Body>
  void for_each(size_t count, size_t grain, Body&& body) const {
    for_chunks(count, grain, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) body(i);
    });
  }

  /// body() once, on the calling thread. A library that brings its own loops on the same thread library (Embree's tree
  /// builder) keeps to this set of threads inside.
  template <class Body>
  void confine(Body&& body) const {
    using Stored = std::remove_reference_t<Body>;
    run_confined(const_cast<void*>(static_cast<const void*>(std::addressof(body))),
                 [](void* stored, size_t, size_t) { (*static_cast<Stored*>(stored))(); });
  }

 private:
  using ChunkFunction = void (*)(void* body, size_t begin, size_t end);
  void run(size_t count, size_t grain, void* body, ChunkFunction call) const;
  void run_confined(void* body, ChunkFunction call) const;

  int threads_;
  std::array<const Progress*, 2> progress_;  ///< or null
  struct Impl;
  std::shared_ptr<Impl> impl_;
};

}  // namespace soapfilm
