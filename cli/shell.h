// Text that a POSIX shell reads back.
#pragma once

#include <string>
#include <vector>

namespace soapfilm::cli {

/// One word: in single quotes unless it needs none, control characters as $'\ooo', so that it stays on one line.
std::string shell_word(const std::string& text);

/// Words with spaces between them.
std::string shell_words(const std::vector<std::string>& words);

}  // namespace soapfilm::cli
