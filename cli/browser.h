// The desktop's browser.
#pragma once

#include <string>

namespace soapfilm::cli {

/// Opens a file in it and does not wait; false where there is no desktop, or nothing that opens files.
bool open_in_browser(const std::string& path);

}  // namespace soapfilm::cli
