// One object for progress, messages and cancelling, given to the library by the caller.
#pragma once

#include <atomic>
#include <string>
#include <string_view>

#include "soapfilm/error.h"

namespace SOAPFILM_API soapfilm {

/// Callbacks arrive on the thread that called the library, never from worker threads. The defaults do nothing.
class Progress {
 public:
  virtual ~Progress() = default;

  /// A stage of the pipeline begins ("read", "field", "solve", ...).
  virtual void begin_stage(std::string_view /*name*/) {}
  /// `fraction` in [0, 1] of the current stage; `detail` is a short text such as "level 2, gap 3.1e-4".
  virtual void advance(double /*fraction*/, std::string_view /*detail*/) {}
  virtual void end_stage(double /*seconds*/) {}
  /// Facts worth a line in normal output / only with -v / a warning that is always shown.
  virtual void info(const std::string& /*line*/) {}
  virtual void detail(const std::string& /*line*/) {}
  virtual void warn(const std::string& /*line*/) {}

  /// May be called from any thread and from a signal handler.
  void cancel() noexcept { cancelled_.store(true, std::memory_order_relaxed); }
  /// After a cancelled run: lets another one begin.
  void resume() noexcept { cancelled_.store(false, std::memory_order_relaxed); }
  bool cancelled() const noexcept { return cancelled_.load(std::memory_order_relaxed); }
  /// Throws Cancelled once cancel() was called. Called between the library's units of work (milliseconds).
  void check() const {
    if (cancelled()) throw Cancelled();
  }

 private:
  std::atomic<bool> cancelled_{false};
  static_assert(std::atomic<bool>::is_always_lock_free);
};

}  // namespace soapfilm
