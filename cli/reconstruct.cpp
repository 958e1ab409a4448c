// soapfilm reconstruct: scans in, watertight mesh out.
#include "soapfilm/reconstruct.h"

#include <fmt/format.h>

#include <chrono>
#include <filesystem>
#include <initializer_list>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "cli/command.h"
#include "cli/level_files.h"
#include "cli/overwrite.h"
#include "cli/params_file.h"
#include "cli/parse.h"
#include "cli/read_cloud.h"
#include "cli/terminal.h"
#include "soapfilm/core/memory.h"
#include "soapfilm/core/names.h"
#include "soapfilm/core/stages.h"
#include "soapfilm/finish/self_check.h"
#include "soapfilm/io.h"
#include "soapfilm/io/files.h"
#include "soapfilm/mesh/topology.h"
#include "soapfilm/run/run.h"
#include "tools/evaluate/check_result.h"

namespace soapfilm::cli {

namespace {

struct ReconstructOptions {
  std::vector<std::string> inputs;
  ReadOptions read;
  std::string output;
  std::string report;
  std::string memory;
  std::string isovalue;
  std::string lambda;
  std::string trim;
  std::string levels_folder;
  std::vector<double> sensor;
  std::vector<std::string> attributes;
  bool ascii = false;
  bool check = false;
  bool strict = false;
  ReconstructParams params;
};

/// An option that the chosen method does not use is an error.
void refuse_unused(const CLI::App& app, const ReconstructParams& params) {
  const auto only = [&](std::initializer_list<const char*> names, bool used, const char* of) {
    for (const char* name : names)
      if (!used && app.count(name) > 0) throw ParameterError(fmt::format("{}: only {} has it", name, of));
  };
  const bool chooses = params.energy.cross_validate;
  only({"--tolerance", "--max-iterations", "--settle"}, params.method == Method::tv || chooses, "method tv");
  only({"--link-weights"}, params.method == Method::graph_cut_26, "method graph-cut-26");
  only({"--front", "--behind"}, params.method == Method::vrip, "method vrip");
  only({"--write-levels"}, params.method == Method::tv, "method tv");
  only({"--folds", "--fold-source"}, chooses, "--lambda auto");
  only({"--weights"}, params.method != Method::vrip, "a method with a data term");
  only({"--weights"}, !params.energy.lambda, "a lambda that follows the samples");
}

void finish_params(const CLI::App& app, ReconstructOptions& options) {
  ReconstructParams& params = options.params;
  if (!options.memory.empty()) params.memory_limit = parse_memory(options.memory);
  if (!options.sensor.empty()) params.orient.sensor = {options.sensor[0], options.sensor[1], options.sensor[2]};
  if (!options.attributes.empty()) params.surface.attributes = options.attributes;
  if (options.attributes == std::vector<std::string>{"none"}) params.surface.attributes = {};
  if (!options.isovalue.empty()) params.surface.isovalue = number_or_auto("isovalue", options.isovalue, "> 0 and < 1");
  // Both determine the grid: one given here replaces the other in --params.
  if (app.count("--voxel") > 0) params.place.resolution.reset();
  if (app.count("--resolution") > 0) params.place.voxel.reset();
  if (!options.lambda.empty()) {
    params.energy.lambda = number_or_auto("lambda", options.lambda, "> 0");
    params.energy.cross_validate = !params.energy.lambda;
  }
  if (options.trim == "off") {
    params.trim.on = false;
    params.trim.distance.reset();
  } else if (!options.trim.empty()) {
    params.trim.distance = number_or_auto("trim", options.trim, "> 0, or 'off'");
    params.trim.on = true;
  }
  refuse_unused(app, params);
  validate(params);
}

PointCloud read_input(const ReconstructOptions& options, const Context& context, ReadReport& read) {
  PointCloud cloud = read_cloud(options.inputs, options.read, context, read);
  context.progress().info(
      fmt::format("{} samples in {} scan{}", cloud.size(), cloud.scans.size(), cloud.scans.size() == 1 ? "" : "s"));
  return cloud;
}

/// Beside the mesh, whose formats have no place for its coordinate system.
std::string coordinate_system_file(const ReconstructOptions& options) {
  return std::filesystem::path(options.output).replace_extension(".prj").string();
}

void check_names(const ReconstructOptions& options, const ReadReport& read) {
  std::vector<std::string> inputs = options.inputs;
  for (const FileReport& file : read.files) inputs.push_back(file.path);  // the scans of a set
  std::vector<std::string> outputs{options.output, options.report, coordinate_system_file(options)};
  constexpr int most_levels = 28;
  for (int level = 0; level < most_levels && !options.levels_folder.empty(); ++level)
    outputs.push_back((std::filesystem::path(options.levels_folder) / LevelFiles::name(level)).string());
  refuse_overwriting(outputs, inputs);
}

void print_check(const ReconstructReport& report, Progress& progress) {
  progress.info(summary(*report.topology));
  const DistanceSummary& d = *report.sample_distance;
  const double voxel = report.grid.voxel;
  progress.info(
      fmt::format("samples to surface: mean {:.3g}, RMS {:.3g}, 95 % {:.3g}, maximum {:.3g} ({:.2f}, {:.2f}, "
                  "{:.2f}, {:.1f} voxels)",
                  d.mean, d.rms, d.percentile95, d.maximum, d.mean / voxel, d.rms / voxel, d.percentile95 / voxel,
                  d.maximum / voxel));
}

/// The mesh took long to compute: it is kept even if its report cannot be written.
void write_report(const ReconstructOptions& options, const ReconstructReport& report) {
  try {
    write_text_file(options.report, to_json(report));
  } catch (const OutputError& error) {
    throw OutputError(fmt::format("{}; {} is written all the same", error.what(), options.output));
  }
}

int run(const CLI::App& app, ReconstructOptions& options, const GlobalOptions& global) {
  TerminalProgress progress(global);
  const Context context(global.threads, progress);
  finish_params(app, options);
  check_mesh_output(options.output);
  if (!options.report.empty()) check_output(options.report);

  Stages stages(context);
  ReadReport read;
  PointCloud cloud = stages.run("read", [&] { return read_input(options, context, read); });
  check_names(options, read);
  LevelFiles levels;
  const bool checks = options.params.checked = options.check || !options.report.empty();
  const Experiment levels_written{levels.writer(options.levels_folder, options.params.surface.threshold, context), {}};
  Reconstruction result;
  try {
    result = run(cloud, checks ? nullptr : &cloud, options.params, context, levels_written);
  } catch (const SamplesError& error) {
    throw InputError(fmt::format("{}: {}", fmt::join(options.inputs, ", "), error.what()));
  }
  if (checks) stages.run("check", [&] { check_result(result, cloud, context); });
  ReconstructReport& report = result.report;
  if (report.topology) print_check(report, progress);

  stages.run("write", [&] {
    progress.check();
    WriteOptions write;
    write.ascii = options.ascii;
    write.coordinate_precision = 1e-3 * report.grid.voxel;
    write.voxel = report.grid.voxel;
    const WriteReport written = write_mesh(options.output, result.mesh, write, context);
    for (const std::string& warning : written.warnings) {
      progress.warn(warning);
      report.warnings.push_back(warning);
    }
  });
  if (!report.input.coordinate_system.empty())
    write_text_file(coordinate_system_file(options), report.input.coordinate_system + "\n");
  report.command = global.command;
  report.input.dropped = read.dropped();
  report.input.no_return = no_returns(read);
  report.warnings.insert(report.warnings.begin(), read.warnings.begin(), read.warnings.end());
  // The program's own stages: reading before the library's, checking and writing after them.
  for (const StageTime& stage : stages.times())
    report.stages.insert(stage.name == "read" ? report.stages.begin() : report.stages.end(), stage);
  report.peak_bytes = peak_memory_bytes();
  if (!options.report.empty()) write_report(options, report);
  levels.keep();
  progress.info(
      fmt::format("{}: {} vertices, {} triangles", options.output, report.mesh_vertices, report.mesh_triangles));
  constexpr int samples_lost = 4;  // besides program.cpp's exit codes, and no error: all is written
  return options.strict && report.self_check.lost > self_check_most_lost ? samples_lost : 0;
}

void add_main_options(CLI::App& app, ReconstructOptions& o) {
  ReconstructParams& p = o.params;
  app.add_option("input", o.inputs,
                 fmt::format("Point clouds or scan sets ({}); several are several\nscans", point_extensions()))
      ->required()
      ->option_text("FILE...");
  app.add_option_function<std::string>(
         "--params", [&o](const std::string& file) { o.params = read_params(file); },
         "Take all parameters from a report of an earlier run, or from its\n\"parameters\" alone; options beside it "
         "hold")
      ->trigger_on_parse()
      ->option_text("FILE.json");
  app.add_option("-o,--output", o.output, "Mesh to write: " + mesh_output_extensions())
      ->required()
      ->option_text("FILE");

  add_read_options(app, o.read);

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
      app.add_option(
          "--directions", p.orient.source,
          "Where each sample's outward direction comes from:\nauto (normals that contradict each other lose their "
          "signs), normals (as\ngiven), sensor, scan or estimate"))
      ->transform(named<DirectionSource>())
      ->option_text("SOURCE [auto]");
  directions(app.add_option("--sensor", o.sensor, "Scanner position for scans that do not say it"))
      ->delimiter(',')
      ->expected(3)
      ->option_text("X,Y,Z");
  directions(app.add_option("--neighbors", p.orient.neighbors,
                            "Of estimated directions: nearest samples whose plane it is, 3 to 1000"))
      ->option_text(fmt::format("N [{}]", p.orient.neighbors));
  directions(app.add_option("--radius", p.orient.radius,
                            "Of estimated directions: all samples as near as this count too, in the\ninput's units"))
      ->option_text("R");

