// Text of files and users for messages and names of one line.
#pragma once

#include <algorithm>
#include <string>

namespace soapfilm {

inline bool is_control(char c) { return static_cast<unsigned char>(c) < ' ' || c == '\x7f'; }

/// With '?' for control characters.
inline std::string printable(std::string text) {
  std::replace_if(text.begin(), text.end(), is_control, '?');
  return text;
}

}  // namespace soapfilm
