// For fish 3.
#include <fmt/format.h>

#include "cli/completion.h"

namespace soapfilm::cli {

namespace {

std::string fish_quoted(const std::string& text) {
  std::string quoted = "'";
  for (const char c : text) {
    if (c == '\'' || c == '\\') quoted += '\\';
    quoted += c;
  }
  return quoted + "'";
}

/// The flags of `complete` for what follows an option.
std::string fish_value(const OptionRow& row) {
  const std::string words = fish_quoted(fmt::format("{}", fmt::join(row.words, " ")));
  if (row.takes == Takes::nothing) return "";
  if (row.takes == Takes::folder) return " -x -a '(__fish_complete_directories)'";
  if (row.takes == Takes::file) return " -r -F" + (row.words.empty() ? "" : " -a " + words);
  return " -x" + (row.words.empty() ? "" : " -a " + words);
}

std::string fish_options(const CommandTable& table, const std::string& condition) {
  std::string lines;
  for (const OptionGroup& group : table.groups) {
    for (const OptionRow& row : group.options) {
      lines += "complete -c soapfilm" + condition;
      for (const std::string& name : row.names)
        lines += name.starts_with("--") ? " -l " + name.substr(2) : " -s " + name.substr(1);
      lines += fish_value(row) + " -d " + fish_quoted(row.description) + "\n";
    }
  }
  return lines;
}

}  // namespace

std::string fish_completion(const CompletionSource& source) {
  std::vector<std::string> names;
  for (const CommandTable& command : source.commands) names.push_back(command.name);
  std::string text = fmt::format(
      "# Completion of soapfilm for fish, made by: soapfilm completion fish\n\n"
      "# Whether this is the command of the line; without an argument: whether there is none yet.\n"
      "function __soapfilm_command\n"
      "  for word in (commandline -opc)[2..-1]\n"
      "    if contains -- $word {}\n"
      "      test \"$word\" = \"$argv[1]\"\n"
      "      return\n"
      "    end\n"
      "  end\n"
      "  test -z \"$argv[1]\"\n"
      "end\n\n"
      "complete -c soapfilm -f\n",
      fmt::join(names, " "));
  text += fish_options(source.program, "");
  for (const CommandTable& command : source.commands) {
    text += fmt::format("\ncomplete -c soapfilm -n __soapfilm_command -a {} -d {}\n", command.name,
                        fish_quoted(command.description));
    const std::string condition = fmt::format(" -n '__soapfilm_command {}'", command.name);
    for (const OptionRow& argument : command.arguments) {
      text += "complete -c soapfilm" + condition;
      if (argument.takes == Takes::file) text += " -F";
      if (!argument.words.empty()) text += " -a " + fish_quoted(fmt::format("{}", fmt::join(argument.words, " ")));
      text += "\n";
    }
    text += fish_options(command, condition);
  }
  return text;
}

}  // namespace soapfilm::cli
