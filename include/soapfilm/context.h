// What all stages of a run share: threads, progress and cancelling, SIMD instructions, memory.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "soapfilm/progress.h"

namespace SOAPFILM_API soapfilm {

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

  /// Bytes that this process may take in a run; if not given: what the machine has free. A run that needs more throws
  /// MemoryError before it allocates them. To be set between runs, as is the folder.
  void limit_memory(std::optional<size_t> bytes);
  std::optional<size_t> memory_limit() const;
  /// Where temporary files go, and large arrays of runs larger than memory. Empty: $TMPDIR, else /tmp; no arrays.
  void set_scratch_folder(std::string folder);
  std::string scratch_folder() const;
  void set_resume(bool resume);  ///< finished stages are kept there, and found by the same run after a crash

  struct State;  ///< for use inside the library
  explicit Context(std::unique_ptr<State> state);
  State& state() const { return *state_; }

 private:
  std::unique_ptr<State> state_;
};

/// The SIMD instruction sets that this processor can run, best first; the last is always "scalar". Results do not
/// depend on the choice.
std::vector<std::string> simd_targets();

}  // namespace soapfilm
