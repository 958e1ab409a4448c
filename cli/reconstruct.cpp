// soapfilm reconstruct: scans in, watertight mesh out.
#include "soapfilm/reconstruct.h"

#include <fmt/format.h>

#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include "cli/command.h"
#include "cli/terminal.h"
#include "soapfilm/core/memory.h"
#include "soapfilm/core/stages.h"
#include "soapfilm/io/io.h"
#include "soapfilm/place.h"

namespace soapfilm::cli {

namespace {

struct Options {
  std::vector<std::string> inputs;
  std::string output;
  std::string report;
  std::string memory;
  std::string isovalue = "auto";
  std::vector<double> sensor;
  bool ascii = false;
  bool check = false;
  std::string command;
  ReconstructParams params;
};

/// The words that were typed, for the report.
std::string command_line(const CLI::App& app) {
  std::string line = "soapfilm reconstruct";
  for (const CLI::Option* option : app.get_options()) {
    if (option->count() == 0) continue;
    if (!option->get_positional()) line += " " + option->get_name();
    for (const std::string& word : option->results())
      if (option->get_expected_max() > 0) line += " " + word;
  }
  return line;
}

void finish_params(Options& options) {
  if (!options.memory.empty()) options.params.memory_limit = parse_memory(options.memory);
  if (!options.sensor.empty()) options.params.orient.sensor = {options.sensor[0], options.sensor[1], options.sensor[2]};
  if (options.isovalue != "auto") {
    size_t used = 0;
    double value = 0;
    try {
      value = std::stod(options.isovalue, &used);
    } catch (const std::exception&) {
      used = 0;
    }
    if (used != options.isovalue.size() || used == 0)
      throw ParameterError(fmt::format("isovalue = {}, must be 'auto' or a number > 0 and < 1", options.isovalue));
    options.params.surface.isovalue = value;
  }
  validate(options.params);
}

PointCloud read_input(const Options& options, Progress& progress, ReadReport& read) {
  PointCloud cloud = read_points(options.inputs, &read);
  for (const std::string& warning : read.warnings) progress.warn(warning);
  if (read.dropped() > 0)
    progress.warn(fmt::format("{} of {} samples dropped: not finite", read.dropped(), read.dropped() + cloud.size()));
  try {
    check_samples(cloud);
  } catch (const ParameterError& error) {
    throw InputError(fmt::format("{}: {}", fmt::join(options.inputs, ", "), error.what()));
  }
  progress.info(
      fmt::format("{} samples in {} scan{}", cloud.size(), cloud.scans.size(), cloud.scans.size() == 1 ? "" : "s"));
  return cloud;
}

void print_check(const ReconstructReport& report, Progress& progress) {
  progress.info(summary(*report.topology));
  const DistanceSummary& d = *report.sample_distance;
  const double voxel = report.lattice.voxel;
  progress.info(
      fmt::format("samples to surface: mean {:.3g}, RMS {:.3g}, 95 % {:.3g}, maximum {:.3g} ({:.2f}, {:.2f}, "
                  "{:.2f}, {:.1f} voxels)",
                  d.mean, d.rms, d.percentile95, d.maximum, d.mean / voxel, d.rms / voxel, d.percentile95 / voxel,
                  d.maximum / voxel));
}

int run(Options& options, const GlobalOptions& global) {
  TerminalProgress progress(global);
  const Parallel parallel(global.threads, &progress);
  finish_params(options);
  check_mesh_output(options.output);
  if (!options.report.empty()) check_output(options.report);

  Stages stages(progress);
  ReadReport read;
  const PointCloud cloud = stages.run("read", [&] { return read_input(options, progress, read); });
  Reconstruction result = reconstruct(cloud, options.params, parallel, progress);
  if (options.check || !options.report.empty()) stages.run("check", [&] { check_result(result, cloud, parallel); });
  ReconstructReport& report = result.report;
  if (report.topology) print_check(report, progress);

  stages.run("write", [&] {
    progress.check();
    MeshWriteOptions write;
    write.ascii = options.ascii;
    write.coordinate_precision = 1e-3 * report.lattice.voxel;
    const WriteReport written = write_mesh(options.output, result.mesh, write);
    for (const std::string& warning : written.warnings) {
      progress.warn(warning);
      report.warnings.push_back(warning);
    }
  });
  report.command = options.command;
  report.input.dropped = read.dropped();
  report.warnings.insert(report.warnings.begin(), read.warnings.begin(), read.warnings.end());
  // The stages around the library's own: reading before it, checking and writing after it.
  for (const auto& stage : stages.seconds())
    report.seconds.insert(stage.first == "read" ? report.seconds.begin() : report.seconds.end(), stage);
  report.peak_bytes = peak_memory_bytes();
  if (!options.report.empty()) write_text_file(options.report, to_json(report));
  progress.info(
      fmt::format("{}: {} vertices, {} triangles", options.output, report.mesh_vertices, report.mesh_triangles));
  return 0;
}

void add_options(CLI::App& app, Options& o) {
  ReconstructParams& p = o.params;
  app.add_option("input", o.inputs, "Point clouds or scan sets (.ply, .xyz, .conf); several are several scans")
      ->required()
      ->option_text("FILE...");
  app.add_option("-o,--output", o.output, "Mesh to write: .ply, .obj or .stl")->required()->option_text("FILE");

  const auto grid = [&](auto* option) { return option->group("Grid"); };
  CLI::Option* voxel =
      grid(app.add_option("--voxel", p.place.voxel, "Edge of a grid cell, in the input's units"))->option_text("SIZE");
  grid(app.add_option(
           "--resolution", p.place.resolution,
           "Grid vertices along the longest axis, padding included\n(default: one sample per voxel^2 of surface)"))
      ->excludes(voxel)
      ->option_text("N");
  grid(app.add_option("--padding", p.place.padding, "Cells between the samples and the border"))
      ->option_text(fmt::format("N [{}]", p.place.padding));
  grid(app.add_option("--memory", o.memory,
                      "Refuse a run that needs more, such as 2G\n(default: what the machine has free)"))
      ->option_text("LIMIT");

  const auto directions = [&](auto* option) { return option->group("Directions"); };
  directions(
      app.add_option("--directions", p.orient.source,
                     "Where each sample's outward direction comes from:\nauto, normals, sensor, scan or estimate"))
      ->transform(CLI::CheckedTransformer(
                      std::vector<std::pair<std::string, DirectionSource>>{{"auto", DirectionSource::automatic},
                                                                           {"normals", DirectionSource::normals},
                                                                           {"sensor", DirectionSource::sensor},
                                                                           {"scan", DirectionSource::scan},
                                                                           {"estimate", DirectionSource::estimate}})
                      .description(""))
      ->option_text("SOURCE [auto]");
  directions(app.add_option("--sensor", o.sensor, "Scanner position for scans that do not say it"))
      ->delimiter(',')
      ->expected(3)
      ->option_text("X,Y,Z");

  const auto energy = [&](auto* option) { return option->group("Energy"); };
  energy(app.add_option("--lambda", p.energy.lambda,
                        fmt::format("Weight of area, in the paper's meaning (0.005 to 0.01 there); larger is\nsmoother "
                                    "(default: {:g} x samples per voxel^2)",
                                    p.energy.lambda_per_density)))
      ->option_text("V");
  energy(app.add_option("--tolerance", p.solve.tolerance, "Relative gap at which a level is solved"))
      ->option_text(fmt::format("V [{:g}]", p.solve.tolerance));
  energy(app.add_option("--max-iterations", p.solve.max_iterations, "Limit per level"))
      ->option_text(fmt::format("N [{}]", p.solve.max_iterations));

  const auto surface = [&](auto* option) { return option->group("Surface"); };
  surface(app.add_option("--threshold", p.surface.threshold, "Threshold mu of the relaxed indicator, in (0, 1)"))
      ->option_text(fmt::format("MU [{:g}]", p.surface.threshold));
  surface(
      app.add_option("--isovalue", o.isovalue, "Of the smoothed indicator, in (0, 1); auto: its mean at the samples"))
      ->option_text("V [auto]");

  const auto output = [&](auto* option) { return option->group("Output"); };
  output(app.add_option("--report", o.report, "Write what was done and proved, as JSON"))->option_text("FILE.json");
  output(app.add_flag("--check", o.check, "Check the mesh's topology and its distance to the samples"));
  output(app.add_flag("--ascii", o.ascii, "PLY and STL as text"));
}

}  // namespace

void add_reconstruct(CLI::App& app, const GlobalOptions& global, Runner& runner) {
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("reconstruct", "Scans to a watertight mesh, with a proof of optimality");
  add_options(*command, *options);
  command->callback([command, options, &global, &runner] {
    options->command = command_line(*command);
    runner = [options, &global] { return run(*options, global); };
  });
}

}  // namespace soapfilm::cli
