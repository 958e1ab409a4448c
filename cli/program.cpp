#include "cli/program.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <iostream>
#include <memory>
#include <new>
#include <string>
#include <vector>

#include "cli/command.h"
#include "cli/print.h"
#include "soapfilm/error.h"
#include "soapfilm/reconstruct.h"
#include "soapfilm/version.h"

namespace soapfilm::cli {
namespace {

enum ExitCode { success = 0, internal_error = 1, refused = 2, empty = 3, cancelled = 130 };

constexpr const char* examples_and_codes =
    R"(EXAMPLES
  A Stanford scan set becomes a watertight mesh, 512 grid vertices along its longest side:
      soapfilm reconstruct bun.conf -o bunny.ply --resolution 512
  What is in a file:
      soapfilm info scan.ply
  Scans of a built-in shape, with the truth beside them:
      soapfilm scan part -o scans
  How far a mesh is from the truth:
      soapfilm evaluate mesh.ply --truth part
  A picture of two meshes side by side:
      soapfilm render truth.ply mesh.ply -o both.png
  A page for the browser: turn, cut, measure:
      soapfilm view bun.conf bunny.ply

EXIT CODES
  0    success
  1    internal error
  2    refused: input, parameter, output or memory; the message names it, nothing is half-written
  3    the optimal surface is empty; the message names the largest lambda that keeps one
  4    with reconstruct --strict: written, but over 1 % of the samples are far from the mesh
  130  cancelled (Ctrl-C); nothing was written
)";

/// Prints one line on stderr, whatever the message contains.
int fail(ExitCode code, std::string message) {
  while (!message.empty() && std::isspace(static_cast<unsigned char>(message.back()))) message.pop_back();
  std::replace(message.begin(), message.end(), '\n', ' ');
  print(stderr, fmt::format("soapfilm: {}\n", message));
  return code;
}

/// The kind of number that an option takes; empty if it takes none.
std::string number_kind(const CLI::Option& option) {
  const std::string type = option.get_type_name();
  if (type.starts_with("FLOAT")) return "a number";
  if (type.starts_with("INT")) return "a whole number";
  if (type.starts_with("UINT")) return "a whole number >= 0";
  return "";
}

/// CLI11 would read an empty text, such as of an unset shell variable, as 0.
void refuse_empty_numbers(CLI::App& app) {
  for (CLI::Option* option : app.get_options()) {
    const std::string kind = number_kind(*option);
    if (kind.empty()) continue;
    const auto refuse = [kind](const std::string& text) { return text.empty() ? "no value, must be " + kind : ""; };
    option->transform(CLI::Validator(refuse, ""));
  }
}

/// The text after CLI11's "Could not convert: --name = value".
std::string constraint(const CLI::App& command, const std::string& what) {
  const size_t name = what.find("--"), end = what.find(" = ");
  if (name >= end || end == std::string::npos) return "";
  const CLI::Option* option = nullptr;
  for (const CLI::App* app = &command; app && !option; app = app->get_parent())
    option = app->get_option_no_throw(what.substr(name, end - name));
  const std::string kind = option ? number_kind(*option) : "";
  return kind.empty() ? "" : ", must be " + kind;
}

/// CLI11 does not say whether an unexpected word is an option or a command, nor where to read more.
std::string parse_message(const CLI::App& app, const CLI::ParseError& error) {
  const std::vector<CLI::App*> chosen = app.get_subcommands();
  std::string what = error.what();
  const auto code = static_cast<CLI::ExitCodes>(error.get_exit_code());
  if (code == CLI::ExitCodes::ConversionError) what += constraint(chosen.empty() ? app : *chosen[0], what);
  const std::vector<std::string> extras = app.remaining(true);
  // Something unknown often explains why something required is missing.
  if (!extras.empty() && (code == CLI::ExitCodes::ExtrasError || code == CLI::ExitCodes::RequiredError)) {
    const bool option = extras[0].size() > 1 && extras[0][0] == '-';
    what = fmt::format("unknown {} '{}'", option ? "option" : chosen.empty() ? "command" : "argument", extras[0]);
  }
  return fmt::format("{} (see soapfilm {}--help)", what, chosen.empty() ? "" : chosen[0]->get_name() + " ");
}

/// Help pages whose option descriptions are wrapped to the page.
class Page : public CLI::Formatter {
 public:
  Page() { column_width(name_columns); }

