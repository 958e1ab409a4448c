#include "cli/terminal.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <pty.h>
#include <signal.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <functional>
#include <string>
#include <thread>

#include "cli/command.h"

namespace soapfilm::cli {
namespace TEST_FILE {

/// The output of `report`, to a pipe or to a pseudo-terminal of the given width (whose lines end in "\r\n").
std::string captured(const GlobalOptions& options, const std::function<void(Progress&)>& report, int columns = 0) {
  int reader = -1;
  int writer = -1;
  if (columns > 0) {
    setenv("TERM", "xterm", 1);
    winsize size{};
    size.ws_col = static_cast<unsigned short>(columns);
    EXPECT_EQ(openpty(&reader, &writer, nullptr, nullptr, &size), 0);
  } else {
    int ends[2];
    EXPECT_EQ(pipe(ends), 0);
    reader = ends[0];
    writer = ends[1];
  }
  std::string text;
  std::jthread collect([&] {
    char buffer[4096];
    // A pseudo-terminal reports an error, a pipe zero bytes, once the writer is closed.
    for (ssize_t n; (n = read(reader, buffer, sizeof buffer)) > 0;) text.append(buffer, static_cast<size_t>(n));
  });
  std::FILE* out = fdopen(writer, "w");
  {
    TerminalProgress progress(options, out);
    report(progress);
  }
  std::fclose(out);
  collect.join();
  close(reader);
  return text;
}

void two_stages(Progress& progress) {
  progress.begin_stage("read");
  progress.advance(0.5, "");
  progress.end_stage(0.25);
  progress.info("360000 samples");
  progress.detail("a detail");
  progress.warn("sparse");
  progress.begin_stage("solve");
  progress.advance(1.0, "gap 3.1e-4");
  progress.end_stage(12.345);
}

size_t count(const std::string& text, const std::string& part) {
  size_t n = 0;
  for (size_t at = 0; (at = text.find(part, at)) != std::string::npos; at += part.size()) ++n;
  return n;
}

TEST(TerminalProgress, WritesOneLineForEachStageToAPipe) {
  EXPECT_EQ(captured({}, two_stages),
            "read         0.25 s\n"
            "360000 samples\n"
            "soapfilm: warning: sparse\n"
            "solve       12.35 s  gap 3.1e-4\n");
}

TEST(TerminalProgress, QuietLeavesWarnings) {
  GlobalOptions options;
  options.quiet = true;
  EXPECT_EQ(captured(options, two_stages), "soapfilm: warning: sparse\n");
  EXPECT_EQ(captured(options, two_stages, 80), "soapfilm: warning: sparse\r\n");
}

TEST(TerminalProgress, VerboseAddsDetails) {
  GlobalOptions options;
  options.verbose = true;
  EXPECT_EQ(count(captured(options, two_stages), "a detail\n"), 1u);
}

TEST(TerminalProgress, ATerminalKeepsOnlyFinishedLines) {
  const std::string text = captured({}, two_stages, 80);
  // The remaining text on the screen: each "erase the line" removes what was drawn since the last end of line.
  std::string screen;
  for (size_t at = 0; at < text.size(); ++at) {
    if (text.compare(at, 4, "\r\033[K") == 0) {
      screen.resize(screen.rfind('\n') + 1);
      at += 3;
    } else if (text[at] != '\r') {
      screen += text[at];
    }
  }
  EXPECT_EQ(screen,
            "read         0.25 s\n"
            "360000 samples\n"
            "soapfilm: warning: sparse\n"
            "solve       12.35 s  gap 3.1e-4\n");
}

TEST(TerminalProgress, ATerminalShowsABarWithTheDetail) {
  const std::string text = captured(
      {},
      [](Progress& progress) {
        progress.begin_stage("solve");
        std::this_thread::sleep_for(std::chrono::milliseconds(60));
        progress.advance(0.45, "gap 3.1e-4");
        progress.end_stage(1);
      },
      80);
  EXPECT_EQ(count(text, "solve     [--------------------]   0 %  0.0 s"), 1u) << text;
  EXPECT_EQ(count(text, "solve     [#########-----------]  45 %  gap 3.1e-4  0."), 1u) << text;
}

TEST(TerminalProgress, RedrawsAtMostTwentyTimesASecond) {
  std::chrono::duration<double> elapsed{};
  const std::string text = captured(
      {},
      [&](Progress& progress) {
        const auto begin = std::chrono::steady_clock::now();
        progress.begin_stage("solve");
        for (int i = 0; i < 100000; ++i) progress.advance(i / 1e5, "");
        elapsed = std::chrono::steady_clock::now() - begin;
      },
      80);
  EXPECT_LE(static_cast<double>(count(text, "\r\033[K")), 2 + elapsed.count() * 20);
}

TEST(TerminalProgress, ALiveLineNeverWraps) {
  const std::string text = captured(
      {}, [](Progress& progress) { progress.begin_stage(std::string(200, 'x')); }, 40);
  EXPECT_EQ(text, "\r\033[K" + std::string(39, 'x') + "\r\n");
}

TEST(TerminalProgress, FactsDuringAStageStandAboveTheLiveLine) {
  const std::string text = captured(
      {},
      [](Progress& progress) {
        progress.begin_stage("solve");
        progress.info("a fact");
      },
      80);
  EXPECT_NE(text.find("\r\033[Ka fact\r\n\r\033[Ksolve"), std::string::npos) << text;
}

TEST(TerminalProgress, AnAbandonedStageEndsItsLine) {
  const std::string text = captured(
      {}, [](Progress& progress) { progress.begin_stage("solve"); }, 80);
  EXPECT_EQ(text.substr(text.size() - 2), "\r\n");
}

TEST(TerminalProgress, AStageThatFailsLeavesNoFinishedLine) {
  const auto failing = [](Progress& progress) {
    struct Stage {
      Progress& progress;
      ~Stage() { progress.end_stage(1); }
    };
    try {
      progress.begin_stage("solve");
      const Stage stage{progress};
      throw Cancelled();
    } catch (const Cancelled&) {
    }
  };
  EXPECT_EQ(captured({}, failing), "");
  const std::string text = captured({}, failing, 80);
  EXPECT_EQ(text.substr(text.size() - 4), "\r\033[K") << text;
}

TEST(CancelOnSignal, TheFirstSignalCancels) {
  for (const int signal : {SIGINT, SIGTERM}) {
    Progress progress;
    const CancelOnSignal cancel(progress);
    EXPECT_FALSE(progress.cancelled());
    raise(signal);
    EXPECT_TRUE(progress.cancelled());
    EXPECT_THROW(progress.check(), Cancelled);
  }
}

TEST(CancelOnSignalDeathTest, TheSecondSignalKills) {
  const auto twice = [](int first, int second) {
    Progress progress;
    const CancelOnSignal cancel(progress);
    raise(first);
    raise(second);
  };
  EXPECT_EXIT(twice(SIGINT, SIGINT), testing::KilledBySignal(SIGINT), "");
  EXPECT_EXIT(twice(SIGTERM, SIGINT), testing::KilledBySignal(SIGINT), "");
}

TEST(CancelOnSignalDeathTest, WithoutItASignalKills) {
  {
    Progress progress;
    const CancelOnSignal cancel(progress);
  }
  EXPECT_EXIT(raise(SIGINT), testing::KilledBySignal(SIGINT), "");
}

TEST(CancelOnSignalDeathTest, AProgramMayOutliveSignalsAfterARun) {
  const auto asked_after_a_run = [] {
    outlive_signals_after_runs();
    {
      Progress progress;
      const CancelOnSignal cancel(progress);
    }
    raise(SIGTERM);
    std::_Exit(7);
  };
  EXPECT_EXIT(asked_after_a_run(), testing::ExitedWithCode(7), "");
}

}  // namespace TEST_FILE
}  // namespace soapfilm::cli
