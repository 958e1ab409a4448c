// Scripts that complete the program's command line, made from its options.
#pragma once

#include <string>
#include <vector>

#include "cli/option_table.h"

namespace soapfilm::cli {

/// What a shell must know.
struct CompletionSource {
  CommandTable program;
  std::vector<CommandTable> commands;
};

std::string bash_completion(const CompletionSource& source);
std::string zsh_completion(const CompletionSource& source);
std::string fish_completion(const CompletionSource& source);

}  // namespace soapfilm::cli