  grid(app.add_option(
           "--outside", p.border.outside,
           "What lies beyond the samples' box: air, around an object; solid, around a\nroom seen from inside; "
           "open: neither, the surface is a sheet that ends"))
      ->transform(named<Border>())
      ->option_text("WHAT [auto]");

  const auto energy = [&](auto* option) { return option->group("Energy"); };
  energy(app.add_option("--lambda", o.lambda,
                        fmt::format("Weight of area, in the paper's meaning (0.005 to 0.01 there); larger\n"
                                    "is smoother (default: {:g} x samples per voxel^2);\nauto: by cross-validation",
                                    p.energy.lambda_per_density)))
      ->option_text("V|auto");
  energy(app.add_option("--weights", p.energy.by_area,
                        "What a sample counts for: area, the surface that it stands for, or samples,\nall alike"))
      ->transform(named<bool>({{"area", true}, {"samples", false}}))
      ->option_text("area|samples [area]");
  energy(app.add_option("--norm", p.energy.norm,
                        "How area is measured: isotropic, as it is, or anisotropic, along the\ngrid's axes"))
      ->transform(named<Norm>())
      ->option_text("NORM [isotropic]");
  energy(app.add_option("--tolerance", p.solve.tolerance,
                        "Relative gap at which the finest level is solved; the next one: twice\nthat, coarser ones: at "
                        "most 0.0003 (0.01 where they only tell where to\nstart)"))
      ->option_text(fmt::format("V [{:g}]", p.solve.tolerance));
  energy(app.add_option("--max-iterations", p.solve.max_iterations, "Limit per level"))
      ->option_text(fmt::format("N [{}]", p.solve.max_iterations));
  energy(app.add_option("--settle", p.solve.settle,
                        "End a level when no label changes any more, though its gap may still\nfall: on or off"))
      ->transform(named<bool>({{"on", true}, {"off", false}}))
      ->option_text("on|off [on]");
}

void add_method_options(CLI::App& app, ReconstructOptions& o) {
  ReconstructParams& p = o.params;
  const auto method = [&](auto* option) { return option->group("Method"); };
  method(app.add_option("--method", p.method,
                        fmt::format("One of {}\n(docs/reference/methods.md)", fmt::join(names_of<Method>, ", "))))
      ->transform(named<Method>())
      ->option_text("NAME [tv]");
  method(app.add_option("--link-weights", p.graph_cut.weights,
                        "Of graph-cut-26: edge-length, or cauchy-crofton (less dependent on direction)"))
      ->transform(named<LinkWeights>())
      ->option_text("W [edge-length]");
  method(app.add_option("--front", p.vrip.front, "Of vrip: reach of a scan before its surface, voxels"))
      ->option_text(fmt::format("V [{:g}]", p.vrip.front));
  method(app.add_option("--behind", p.vrip.behind, "Of vrip: reach behind it, voxels"))
      ->option_text(fmt::format("V [{:g}]", p.vrip.behind));
  method(
      app.add_option("--folds", p.cross_validation.folds, "Of --lambda auto: parts of the samples, each held out once"))
      ->option_text(fmt::format("N [{}]", p.cross_validation.folds));
  method(app.add_option("--fold-source", p.cross_validation.source, "Of --lambda auto: auto, samples, or whole scans"))
      ->transform(named<FoldSource>())
      ->option_text("SOURCE [auto]");
}

void add_surface_options(CLI::App& app, ReconstructOptions& o) {
  ReconstructParams& p = o.params;

  const auto surface = [&](auto* option) { return option->group("Surface"); };
  surface(app.add_option("--threshold", p.surface.threshold, "Threshold mu of the relaxed indicator, in (0, 1)"))
      ->option_text(fmt::format("MU [{:g}]", p.surface.threshold));
  surface(
      app.add_option("--isovalue", o.isovalue, "Of the unrefined surface, in (0, 1); auto: the mean at the samples"))
      ->option_text("V [auto]");

  surface(app.add_option("--refine", p.surface.refine,
                         "Move the surface onto the samples, or leave the paper's: on or off\n(default: on for tv)"))
      ->transform(named<bool>({{"on", true}, {"off", false}}))
      ->option_text("on|off");
  surface(app.add_option("--drop-components", p.surface.drop_components,
                         "Remove components and cavities that too few samples support, or that\nrefining shrinks to "
                         "nothing: on or off\n(default: on where the surface is refined)"))
      ->transform(named<bool>({{"on", true}, {"off", false}}))
      ->option_text("on|off");
  surface(app.add_option("--min-support", p.components.min_support,
                         "Of --drop-components: samples on a component over those that its area\nhas on average"))
      ->option_text(fmt::format("V [{:g}]", p.components.min_support));
  surface(app.add_option("--smoothing", p.refine.smoothing,
                         "Of the refined surface: weight of curvature against one sample\n(default: chosen by held-out "
                         "samples)"))
      ->option_text("V");
  surface(app.add_option("--holes", p.refine.holes,
                         "Of the refined surface, where no sample covers it: smooth, bent as the\nsurface around, or "
                         "flat, of least area; unseen bases are flat"))
      ->transform(named<HoleFill>())
      ->option_text("smooth|flat [smooth]");
  surface(app.add_option("--split-tolerance", p.surface.relax.split_tolerance,
                         "Of the refined surface: split edges whose middle lies further from it,\nvoxels; 0: leave the "
                         "triangles of marching cubes"))
      ->option_text(fmt::format("V [{:g}]", p.surface.relax.split_tolerance));

  surface(app.add_option("--trim", o.trim,
                         "Take away surface farther than this from all samples, in the input's\nunits; auto: 3 voxels, "
                         "or 3 times the samples' spacing; off\n(default: auto where the surface is open, else off)"))
      ->option_text("DIST|auto|off");
  surface(app.add_flag("--trim-holes", p.trim.holes, "Of --trim: also holes that would stay filled"));

  const auto output = [&](auto* option) { return option->group("Output"); };
  output(app.add_option("--report", o.report, "Write what was done and proved, as JSON"))->option_text("FILE.json");
  output(app.add_option(
             "--write-levels", o.levels_folder,
             "Also write the unsmoothed surface of each level of the pyramid as\nDIR/level_0.ply (finest), ..."))
      ->option_text("DIR");
  output(app.add_option("--attributes", o.attributes,
                        "What the samples have and the mesh's vertices get: all, none, or names\nsuch as "
                        "color,intensity"))
      ->delimiter(',')
      ->option_text("NAMES [color]");
  output(app.add_flag("--distance", p.surface.distance,
                      "Each vertex' distance to the nearest sample, in the input's units, as the\nPLY's attribute "
                      "'distance' (soapfilm render --color-by distance)"));
  output(app.add_flag("--support", p.surface.support,
                      "The samples per voxel^2 of surface at each vertex, as the attribute 'support'"));
  output(app.add_flag("--check", o.check, "Check the mesh's topology and its distance to the samples"));
  output(app.add_flag(
      "--strict", o.strict,
      "Exit code 4, with all written, when more than 1 % of the samples are\nfarther than 3 voxels from the mesh"));
  output(app.add_flag("--ascii", o.ascii, "PLY and STL as text"));
}

}  // namespace

void add_reconstruct(CLI::App& app, const GlobalOptions& global, Runner& runner) {
  auto options = std::make_shared<ReconstructOptions>();
  CLI::App* command = app.add_subcommand("reconstruct", "Scans to a watertight mesh, with a proof of optimality");
  add_main_options(*command, *options);
  add_method_options(*command, *options);
  add_surface_options(*command, *options);
  command->callback([command, options, &global, &runner] {
    runner = [command, options, &global] { return run(*command, *options, global); };
  });
}

}  // namespace soapfilm::cli
