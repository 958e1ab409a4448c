// The program's output while it works: one live line per stage on a terminal, plain lines elsewhere.
#pragma once

#include <chrono>
#include <cstdio>
#include <string>
#include <string_view>

#include "soapfilm/progress.h"

namespace soapfilm::cli {

struct GlobalOptions;

/// While it lives, the first SIGINT (Ctrl-C) or SIGTERM cancels `progress`; the next one kills the program at once.
/// At most one lives at a time.
class CancelOnSignal {
 public:
  explicit CancelOnSignal(Progress& progress);
  ~CancelOnSignal();
  CancelOnSignal(const CancelOnSignal&) = delete;
  CancelOnSignal& operator=(const CancelOnSignal&) = delete;
};

/// From now on a signal that comes when none lives any more is passed over; before the first one it ends the program.
void outlive_signals_after_runs();

/// Writes stages, facts and warnings to `out`; Ctrl-C cancels it while it lives.
///
/// On a terminal the current stage is a line that is redrawn at most 20 times a second:
///     solve     [#########-----------]  45 %  level 2, gap 3.1e-4  1.2 s
/// and a finished one stays as
///     solve        2.64 s  level 0, gap 2.8e-4
/// Elsewhere only the finished lines are written, without control characters, after one line when a stage begins.
class TerminalProgress : public Progress {
 public:
  explicit TerminalProgress(const GlobalOptions& options, std::FILE* out = stderr);
  /// Ends an unfinished live line, so that what follows (an error message) starts on a line of its own.
  ~TerminalProgress() override;

  void begin_stage(std::string_view name) override;
  void advance(double fraction, std::string_view detail) override;
  void end_stage(double seconds) override;
  void info(const std::string& line) override;
  void detail(const std::string& line) override;
  void warn(const std::string& line) override;

 private:
  using Clock = std::chrono::steady_clock;

  void draw();
  void erase();
  void write_line(const std::string& line);

  std::FILE* out_;  ///< null: another process writes
  bool quiet_;
  bool verbose_;
  bool live_;
  bool drawn_ = false;  ///< the live line is on the screen
  std::string stage_;   ///< empty between stages
  std::string stage_detail_;
  double fraction_ = 0;
  Clock::time_point stage_begin_{};
  Clock::time_point last_draw_{};
  CancelOnSignal cancel_on_signal_{*this};
};

}  // namespace soapfilm::cli
