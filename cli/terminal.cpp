#include "cli/terminal.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <exception>
#include <utility>

#include "cli/command.h"
#include "cli/print.h"
#include "cli/standard_streams.h"
#include "soapfilm/core/printable.h"
#include "soapfilm/io.h"
#include "soapfilm/io/files.h"
#include "soapfilm/platform/signals.h"
#include "soapfilm/platform/terminal.h"

namespace soapfilm::cli {

namespace {

constexpr auto redraw_interval = std::chrono::milliseconds(50);
constexpr int bar_width = 20;

std::atomic<Progress*> live_progress{nullptr};
static_assert(std::atomic<Progress*>::is_always_lock_free, "a signal handler reads it");

/// Dies of the signal as it would without a handler, but leaves no half-written file.
extern "C" void clean_up_and_die(int signal) {
  remove_temporary_files();
  on_interrupt(nullptr);
  std::raise(signal);
}

/// The first signal cancels; the next one kills.
extern "C" void cancel_live_progress(int) {
  if (Progress* progress = live_progress.load()) progress->cancel();
  on_interrupt(clean_up_and_die);
}

extern "C" void pass_over(int) {}

/// Between runs; null: a signal ends the program.
std::atomic<void (*)(int)> idle_handler{nullptr};

std::string bar(double fraction) {
  const auto full = static_cast<size_t>(std::lround(fraction * bar_width));
  return "[" + std::string(full, '#') + std::string(bar_width - full, '-') + "]";
}

}  // namespace

void outlive_signals_after_runs() { idle_handler = pass_over; }

CancelOnSignal::CancelOnSignal(Progress& progress) {
  live_progress = &progress;
  on_interrupt(cancel_live_progress);
}

CancelOnSignal::~CancelOnSignal() {
  on_interrupt(idle_handler.load());
  live_progress = nullptr;
}

TerminalProgress::TerminalProgress(const GlobalOptions& options, std::FILE* out)
    : out_(options.speaks() ? out : nullptr),
      quiet_(options.quiet || !out_),
      verbose_(options.verbose),
      live_(!quiet_ && is_terminal(out)) {}

TerminalProgress::~TerminalProgress() {
  if (drawn_) std::fputc('\n', out_);
}

void TerminalProgress::begin_stage(std::string_view name) {
  stage_ = name;
  stage_detail_.clear();
  fraction_ = 0;
  stage_begin_ = Clock::now();
  if (live_) draw();
}

void TerminalProgress::advance(double fraction, std::string_view detail) {
  fraction_ = std::clamp(fraction, 0.0, 1.0);
  stage_detail_ = detail;
  if (live_ && Clock::now() - last_draw_ >= redraw_interval) draw();
}

void TerminalProgress::end_stage(double seconds) {
  const std::string name = std::exchange(stage_, {});
  if (std::uncaught_exceptions() > 0) return erase();  // it failed: the error's message follows
  if (!quiet_)
    write_line(fmt::format("{:<10}{:>7.2f} s{}{}", name, seconds, stage_detail_.empty() ? "" : "  ", stage_detail_));
}

void TerminalProgress::info(const std::string& line) {
  if (!quiet_) write_line(line);
}

void TerminalProgress::detail(const std::string& line) {
  if (verbose_ && !quiet_) write_line(line);
}

void TerminalProgress::warn(const std::string& line) { write_line("soapfilm: warning: " + line); }

void TerminalProgress::draw() {
  last_draw_ = Clock::now();
  const double seconds = std::chrono::duration<double>(last_draw_ - stage_begin_).count();
  std::string line = fmt::format("{:<10}{} {:3.0f} %  {}{}{:.1f} s", stage_, bar(fraction_), 100 * fraction_,
                                 stage_detail_, stage_detail_.empty() ? "" : "  ", seconds);
  // A line that wraps could not be erased.
  line.resize(std::min(line.size(), terminal_columns(out_) - 1));
  print(out_, fmt::format("\r\033[K{}", printable(line)));
  std::fflush(out_);
  drawn_ = true;
}

void TerminalProgress::erase() {
  if (drawn_) print(out_, "\r\033[K");
  drawn_ = false;
}

void TerminalProgress::write_line(const std::string& line) {
  if (!out_) return;
  erase();
  print(out_, fmt::format("{}\n", printable(with_known_names(line))));
  if (live_ && !stage_.empty()) draw();
  std::fflush(out_);
}

}  // namespace soapfilm::cli
