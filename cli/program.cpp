#include "cli/program.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cctype>
#include <cstdio>
#include <iostream>
#include <memory>
#include <new>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "cli/command.h"
#include "cli/help_page.h"
#include "cli/print.h"
#include "cli/ranks.h"
#include "cli/refusal.h"
#include "cli/standard_streams.h"
#include "cli/terminal.h"
#include "cli/version_page.h"
#include "soapfilm/core/printable.h"
#include "soapfilm/error.h"
#include "soapfilm/io/files.h"
#include "soapfilm/platform/signals.h"
#include "soapfilm/reconstruct.h"

namespace soapfilm::cli {
namespace {

enum ExitCode { success = 0, internal_error = 1, refused = 2, empty = 3, cancelled = 130 };

/// One line, whatever the message contains.
Ending failure(ExitCode code, std::string message) {
  while (!message.empty() && std::isspace(static_cast<unsigned char>(message.back()))) message.pop_back();
  std::replace(message.begin(), message.end(), '\n', ' ');
  return {code, printable(with_known_names(std::move(message)))};
}

void add_global_options(CLI::App& app, GlobalOptions& options) {
  app.add_option("--threads", options.threads, "Threads to use; 0, the default: all that the process may use")
      ->check(CLI::Range(0, 1024))
      ->option_text("N");
  CLI::Option* quiet = app.add_flag("-q,--quiet", options.quiet, "Print warnings and errors only")->option_text(" ");
  app.add_flag("-v,--verbose", options.verbose, "Print details too")->excludes(quiet)->option_text(" ");
  app.set_version_flag("--version", version_page, "Print the version, how it was built, and exit");
  app.set_help_flag("-h,--help", "Print this page and exit");
}

bool is_command(const CLI::App& app, const std::string& name) {
  const std::vector<const CLI::App*> commands =
      app.get_subcommands([&](const CLI::App* c) { return c->check_name(name); });
  return !commands.empty();
}

int run(int argc, char** argv, const std::shared_ptr<Ranks>& ranks) {
  CLI::App app(
      "Turns raw 3D scans into a watertight surface: a minimal surface over the samples, "
      "with a proof of how close it is to the global optimum.",
      "soapfilm");
  app.require_subcommand(1);
  app.fallthrough();  // sub-commands inherit it: global options may follow them
  app.formatter(std::make_shared<HelpPage>());
  GlobalOptions options;
  options.ranks = ranks;
  options.arguments.assign(argv + 1, argv + argc);
  options.command = fmt::format("soapfilm {}", fmt::join(options.arguments, " "));
  Runner runner;
  add_global_options(app, options);
  add_reconstruct(app, options, runner);
  add_scan(app, options, runner);
  add_evaluate(app, options, runner);
  add_compare(app, options, runner);
  add_measure(app, options, runner);
  add_simplify(app, options, runner);
  add_remesh(app, options, runner);
  add_info(app, options, runner);
  add_render(app, options, runner);
  add_view(app, options, runner);
  add_tiles(app, options, runner);
  app.footer(examples_and_exit_codes);  // last: sub-commands would inherit it
  refuse_empty_numbers(app);
  for (CLI::App* command : app.get_subcommands({})) {
    refuse_empty_numbers(*command);
    const std::string own = command->get_footer();
    command->footer(own + (own.empty() ? "" : "\n") + global_options_note);
  }
  add_completion(app, runner);  // after these: hidden, and made of them
  add_man(app, runner);

  if (argc == 1) {
    if (options.speaks()) std::cout << first_page;
    return success;
  }
  // "help COMMAND" is COMMAND --help.
  std::vector<std::string> words = options.arguments;
  if (words[0] == "help") {
    words.erase(words.begin());
    if (words.empty() || is_command(app, words[0])) words.emplace_back("--help");
  }
  refuse_single_dashes(app, words);
  try {
    std::reverse(words.begin(), words.end());
    app.parse(std::move(words));
  } catch (const CLI::Success& asked_for_help) {
    return options.speaks() ? app.exit(asked_for_help) : success;
  } catch (const CLI::ParseError& error) {
    throw ParameterError(parse_message(app, error));
  }
  // All others are work for one process.
  return options.speaks() || app.got_subcommand("reconstruct") ? runner() : success;
}

/// Results may go to standard output; a full disk there must be an error.
Ending finished(int code) {
  std::cout.flush();
  if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0 || !std::cout)
    return failure(refused, "standard output: cannot write");
  return {code};
}

Ending ending_of(int argc, char** argv, const std::shared_ptr<Ranks>& ranks) {
  try {
    become_ranks(argv);
    return finished(run(argc, argv, ranks));
  } catch (const Cancelled& error) {
    Ending ending = failure(cancelled, error.what());
    ending.followed = gave_up_for_another(error);
    return ending;
  } catch (const EmptyResult& error) {
    return failure(empty, error.what());
  } catch (const ParameterError& error) {
    return failure(refused, error.what());
  } catch (const InputError& error) {
    return failure(refused, error.what());
  } catch (const OutputError& error) {
    return failure(refused, error.what());
  } catch (const MemoryError& error) {
    return failure(refused, error.what());
  } catch (const std::bad_alloc&) {
    return failure(refused, "not enough memory");
  } catch (const std::exception& error) {
    return failure(internal_error, fmt::format("internal error: {}", error.what()));
  }
}

/// The first thread that meets the page ends all.
extern "C" void end_for_lost_page(int) {
  static std::atomic_flag met;
  if (met.test_and_set())
    for (;;) ::pause();
  constexpr std::string_view line =
      "soapfilm: a page of a file in use, an input or an array of --scratch, cannot be read or written: its disk "
      "fails, "
      "or the file was made shorter\n";
  [[maybe_unused]] const ssize_t written = ::write(STDERR_FILENO, line.data(), line.size());
  remove_temporary_files();
  ::_exit(refused);
}

}  // namespace

int program(int argc, char** argv) {
  on_lost_page(end_for_lost_page);
  const std::shared_ptr<Ranks> ranks = join_ranks();
  if (ranks) outlive_signals_after_runs();  // they end together: what all have finished is not lost by one of them
  Ending ending = ending_of(argc, argv, ranks);
  if (ranks) ending = leave_ranks(*ranks, ending);
  if (!ending.line.empty() && (!ranks || ranks->rank() == 0)) print(stderr, fmt::format("soapfilm: {}\n", ending.line));
  if (ranks) close_ranks(*ranks);
  return ending.code;
}

}  // namespace soapfilm::cli
