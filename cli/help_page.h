// The pages that the program prints about itself.
#pragma once

#include <CLI/CLI.hpp>
#include <cstddef>
#include <string>

namespace soapfilm::cli {

/// Help pages as wide as the terminal, 40 to 120 columns.
class HelpPage : public CLI::Formatter {
 public:
  HelpPage();
  std::string make_option_desc(const CLI::Option* option) const override;
  std::string make_subcommand(const CLI::App* command) const override;
  std::string make_help(const CLI::App* app, std::string name, CLI::AppFormatMode mode) const override;

 private:
  size_t columns_;
};

/// What `soapfilm --help` says after the options.
extern const char* const examples_and_exit_codes;

/// The last line of each command's page.
extern const char* const global_options_note;

/// What `soapfilm` alone prints: the way to a first mesh. Fits a screen of 24 lines.
extern const char* const first_page;

}  // namespace soapfilm::cli
