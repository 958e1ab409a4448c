// Reads the samples of a command; common to all commands.
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <string>
#include <vector>

#include "soapfilm/cloud.h"
#include "soapfilm/context.h"
#include "soapfilm/io.h"
#include "soapfilm/progress.h"

namespace soapfilm::cli {

/// Options for what a file cannot say by itself.
void add_read_options(CLI::App& app, ReadOptions& options);

/// Several files are several scans. Warns of what was ignored while reading.
PointCloud read_cloud(const std::vector<std::string>& files, const ReadOptions& options, const Context& context,
                      ReadReport& read);

/// The file's or folder's path with a name at its end: that of a folder may be given as "tiles/" or ".".
std::filesystem::path named_path(const std::string& input);

/// What a file says and was not used.
void warn_of(const ReadReport& read, Progress& progress);

/// Rays that met nothing, of all files.
size_t no_returns(const ReadReport& read);

}  // namespace soapfilm::cli
