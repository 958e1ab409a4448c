#include "soapfilm/platform/terminal.h"

namespace soapfilm {

bool is_terminal(std::FILE*) { return false; }

size_t terminal_columns(std::FILE*) { return 80; }

}  // namespace soapfilm
