// The pages that the program prints about itself.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace soapfilm::cli {

/// Help pages whose option descriptions are wrapped to the page.
class HelpPage : public CLI::Formatter {
 public:
  HelpPage();
  std::string make_option_desc(const CLI::Option* option) const override;
};

/// What `soapfilm --help` says after the options.
extern const char* const examples_and_exit_codes;

/// The last line of each command's page.
extern const char* const global_options_note;

/// What `soapfilm` alone prints: the way to a first mesh. Fits a screen of 24 lines.
extern const char* const first_page;

}  // namespace soapfilm::cli
