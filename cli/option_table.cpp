#include "cli/option_table.h"

#include <fmt/format.h>

#include <algorithm>

namespace soapfilm::cli {

namespace {

std::string one_line(std::string text) {
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}

Takes kind_of_value(const std::string& value) {
  if (value.empty()) return Takes::nothing;
  if (value == "DIR") return Takes::folder;
  for (const char* file : {"FILE", "MESH", "CLOUD"})
    if (value.find(file) != std::string::npos) return Takes::file;
  return Takes::value;
}

OptionRow row_of(const CLI::Option& option) {
  OptionRow row;
  row.argument = option.get_positional();
  if (row.argument) {
    row.names = {option.get_name(true, false)};
    row.many = option.get_expected_max() >= CLI::detail::expected_max_vector_size;
  } else {
    for (const std::string& name : option.get_snames()) row.names.push_back("-" + name);
    for (const std::string& name : option.get_lnames()) row.names.push_back("--" + name);
  }
  if (option.get_items_expected_max() > 0) {
    // Written as "NAME [default]" for the help page.
    const std::string text = option.get_option_text().empty() ? option.get_type_name() : option.get_option_text();
    const size_t bracket = text.find('[');
    row.value = text.substr(0, bracket);
    while (row.value.ends_with(' ')) row.value.pop_back();
    if (bracket != std::string::npos) row.standard = text.substr(bracket + 1, text.find(']') - bracket - 1);
  }
  row.takes = kind_of_value(row.argument ? row.names[0] + row.value : row.value);
  row.description = one_line(option.get_description());
  row.words = known_words(option);
  return row;
}

}  // namespace

std::vector<std::string> known_words(const CLI::Option& option) {
  std::vector<std::string> words;
  const std::string type = option.get_type_name();  // CLI11 appends "{a,b,c}" of each validator
  for (size_t begin = type.find('{'); begin != std::string::npos; begin = type.find('{', begin)) {
    const size_t end = std::min(type.find('}', begin), type.size());
    while (begin < end) {
      const size_t next = std::min(type.find(',', begin + 1), end);
      words.push_back(type.substr(begin + 1, next - begin - 1));
      begin = next;
    }
  }
  return words;
}

CommandTable command_table(const CLI::App& app) {
  CommandTable table{app.get_parent() ? app.get_name() : "", one_line(app.get_description()), app.get_footer(), {}, {}};
  for (const std::string& title : app.get_groups()) {
    if (title.empty()) continue;
    OptionGroup group{title, {}};
    for (const CLI::Option* option :
         app.get_options([&](const CLI::Option* one) { return one->get_group() == title; })) {
      if (option->get_positional())
        table.arguments.push_back(row_of(*option));
      else
        group.options.push_back(row_of(*option));
    }
    if (!group.options.empty()) table.groups.push_back(std::move(group));
  }
  return table;
}

std::vector<CommandTable> command_tables(const CLI::App& program) {
  std::vector<CommandTable> tables;
  for (const CLI::App* command : program.get_subcommands([](const CLI::App* one) { return !one->get_group().empty(); }))
    tables.push_back(command_table(*command));
  return tables;
}

std::vector<std::string> option_names(const CLI::App& app, bool short_ones) {
  std::vector<std::string> names;
  for (const OptionGroup& group : command_table(app).groups)
    for (const OptionRow& row : group.options)
      for (const std::string& name : row.names)
        if (short_ones || name.starts_with("--")) names.push_back(name);
  return names;
}

}  // namespace soapfilm::cli
