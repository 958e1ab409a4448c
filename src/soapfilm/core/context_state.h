// The contents of a context, for use inside the library.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "soapfilm/context.h"
#include "soapfilm/core/threads.h"
#include "soapfilm/platform/page_pool.h"

namespace soapfilm {

class Device;
struct Kernels;
class Ranks;

/// Reports its fractions as fractions from `begin` to `end` of a whole.
struct PartOfProgress : Progress {
  void advance(double fraction, std::string_view detail) override;
  void info(const std::string& line) override;
  void detail(const std::string& line) override;
  void warn(const std::string& line) override;

  Progress* whole = nullptr;  ///< null: nothing is reported
  double begin = 0, end = 1;
};

/// Kernels of a back end (kernels/back_ends.cpp), by the name of its target; empty: the best. Throws ParameterError.
std::shared_ptr<const Kernels> kernels_for(const std::string& target);

struct Context::State {
  State(int thread_count, const std::string& simd_target, Progress* progress);
  State(const State& parent, Progress* whole, double begin, double end);
  State(const State& parent, std::shared_ptr<const Device> other_device);

  PartOfProgress part;
  Progress* reports;
  const Progress* stopped_by;
  std::shared_ptr<const Kernels> kernels;
  std::shared_ptr<const Device> device;  ///< device/device.h; null: the CPU
  std::shared_ptr<Ranks> ranks;          ///< core/ranks.h; null: the run has one process
  std::shared_ptr<Threads> threads;
  PagePool pages;
  std::optional<size_t> memory_limit;
  std::string scratch_folder;  ///< empty: the system's, and arrays stay in memory
  /// A program's own way to hold its large vectors in a folder, too: called when a run's arrays go there, and with an
  /// empty name when it ends.
  std::function<void(const std::string& folder)> move_vectors;
};

/// Within a stage: the same context, and must not outlive it. It reports nothing, and each rank does all of its work.
Context silenced(const Context& context);
/// The same context, and must not outlive it, but each rank does all of its work.
Context alone(const Context& context);
/// Its fractions [0, 1] are reported as fractions from `begin` to `end`, in [0, 1], of `context`.
Context part_of(const Context& context, double begin, double end);
/// The same context, and must not outlive it, but what `device` can do runs there; null: on the CPU.
Context on_device(const Context& context, std::shared_ptr<const Device> device);

inline const Kernels& kernels_of(const Context& context) { return *context.state().kernels; }
inline const Device* device_of(const Context& context) { return context.state().device.get(); }
inline Ranks* ranks_of(const Context& context) { return context.state().ranks.get(); }
inline const PagePool& pages_of(const Context& context) { return context.state().pages; }

}  // namespace soapfilm
