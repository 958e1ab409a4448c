// --lod: the levels of detail beside a simplified mesh.
#pragma once

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "soapfilm/context.h"
#include "soapfilm/io/levels.h"
#include "soapfilm/simplify.h"

namespace soapfilm::cli {

/// How many further levels.
using LodCount = std::optional<int>;

CLI::Option* add_lod(CLI::App& app, LodCount& count);

/// All files that the levels go to, `output` first. Throws ParameterError for a count out of range.
std::vector<std::string> lod_files(const std::string& output, LodCount count);

/// The mesh, and levels coarser than it where they are asked for. Warns where there are fewer: a mesh that took
/// long to compute is kept.
std::vector<DetailLevel> detail_levels(Simplified first, LodCount count, const Context& context);

/// One line for each level but the first.
void announce_levels(const std::string& output, const std::vector<DetailLevel>& levels, Progress& progress);

/// The same for a report: of all levels, the finest first.
nlohmann::ordered_json levels_json(const std::string& output, const std::vector<DetailLevel>& levels);

}  // namespace soapfilm::cli
