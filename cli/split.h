// --split: a mesh that is too large for one file, as parts.
#pragma once

#include <CLI/CLI.hpp>
#include <cstddef>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "soapfilm/io/parts.h"

namespace soapfilm::cli {

CLI::Option* add_split(CLI::App& app, std::string& text);

/// Triangles of a part at most; none where the option is not given. Throws ParameterError.
std::optional<size_t> part_triangles(const std::string& text);

/// For a report.
nlohmann::ordered_json parts_json(const WrittenParts& written);

}  // namespace soapfilm::cli
