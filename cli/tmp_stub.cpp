#include "cli/command.h"
namespace soapfilm::cli {
void add_scan(CLI::App&, const GlobalOptions&, Runner&) {}
void add_info(CLI::App&, const GlobalOptions&, Runner&) {}
void add_render(CLI::App&, const GlobalOptions&, Runner&) {}
}  // namespace soapfilm::cli
