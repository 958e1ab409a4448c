// The options of the program's commands as a table: what help, completion and man pages are made of.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace soapfilm::cli {

enum class Takes { nothing, file, folder, value };

/// An option, or an argument without a name of its own.
struct OptionRow {
  std::vector<std::string> names;  ///< such as -o and --output; of an argument what it is called
  bool argument = false;
  bool many = false;               ///< an argument that may be given several times
  Takes takes = Takes::value;      ///< what follows it
  std::string value;               ///< what that is called, such as FILE
  std::string standard;            ///< the value that it has if it is not given; empty: said in the description
  std::string description;         ///< one line
  std::vector<std::string> words;  ///< values that it knows
};

struct OptionGroup {
  std::string title;
  std::vector<OptionRow> options;
};

struct CommandTable {
  std::string name;  ///< empty: the program itself
  std::string description;
  std::string footer;
  std::vector<OptionRow> arguments;
  std::vector<OptionGroup> groups;
};

/// Of a command, or of the program. Hidden options are left out.
CommandTable command_table(const CLI::App& app);

/// Of the program's commands, without hidden ones.
std::vector<CommandTable> command_tables(const CLI::App& program);

/// All names of its options, such as --output; those of one letter only if asked for.
std::vector<std::string> option_names(const CLI::App& app, bool short_ones = false);

/// The words that its validators know: see named(), one_of() and also() of parse.h.
std::vector<std::string> known_words(const CLI::Option& option);

}  // namespace soapfilm::cli
