// Real scans, which are not part of the repository.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string>

namespace soapfilm {

/// A file of the folder named by SOAPFILM_DATA; nothing if that is unset or empty, or has no such file.
inline std::optional<std::string> real_data(const std::string& name) {
  const char* folder = std::getenv("SOAPFILM_DATA");
  if (folder == nullptr || *folder == '\0') return {};
  const auto file = std::filesystem::path(folder) / name;
  return std::filesystem::exists(file) ? std::optional(file.string()) : std::nullopt;
}

}  // namespace soapfilm
