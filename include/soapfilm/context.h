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

/// Two contexts in one process never mix: each run gives the same bytes as it would alone.
class Context {
 public:
  /// Reports nothing and cannot be cancelled. `threads` >= 1, or 0 for all that this process may use. `simd` is one of
  /// simd_targets(), or empty for the best. Throws ParameterError for any other value.
  explicit Context(int threads = 0, const std::string& simd = {});
  /// Reports to `progress`, which must outlive the context. Once that is cancelled the call in progress throws
  /// Cancelled within milliseconds.
  Context(int threads, Progress& progress, const std::string& simd = {});
  ~Context();
  Context(const Context&) = delete;
  Context& operator=(const Context&) = delete;

  int threads() const;
  Progress& progress() const;
  /// CPU time so far of its threads and of the calling thread.
  double cpu_seconds() const;
  /// Throws Cancelled once the progress object was cancelled.
  void check() const;

  /// For use inside the library, within a stage: the same context, and must not outlive it. silent(): reports nothing.
  /// part(): its fractions [0, 1] are reported as fractions from `begin` to `end`, in [0, 1], of this context.
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

/// The SIMD instruction sets that this processor can run, best first; the last is always "scalar". Results do not
/// depend on the choice.
std::vector<std::string> simd_targets();

}  // namespace soapfilm
