#include "cli/shell.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include "soapfilm/core/printable.h"

namespace soapfilm::cli {

std::string shell_word(const std::string& text) {
  constexpr std::string_view harmless = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-+=:,./@%";
  if (!text.empty() && text.find_first_not_of(harmless) == std::string::npos) return text;
  const bool control = std::any_of(text.begin(), text.end(), is_control);
  std::string word = control ? "$'" : "'";
  for (const char c : text) {
    if (is_control(c))
      word += fmt::format("\\{:03o}", static_cast<unsigned char>(c));
    else if (control && (c == '\'' || c == '\\'))
      word += std::string("\\") + c;
    else if (c == '\'')
      word += "'\\''";
    else
      word += c;
  }
  return word + "'";
}

std::string shell_words(const std::vector<std::string>& words) {
  std::string line;
  for (const std::string& word : words) line += (line.empty() ? "" : " ") + shell_word(word);
  return line;
}

}  // namespace soapfilm::cli
