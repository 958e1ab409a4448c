// What all stages of a run share.
#pragma once

#include <memory>

#include "soapfilm/core/page_pool.h"
#include "soapfilm/core/progress.h"
#include "soapfilm/core/simd.h"

namespace soapfilm {

class Threads;

/// The threads of a run, the progress object that it reports to and that may cancel it, the SIMD instructions of its
/// kernels, and the pages of its arrays. Two contexts in one process never mix: each run gives the bytes that it gives
/// alone. Not copyable; what is made with a context keeps a reference to it.
class Context {
 public:
  /// Reports nothing and cannot be cancelled. `threads` >= 1, or 0 for all that this process may use.
  explicit Context(int threads = 0, SimdTarget simd = {});
  /// Reports to `progress`, which must outlive the context. Once that is cancelled, loops throw Cancelled before their
  /// next chunk: every stage can be stopped within milliseconds.
  Context(int threads, Progress& progress, SimdTarget simd = {});
  ~Context();
  Context(const Context&) = delete;
  Context& operator=(const Context&) = delete;

  /// The same threads, kernels and pages, stopped by the same progress object, but nothing is reported: for small
  /// solves inside a stage. Must not outlive this context's progress object.
  Context silent() const;

  int threads() const;
  Progress& progress() const { return *reports_; }
  const SimdTarget& simd() const { return simd_; }
  /// What its large arrays come from.
  const PagePool& pages() const { return pages_; }
  /// CPU time of its threads so far, and of the calling one.
  double cpu_seconds() const;
  /// Throws Cancelled once the progress object was cancelled.
  void check() const { stopped_by_->check(); }

 private:
  friend class ChunkLoop;
  explicit Context(const Context* loud);

  mutable Progress nobody_;
  Progress* reports_;
  const Progress* stopped_by_;
  SimdTarget simd_;
  std::shared_ptr<Threads> threads_;
  PagePool pages_;
};

}  // namespace soapfilm
