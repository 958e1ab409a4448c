// For zsh's own completion system (compinit).
#include <fmt/format.h>

#include "cli/completion.h"

namespace soapfilm::cli {

namespace {

/// Within single quotes.
std::string zsh_quoted(const std::string& text) {
  std::string quoted;
  for (const char c : text) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted;
}

/// A description or message of _arguments.
std::string zsh_text(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    if (c == ':' || c == '[' || c == ']' || c == '\\') escaped += '\\';
    escaped += c;
  }
  return zsh_quoted(escaped);
}

/// ":MESSAGE:ACTION" of what an option takes or an argument is.
std::string zsh_action(const OptionRow& row) {
  const std::string message = row.value.empty() ? row.names[0] : row.value;
  std::string action = " ";  // any value
  if (!row.words.empty()) {
    action = fmt::format("({})", fmt::join(row.words, " "));
    if (row.takes == Takes::file) action = fmt::format("{{compadd - {}; _files}}", fmt::join(row.words, " "));
  } else if (row.takes == Takes::folder) {
    action = "_files -/";
  } else if (row.takes == Takes::file) {
    action = "_files";
  }
  return ":" + zsh_text(message) + ":" + action;
}

std::string zsh_option(const OptionRow& row) {
  const std::string text = "[" + zsh_text(row.description) + "]";
  std::string value = row.takes == Takes::nothing ? "" : zsh_action(row);
  std::vector<std::string> names;
  for (const std::string& name : row.names)  // --name=: the value may follow '=' or be the next word
    names.push_back(name + (value.empty() ? "" : name.starts_with("--") ? "=" : "+"));
  if (names.size() == 1) return fmt::format("'{}{}{}'", names[0], text, value);
  return fmt::format("'({})'{{{}}}'{}{}'", fmt::join(row.names, " "), fmt::join(names, ","), text, value);
}

std::string zsh_options(const CommandTable& table, const char* indent) {
  std::string lines;
  for (const OptionGroup& group : table.groups)
    for (const OptionRow& row : group.options) lines += fmt::format(" \\\n{}{}", indent, zsh_option(row));
  return lines;
}

}  // namespace

std::string zsh_completion(const CompletionSource& source) {
  std::string text =
      "#compdef soapfilm\n"
      "# Completion of soapfilm for zsh, made by: soapfilm completion zsh\n\n"
      "_soapfilm() {\n"
      "  local curcontext=$curcontext state line\n"
      "  typeset -A opt_args\n"
      "  local -a commands=(\n";
  for (const CommandTable& command : source.commands)
    text += fmt::format("    '{}:{}'\n", command.name, zsh_quoted(command.description));
  text += "  )\n  _arguments -C" + zsh_options(source.program, "    ") +
          " \\\n    '1: :->command' '*:: :->rest'\n"
          "  case $state in\n"
          "    command) _describe -t commands command commands ;;\n"
          "    rest)\n"
          "      case $words[1] in\n";
  for (const CommandTable& command : source.commands) {
    text += fmt::format("        {})\n          _arguments", command.name) + zsh_options(command, "            ") +
            zsh_options(source.program, "            ");
    for (const OptionRow& argument : command.arguments)
      text += fmt::format(" \\\n            '{}{}'", argument.many ? "*" : "1", zsh_action(argument));
    text += "\n          ;;\n";
  }
  return text +
         "      esac\n"
         "      ;;\n"
         "  esac\n"
         "}\n\n"
         "# Read by compinit from $fpath, or by: source <(soapfilm completion zsh)\n"
         "if [[ $funcstack[1] == _soapfilm ]]; then _soapfilm \"$@\"; else compdef _soapfilm soapfilm; fi\n";
}

}  // namespace soapfilm::cli
