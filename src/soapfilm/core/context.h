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

  /// The same threads, kernels and pages, stopped by the same progress object; must not outlive this context. For small
  /// solves inside a stage: nothing is reported.
  Context silent() const;
  /// Likewise for a part of a stage, which reports fractions of itself: they become fractions from `begin` to `end` of
  /// what this context reports, in [0, 1].
  Context part(double begin, double end) const;

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
  struct Part : Progress {
    void advance(double fraction, std::string_view detail) override {
      if (whole) whole->advance(begin + fraction * (end - begin), detail);
    }
    void info(const std::string& line) override {
      if (whole) whole->info(line);
    }
    void detail(const std::string& line) override {
      if (whole) whole->detail(line);
    }
    void warn(const std::string& line) override {
      if (whole) whole->warn(line);
    }
    Progress* whole = nullptr;  ///< null: nobody is told
    double begin = 0, end = 1;
  };
  Context(const Context& parent, Progress* whole, double begin, double end);

  mutable Part part_;
  Progress* reports_;
  const Progress* stopped_by_;
  SimdTarget simd_;
  std::shared_ptr<Threads> threads_;
  PagePool pages_;
};

}  // namespace soapfilm
