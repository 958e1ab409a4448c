// JSON as text.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace soapfilm {

/// Indented by 2. Names of files need not be UTF-8: bytes that are not become the replacement character.
inline std::string json_text(const nlohmann::ordered_json& json) {
  return json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

}  // namespace soapfilm
