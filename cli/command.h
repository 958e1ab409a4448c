// Common parts of main() and the sub-commands.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <string>

namespace soapfilm::cli {

/// Options before or after any sub-command.
struct GlobalOptions {
  int threads = 0;  ///< 0: all that the process may use
  bool quiet = false;
  bool verbose = false;
  std::string command{};  ///< the command line as typed, for reports
};

/// Set by the sub-command that was chosen; returns the exit code.
using Runner = std::function<int()>;

void add_reconstruct(CLI::App& app, const GlobalOptions& options, Runner& runner);
void add_scan(CLI::App& app, const GlobalOptions& options, Runner& runner);
void add_evaluate(CLI::App& app, const GlobalOptions& options, Runner& runner);
void add_info(CLI::App& app, const GlobalOptions& options, Runner& runner);
void add_render(CLI::App& app, const GlobalOptions& options, Runner& runner);
void add_view(CLI::App& app, const GlobalOptions& options, Runner& runner);

}  // namespace soapfilm::cli