  std::string make_option_desc(const CLI::Option* option) const override {
    std::string text = CLI::Formatter::make_option_desc(option);
    size_t line = 0;  // where the current line begins
    for (size_t at = 0, space = 0; at < text.size(); ++at) {
      if (text[at] == '\n') line = space = at + 1;
      if (text[at] == ' ') space = at;
      if (at - line < page_columns - name_columns || space <= line) continue;
      text[space] = '\n';
      line = space + 1;
    }
    return text;
  }

 private:
  static constexpr size_t name_columns = 30;
  static constexpr size_t page_columns = 100;
};

void add_global_options(CLI::App& app, GlobalOptions& options) {
  app.add_option("--threads", options.threads, "Threads to use; 0, the default: all that the process may use")
      ->check(CLI::Range(0, 1024))
      ->option_text("N");
  CLI::Option* quiet = app.add_flag("-q,--quiet", options.quiet, "Print warnings and errors only")->option_text(" ");
  app.add_flag("-v,--verbose", options.verbose, "Print details too")->excludes(quiet)->option_text(" ");
  app.set_version_flag("--version", "soapfilm " + std::string(version), "Print the version and exit");
  app.set_help_flag("-h,--help", "Print this page and exit");
}

int run(int argc, char** argv) {
  CLI::App app(
      "Turns raw 3D scans into a watertight surface: a minimal surface over the samples,\n"
      "with a proof of how close it is to the global optimum.",
      "soapfilm");
  app.require_subcommand(1);
  app.fallthrough();  // sub-commands inherit it: global options may follow them
  app.formatter(std::make_shared<Page>());
  GlobalOptions options;
  options.command = fmt::format("soapfilm {}", fmt::join(argv + 1, argv + argc, " "));
  Runner runner;
  add_global_options(app, options);
  add_reconstruct(app, options, runner);
  add_scan(app, options, runner);
  add_evaluate(app, options, runner);
  add_info(app, options, runner);
  add_render(app, options, runner);
  add_view(app, options, runner);
  app.footer(examples_and_codes);  // last: sub-commands would inherit it
  refuse_empty_numbers(app);
  for (CLI::App* command : app.get_subcommands({})) {
    refuse_empty_numbers(*command);
    const std::string own = command->get_footer();
    command->footer(own + (own.empty() ? "" : "\n") +
                    "Global options (--threads, --quiet, --verbose): soapfilm --help");
  }

  if (argc == 1) {
    std::cout << app.help();
    return success;
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& asked_for_help) {
    return app.exit(asked_for_help);
  } catch (const CLI::ParseError& error) {
    return fail(refused, parse_message(app, error));
  }
  return runner();
}

/// Results may go to standard output; a full disk there must be an error.
int finish(int code) {
  std::cout.flush();
  if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0 || !std::cout)
    return fail(refused, "standard output: cannot write");
  return code;
}

}  // namespace

int program(int argc, char** argv) {
  try {
    return finish(run(argc, argv));
  } catch (const Cancelled& error) {
    return fail(cancelled, error.what());
  } catch (const EmptyResult& error) {
    return fail(empty, error.what());
  } catch (const ParameterError& error) {
    return fail(refused, error.what());
  } catch (const InputError& error) {
    return fail(refused, error.what());
  } catch (const OutputError& error) {
    return fail(refused, error.what());
  } catch (const MemoryError& error) {
    return fail(refused, error.what());
  } catch (const std::bad_alloc&) {
    return fail(refused, "not enough memory");
  } catch (const std::exception& error) {
    return fail(internal_error, fmt::format("internal error: {}", error.what()));
  }
}

}  // namespace soapfilm::cli
