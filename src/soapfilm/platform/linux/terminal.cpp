#include "soapfilm/platform/terminal.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <cstdlib>
#include <string_view>

namespace soapfilm {

bool is_terminal(std::FILE* out) {
  const char* type = std::getenv("TERM");
  return isatty(fileno(out)) != 0 && !(type && std::string_view(type) == "dumb");
}

size_t terminal_columns(std::FILE* out) {
  winsize size{};
  return ioctl(fileno(out), TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : 80;
}

}  // namespace soapfilm
