// The options of soapfilm reconstruct.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "cli/detail_levels.h"
#include "soapfilm/io.h"
#include "soapfilm/params.h"

namespace soapfilm::cli {

/// The values of the options, before they are checked.
struct ReconstructOptions {
  std::vector<std::string> inputs;
  ReadOptions read;
  std::string output;
  std::string format;  ///< of standard input and output
  std::string report;
  std::string memory;
  std::string scratch;
  bool resume = false;
  std::string isovalue;
  std::string lambda;
  std::string trim;
  std::string simplify;
  std::string levels_folder;
  std::string split;
  LodCount lod;
  std::vector<double> sensor;
  std::vector<double> anchor;
  std::vector<std::string> attributes;
  bool ascii = false;
  bool check = false;
  bool strict = false;
  bool preview = false;
  ReconstructParams params;
};

void add_reconstruct_options(CLI::App& app, ReconstructOptions& options);

}  // namespace soapfilm::cli
