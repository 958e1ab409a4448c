// The options of soapfilm scan, and what they mean for an object of a given size.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "cli/object.h"
#include "soapfilm/core/vec.h"
#include "tools/scanner/missing.h"
#include "tools/scanner/sample_surface.h"
#include "tools/scanner/virtual_scan.h"

namespace soapfilm::cli {

/// What determines the outer side at a sample of --samples.
enum class Directions { normals, views };

/// The values of the options, before they are checked. Lengths may be given in percent of the longest side.
struct ScanOptions {
  ObjectOptions object;
  std::string folder;
  std::string image;
  std::string step, noise, misalignment, max_range;
  std::string span, ghost_depth;
  std::vector<std::string> positions;
  std::string target;
  ScannerParams scanner;
  long long samples = 0;
  Directions directions = Directions::normals;
  MissingParams missing;

  const CLI::Option* samples_option = nullptr;
  const CLI::Option* directions_option = nullptr;
  const CLI::Option* elevations = nullptr;
  const CLI::Option* rays = nullptr;
  const CLI::Option* rings = nullptr;
  const CLI::Option* max_incidence = nullptr;
  std::vector<const CLI::Option*> orbit_options;  ///< unused with given positions
  std::vector<const CLI::Option*> view_options;   ///< scanner positions: unused for samples with normals
  std::vector<const CLI::Option*> image_options;  ///< for range images only: unused for samples

  bool even_samples() const { return samples_option->count() > 0; }
};

void add_scan_options(CLI::App& app, ScanOptions& options);

/// Throws ParameterError for options that have no meaning together.
void check_together(const ScanOptions& options);

/// Takes from the scene's own scanner what no option gives: positions, rays, size of the image, largest incidence.
void take_scanner_of_scene(ScanOptions& options, const ScannerParams& scene);

ScannerParams scanner_params(const ScanOptions& options, const Box3d& box);
SamplingParams sampling_params(const ScanOptions& options, const Box3d& box);

}  // namespace soapfilm::cli
