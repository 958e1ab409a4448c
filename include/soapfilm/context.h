// What all stages of a run share: threads, progress and cancelling, SIMD instructions, memory pages.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "soapfilm/progress.h"

namespace SOAPFILM_API soapfilm {

class Threads;
class PagePool;
struct Kernels;

/// Two contexts in one process never mix: each run gives the bytes that it gives alone.
class Context {
 public:
  /// Reports nothing and cannot be cancelled. `threads` >= 1, or 0 for all that this process may use. `simd` is one of
  /// simd_targets(), or empty for the best. Throws ParameterError for values out of these.
  explicit Context(int threads = 0, const std::string& simd = {});
  /// Reports to `progress`, which must outlive the context. Once that is cancelled the call in progress throws
  /// Cancelled within milliseconds.
  Context(int threads, Progress& progress, const std::string& simd = {});
  ~Context();
  Context(const Context&) = delete;
  Context& operator=(const Context&) = delete;

  int threads() const;
  Progress& progress() const;
  /// CPU time of its threads so far, and of the calling one.
  double cpu_seconds() const;
  /// Throws Cancelled once the progress object was cancelled.
  void check() const;

  /// The library's own use, inside a stage: the same context, must not outlive it. silent(): nothing is reported.
  /// part(): fractions become fractions from `begin` to `end`, in [0, 1], of this one's.
  Context silent() const;
  Context part(double begin, double end) const;
  const Kernels& kernels() const;
  const PagePool& pages() const;

 private:
  friend class ChunkLoop;
  struct Part;
  struct State;
  explicit Context(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

/// The SIMD instructions that this processor can run, best first; the last is always "scalar". Results do not depend on
/// the choice.
std::vector<std::string> simd_targets();

}  // namespace soapfilm
