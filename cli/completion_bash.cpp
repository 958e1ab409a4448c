// For bash 4 and newer; needs nothing of the package bash-completion.
#include <fmt/format.h>

#include "cli/completion.h"

namespace soapfilm::cli {

namespace {

constexpr const char* bash_head =
    R"(# Completion of soapfilm for bash, made by: soapfilm completion bash

_soapfilm() {
  local word=${COMP_WORDS[COMP_CWORD]} option=${COMP_WORDS[COMP_CWORD-1]} command= words= i
  # --option=value arrives as three words.
  if [[ $word == = ]]; then
    word=
  elif [[ $option == = ]]; then
    option=${COMP_WORDS[COMP_CWORD-2]}
  fi
  for ((i = 1; i < COMP_CWORD; i++)); do
    case ${COMP_WORDS[i]} in
)";

// Without words bash completes names of files: that is what -o default of the last line says.
constexpr const char* bash_tail =
    R"(  esac
  COMPREPLY=($(compgen -W "$words" -- "$word"))
}

complete -o default -F _soapfilm soapfilm
)";

std::string join(const std::vector<std::string>& words, const char* separator = " ") {
  return fmt::format("{}", fmt::join(words, separator));
}

/// The lines for values of a command's options; `command` is a pattern.
std::string bash_values(const CommandTable& table, const std::string& command) {
  std::string lines;
  for (const OptionGroup& group : table.groups) {
    for (const OptionRow& row : group.options) {
      if (row.takes == Takes::nothing) continue;
      std::vector<std::string> patterns;
      for (const std::string& name : row.names) patterns.push_back(command + ":" + name);
      lines += "    " + join(patterns, " | ") + ")";
      if (row.takes == Takes::folder)
        lines += " compopt -o dirnames +o default; return";
      else if (row.takes == Takes::file && row.words.empty())
        lines += " return";
      else if (row.words.empty())
        lines += " compopt +o default; return";
      else
        lines += " words=\"" + join(row.words) + "\"";
      lines += " ;;\n";
    }
  }
  return lines;
}

std::string bash_options(const CommandTable& table) {
  std::vector<std::string> names;
  for (const OptionGroup& group : table.groups)
    for (const OptionRow& row : group.options) names.insert(names.end(), row.names.begin(), row.names.end());
  return join(names);
}

}  // namespace

std::string bash_completion(const CompletionSource& source) {
  std::vector<std::string> commands;
  for (const CommandTable& command : source.commands) commands.push_back(command.name);
  std::string text = bash_head;
  text += fmt::format("      {})\n        command=${{COMP_WORDS[i]}}\n        break\n        ;;\n    esac\n  done\n",
                      join(commands, " | "));
  text += "  case $command:$option in\n" + bash_values(source.program, "*");
  for (const CommandTable& command : source.commands) text += bash_values(command, command.name);
  // No value of an option: an option, a command or an argument.
  text += "    *)\n      case $command:$word in\n";
  const std::string global = bash_options(source.program);
  for (const CommandTable& command : source.commands) {
    text += fmt::format("        {}:-*) words=\"{} {}\" ;;\n", command.name, bash_options(command), global);
    for (const OptionRow& argument : command.arguments)
      if (!argument.words.empty())
        text += fmt::format("        {}:*) words=\"{}\" ;;\n", command.name, join(argument.words));
  }
  text += fmt::format("        :-*) words=\"{}\" ;;\n", global);
  text +=
      fmt::format("        :*)\n          words=\"{}\"\n          compopt +o default\n          ;;\n", join(commands));
  return text + "      esac\n      ;;\n" + bash_tail;
}

}  // namespace soapfilm::cli
