#include "cli/refusal.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <regex>
#include <system_error>

#include "cli/option_table.h"
#include "cli/suggest.h"
#include "soapfilm/error.h"

namespace soapfilm::cli {

namespace {

/// The kind of number that an option takes; empty if it takes none.
std::string number_kind(const CLI::Option& option) {
  const std::string type = option.get_type_name();
  if (type.starts_with("FLOAT")) return "a number";
  if (type.starts_with("INT")) return "a whole number";
  if (type.starts_with("UINT")) return "a whole number >= 0";
  return "";
}

/// The option that CLI11's text about a value names; null: none is.
const CLI::Option* option_in(const CLI::App& command, const std::string& what) {
  const size_t name = what.find('-'), end = what.find_first_of(" :", name);
  if (name == std::string::npos || end == std::string::npos) return nullptr;
  for (const CLI::App* app = &command; app; app = app->get_parent())
    if (const CLI::Option* option = app->get_option_no_throw(what.substr(name, end - name))) return option;
  return nullptr;
}

/// What CLI11 says of a value, as the program's other messages say it: option = value, must be so.
std::string in_own_words(const CLI::App& command, const std::string& what) {
  const CLI::Option* option = option_in(command, what);
  if (!option) return what;
  const std::string name = option->get_name(), kind = number_kind(*option);
  const std::string must = kind.empty() ? "" : ", must be " + kind;
  static const std::regex unread("Could not convert: \\S+ = ([^]*)"), no_value(".*: 1 required .*missing.*"),
      range(".*: Value ([^]*) not in range (\\S+) to (\\S+)"), word(".*: Value ([^]*) (must be one of [^]*)"),
      count(".*: (?:At least |At most )?(\\d+) required but received (\\d+)");
  std::smatch part;
  if (std::regex_match(what, part, unread)) return fmt::format("{} = {}{}", name, part.str(1), must);
  if (std::regex_match(what, part, range))
    return fmt::format("{} = {}, must be a {} from {} to {}", name, part.str(1),
                       kind == "a number" ? "number" : "whole number", part.str(2), part.str(3));
  if (std::regex_match(what, part, word)) return fmt::format("{} = {}, {}", name, part.str(1), part.str(2));
  if (std::regex_match(what, part, count))
    return fmt::format("{}: {} values, must be {}", name, part.str(2), part.str(1));
  const std::vector<std::string> words = known_words(*option);
  if (std::regex_match(what, no_value))
    return fmt::format("{}: no value{}", name,
                       !must.empty()   ? must
                       : words.empty() ? std::string(", must have one")
                                       : fmt::format(", must be one of {}", fmt::join(words, ", ")));
  return what;
}

std::vector<const CLI::App*> commands_of(const CLI::App& program) {
  return program.get_subcommands([](const CLI::App* one) { return !one->get_group().empty(); });
}

std::string unknown_option(const CLI::App& program, const CLI::App* command, const std::string& typed) {
  const std::string name = typed.substr(0, typed.find('='));
  std::vector<std::string> known = option_names(program);
  if (command)
    for (std::string& one : option_names(*command)) known.push_back(std::move(one));
  std::string hint = did_you_mean(name, known);
  if (hint.empty()) {
    // Another command's, or one before the command was named.
    std::vector<std::string> owners;
    for (const CLI::App* other : commands_of(program))
      if (const CLI::Option* option = other->get_option_no_throw(name); option && !option->get_positional())
        owners.push_back("soapfilm " + other->get_name());
    if (!owners.empty()) hint = fmt::format(", it is one of {}", fmt::join(owners, ", "));
  }
  return fmt::format("unknown option '{}'{}", typed, hint);
}

std::string unknown_command(const CLI::App& program, const std::string& typed) {
  std::vector<std::string> known{"--help", "--version"};
  for (const CLI::App* command : commands_of(program)) known.push_back(command->get_name());
  std::error_code error;
  if (std::filesystem::is_regular_file(typed, error))
    return fmt::format("unknown command '{}', for this file: soapfilm reconstruct {}", typed, typed);
  return fmt::format("unknown command '{}'{}", typed, did_you_mean(typed, known));
}

}  // namespace

void refuse_empty_numbers(CLI::App& app) {
  for (CLI::Option* option : app.get_options()) {
    const std::string kind = number_kind(*option);
    if (kind.empty()) continue;
    const auto refuse = [kind](const std::string& text) { return text.empty() ? "no value, must be " + kind : ""; };
    option->transform(CLI::Validator(refuse, ""));
  }
}

void refuse_single_dashes(const CLI::App& program, const std::vector<std::string>& arguments) {
  const CLI::App* command = nullptr;
  for (const std::string& argument : arguments) {
    if (argument == "--") return;
    if (!command && !argument.starts_with('-'))
      for (const CLI::App* one : program.get_subcommands([](const CLI::App*) { return true; }))
        if (one->check_name(argument)) command = one;
    if (argument.size() < 3 || argument[0] != '-' || argument[1] == '-') continue;
    const std::string name = "-" + argument.substr(0, argument.find('='));
    const auto has = [&](const CLI::App& app) {
      const CLI::Option* option = app.get_option_no_throw(name);
      return option && option->check_name(name);
    };
    if (has(program) || (command && has(*command)))
      throw ParameterError(fmt::format("unknown option '{}', did you mean '{}'?", argument, name));
  }
}

std::string parse_message(const CLI::App& program, const CLI::ParseError& error) {
  const std::vector<CLI::App*> chosen = program.get_subcommands();
  const CLI::App* command = chosen.empty() ? nullptr : chosen[0];
  std::string what = error.what();
  const auto code = static_cast<CLI::ExitCodes>(error.get_exit_code());
  what = in_own_words(command ? *command : program, what);
  const std::vector<std::string> extras = program.remaining(true);
  // Something unknown often explains why something required is missing.
  if (!extras.empty() && (code == CLI::ExitCodes::ExtrasError || code == CLI::ExitCodes::RequiredError)) {
    const std::string& first = extras[0];
    what = first.size() > 1 && first[0] == '-' ? unknown_option(program, command, first)
           : command                           ? fmt::format("unknown argument '{}'", first)
                                               : unknown_command(program, first);
  }
  return fmt::format("{} (see soapfilm {}--help)", what, command ? command->get_name() + " " : "");
}

}  // namespace soapfilm::cli
