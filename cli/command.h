// Common parts of main() and the sub-commands.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "soapfilm/core/ranks.h"

namespace soapfilm::cli {

/// Options before or after any sub-command.
struct GlobalOptions {
  int threads = 0;  ///< 0: all that the process may use
  bool quiet = false;
  bool verbose = false;
  std::string command{};                 ///< the command line as typed, for reports
  std::vector<std::string> arguments{};  ///< its words after the program's name
  std::shared_ptr<Ranks> ranks{};        ///< of a run on several processes; else null

  /// Whether this process prints and writes.
  bool speaks() const { return !ranks || ranks->rank() == 0; }
};

/// Set by the sub-command that was chosen; returns the exit code.
using Runner = std::function<int()>;

void add_reconstruct(CLI::App& app, const GlobalOptions& options, Runner& runner);
void add_scan(CLI::App& app, const GlobalOptions& options, Runner& runner);
void add_evaluate(CLI::App& app, const GlobalOptions& options, Runner& runner);
void add_compare(CLI::App& app, const GlobalOptions& options, Runner& runner);
void add_measure(CLI::App& app, const GlobalOptions& options, Runner& runner);
void add_simplify(CLI::App& app, const GlobalOptions& options, Runner& runner);
void add_remesh(CLI::App& app, const GlobalOptions& options, Runner& runner);
void add_info(CLI::App& app, const GlobalOptions& options, Runner& runner);
void add_render(CLI::App& app, const GlobalOptions& options, Runner& runner);
void add_view(CLI::App& app, const GlobalOptions& options, Runner& runner);
void add_tiles(CLI::App& app, const GlobalOptions& options, Runner& runner);

/// Hidden commands for packages and shells: they print what is made from the options of all other commands.
void add_completion(CLI::App& app, Runner& runner);
void add_man(CLI::App& app, Runner& runner);

}  // namespace soapfilm::cli
