// soapfilm man [COMMAND]: hidden. Manual pages made from the options, so that these are written once.
#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "cli/build_facts.h"
#include "cli/command.h"
#include "cli/help_page.h"
#include "cli/option_table.h"
#include "cli/parse.h"
#include "cli/print.h"
#include "soapfilm/version.h"

namespace soapfilm::cli {

namespace {

/// Text of a line: a backslash, a hyphen that can be copied, and no request by accident.
std::string roff(const std::string& text) {
  std::string escaped = text.starts_with('.') || text.starts_with('\'') ? "\\&" : "";
  for (const char c : text) escaped += c == '\\' ? "\\e" : c == '-' ? "\\-" : std::string(1, c);
  return escaped;
}

/// A paragraph in lines of some length; mandoc asks for lines under 80 bytes.
std::string roff_paragraph(const std::string& text) {
  constexpr size_t longest = 72;
  std::string lines, line;
  for (size_t begin = 0; begin < text.size();) {
    const size_t end = std::min(text.find_first_of(" \n", begin), text.size());
    const std::string word = text.substr(begin, end - begin);
    begin = end + 1;
    if (word.empty()) continue;
    if (!line.empty() && line.size() + word.size() >= longest) {
      lines += roff(line) + "\n";
      line.clear();
    }
    line += (line.empty() ? "" : " ") + word;
  }
  return lines + (line.empty() ? "" : roff(line) + "\n");
}

std::string capitalized(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  return text;
}

/// "EXAMPLES" and "WRITES" of a footer become sections, their lines stay as they are.
std::string man_footer(std::string footer) {
  if (const size_t note = footer.find(global_options_note); note != std::string::npos) footer.erase(note);
  std::string text, sections;
  bool verbatim = false;
  for (size_t begin = 0; begin < footer.size();) {
    const size_t end = std::min(footer.find('\n', begin), footer.size());
    const std::string line = footer.substr(begin, end - begin);
    begin = end + 1;
    if (line.empty()) continue;
    const bool title = line.find_first_not_of("ABCDEFGHIJKLMNOPQRSTUVWXYZ ") == std::string::npos;
    const bool indented = line.starts_with("  ");
    if (verbatim && !indented) sections += ".EE\n";
    if (!verbatim && indented) sections += ".EX\n";
    verbatim = indented;
    sections += title ? ".SH " + line + "\n" : indented ? roff(line.substr(2)) + "\n" : roff_paragraph(line);
  }
  return sections + (verbatim ? ".EE\n" : "");
}

std::string man_option(const OptionRow& row) {
  std::string text = ".TP\n";
  for (const std::string& name : row.names)
    text += (name == row.names[0] ? "" : ", ") +
            fmt::format("\\f{}{}\\fR", row.argument ? 'I' : 'B', roff(row.argument ? capitalized(name) : name));
  if (row.argument) return text + (row.many ? "..." : "") + "\n" + roff_paragraph(row.description);
  if (!row.value.empty()) text += " \\fI" + roff(row.value) + "\\fR";
  text += "\n" + roff_paragraph(row.description);
  return row.standard.empty() ? text : text + roff_paragraph("(default: " + row.standard + ")");
}

std::string man_options(const CommandTable& table) {
  std::string text = ".SH OPTIONS\n";
  for (const OptionRow& argument : table.arguments) text += man_option(argument);
  for (const OptionGroup& group : table.groups) {
    if (group.title != "Options") text += ".SS " + group.title + "\n";
    for (const OptionRow& row : group.options) text += man_option(row);
  }
  return text;
}

std::string man_head(const std::string& title, const std::string& description) {
  std::string what = description.substr(0, description.find(": "));
  if (!what.empty()) what[0] = static_cast<char>(std::tolower(static_cast<unsigned char>(what[0])));
  return fmt::format(
      ".\\\" Made by: soapfilm man\n.TH {} 1 \"{}\" \"soapfilm {}\" \"User Commands\"\n.SH NAME\n{} \\- {}\n",
      capitalized(roff(title)), release_date, version, roff(title), roff(what));
}

std::string see_also(const std::vector<std::string>& pages) {
  std::string text = ".SH SEE ALSO\n";
  for (const std::string& page : pages)
    text += fmt::format(".BR {} (1){}\n", roff(page), page == pages.back() ? "" : ",");
  return text;
}

std::string program_page(const CommandTable& program, const std::vector<CommandTable>& commands) {
  std::string text = man_head("soapfilm", program.description);
  text += ".SH SYNOPSIS\n.B soapfilm\n.RI [ options ]\n.I command\n.RI [ arguments ]\n";
  text += ".SH DESCRIPTION\n" + roff_paragraph(program.description) +
          ".PP\nEach command has a page of its own.\n.SS Commands\n";
  std::vector<std::string> pages;
  for (const CommandTable& command : commands) {
    text += fmt::format(".TP\n\\fB{}\\fR\n", command.name) + roff_paragraph(command.description);
    pages.push_back("soapfilm-" + command.name);
  }
  return text + man_options(program) + man_footer(program.footer) + see_also(pages);
}

std::string command_page(const CommandTable& command, const CommandTable& program,
                         const std::vector<CommandTable>& commands) {
  std::string text = man_head("soapfilm-" + command.name, command.description);
  text += fmt::format(".SH SYNOPSIS\n.B soapfilm {}\n.RI [ options ]\n", command.name);
  for (const OptionRow& argument : command.arguments)
    text += fmt::format(".IR {}{}\n", roff(capitalized(argument.names[0])), argument.many ? " ..." : "");
  text += ".SH DESCRIPTION\n" + roff_paragraph(command.description + ".") + man_options(command);
  text += ".SS Of all commands\n";
  for (const OptionGroup& group : program.groups)
    for (const OptionRow& row : group.options)
      if (row.names.back() != "--help" && row.names.back() != "--version") text += man_option(row);
  std::vector<std::string> pages{"soapfilm"};
  for (const CommandTable& other : commands)
    if (other.name != command.name) pages.push_back("soapfilm-" + other.name);
  return text + man_footer(command.footer) + see_also(pages);
}

}  // namespace

void add_man(CLI::App& app, Runner& runner) {
  CLI::App* command = app.add_subcommand("man", "Print the manual page of the program or of a command, as roff");
  command->group("");  // hidden
  command->footer("");
  std::vector<std::string> names;
  for (const CommandTable& one : command_tables(app)) names.push_back(one.name);
  auto page = std::make_shared<std::string>();
  command->add_option("command", *page, "The command")->check(one_of(names))->option_text("COMMAND");
  command->callback([&app, page, &runner] {
    runner = [&app, page] {
      const CommandTable program = command_table(app);
      const std::vector<CommandTable> commands = command_tables(app);
      std::string text = program_page(program, commands);
      for (const CommandTable& one : commands)
        if (one.name == *page) text = command_page(one, program, commands);
      print(stdout, text);
      return 0;
    };
  });
}

}  // namespace soapfilm::cli
