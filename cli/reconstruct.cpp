// soapfilm reconstruct: scans in, watertight mesh out.
#include "soapfilm/reconstruct.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <initializer_list>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "cli/command.h"
#include "cli/coordinate_system.h"
#include "cli/detail_levels.h"
#include "cli/level_files.h"
#include "cli/overwrite.h"
#include "cli/parse.h"
#include "cli/preview.h"
#include "cli/proved_mesh.h"
#include "cli/ranks.h"
#include "cli/read_cloud.h"
#include "cli/reconstruct_options.h"
#include "cli/scratch.h"
#include "cli/split.h"
#include "cli/standard_streams.h"
#include "cli/terminal.h"
#include "soapfilm/core/json_text.h"
#include "soapfilm/core/memory.h"
#include "soapfilm/core/stages.h"
#include "soapfilm/finish/self_check.h"
#include "soapfilm/io.h"
#include "soapfilm/io/bytes/rank_blocks.h"
#include "soapfilm/io/files.h"
#include "soapfilm/io/parts.h"
#include "soapfilm/io/sets/input_files.h"
#include "soapfilm/mesh/topology.h"
#include "soapfilm/run/defaults.h"
#include "soapfilm/run/order_samples.h"
#include "soapfilm/run/rank_times.h"
#include "soapfilm/run/run.h"
#include "tools/evaluate/check_result.h"

namespace soapfilm::cli {

namespace {

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

/// TOL, TOLvox, auto or off.
SimplifyParams simplify_params(const std::string& text, std::optional<size_t> triangles) {
  SimplifyParams params;
  params.triangles = triangles;
  const std::string_view unit = "vox";
  const bool in_voxels = text.size() > unit.size() && std::string_view(text).ends_with(unit);
  if (text == "off") return params;
  const std::string number = in_voxels ? text.substr(0, text.size() - unit.size()) : text;
  const auto value = number_or_auto("simplify", number, "> 0, such as 0.002 or 0.05vox, or 'auto', 'off'");
  if (!value && in_voxels)
    throw ParameterError(fmt::format("simplify = {}, must be > 0, such as 0.002 or 0.05vox, or 'auto', 'off'", text));
  params.automatic = !value;
  (in_voxels ? params.tolerance_vox : params.tolerance) = value;
  return params;
}

/// Of coordinates in the file; what is proved is proved of exact ones.
double coordinate_precision(const ReconstructReport& report) {
  const bool is_proved = report.simplify && report.simplify->triangles < report.simplify->triangles_before;
  return is_proved ? proved_precision : 1e-3 * report.grid.voxel;
}

void finish_params(const CLI::App& app, ReconstructOptions& options) {
  ReconstructParams& params = options.params;
  if (!options.anchor.empty()) params.place.anchor = {options.anchor[0], options.anchor[1], options.anchor[2]};
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
  if (!options.simplify.empty()) params.simplify = simplify_params(options.simplify, params.simplify.triangles);
  if (options.lod && !simplifies(params.simplify))
    throw ParameterError("lod: levels are coarser than a simplified mesh; --simplify auto makes it");
  if (options.lod && part_triangles(options.split)) throw ParameterError("split: not together with --lod");
  refuse_unused(app, params);
  validate(params);
}

/// Of files with levels of detail no more is read than this; four samples for each voxel^2.
constexpr double samples_along_voxel = 2;

PointCloud read_input(const ReconstructOptions& options, const std::vector<std::string>& attributes,
                      const Context& context, ReadReport& read) {
  ReadOptions as = options.read;
  as.attributes = attributes;  // what reaches no vertex is not kept
  as.spacing = options.params.place.voxel.value_or(0) / samples_along_voxel;
  PointCloud cloud = read_cloud(options.inputs, as, context, read);
  context.progress().info(
      fmt::format("{} samples in {} scan{}", cloud.size(), cloud.scans.size(), cloud.scans.size() == 1 ? "" : "s"));
  return cloud;
}

/// The same on each rank, if there are some, or an error on all.
PointCloud read_alike(Ranks* ranks, const ReconstructOptions& options, const Context& context, ReadReport& read) {
  if (ranks) require_same_params(*ranks, options.params);
  PointCloud cloud = read_input(options, options.params.surface.attributes, context, read);
  const bool read_by_each = options.inputs.size() == 1;  // or a set, whose poses each has read
  if (ranks && read_by_each) require_same_samples(*ranks, cloud);
  return cloud;
}

/// Beside the mesh, whose formats have no place for its coordinate system.
std::string coordinate_system_file(const ReconstructOptions& options) {
  return std::filesystem::path(options.output).replace_extension(".prj").string();
}

void check_names(const ReconstructOptions& options, const ReadReport& read) {
  std::vector<std::string> inputs = options.inputs;
  for (const FileReport& file : read.files) inputs.push_back(file.path);  // the scans of a set
  std::vector<std::string> outputs = lod_files(options.output, options.lod);
  if (!options.split.empty()) {
    outputs = {parts_index(options.output)};
    if (is_part_file(options.output, options.report)) outputs.push_back(options.report);
    for (const std::string& input : inputs)
      if (is_part_file(options.output, input)) outputs.push_back(input);
  }
  outputs.insert(outputs.end(), {options.report, coordinate_system_file(options)});
  constexpr int most_levels = 28;  // coarser, and finer ones where levels adapt
  for (int level = -most_levels; level < most_levels && !options.levels_folder.empty(); ++level)
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

/// The mesh, and coarser ones if they are asked for.
std::vector<DetailLevel> levels_of(Mesh&& mesh, const ReconstructReport& report, LodCount lod, const Context& context) {
  if (!report.simplify) {  // warned of before
    std::vector<DetailLevel> one(1);
    one[0].mesh = std::move(mesh);
    return one;
  }
  return detail_levels({std::move(mesh), *report.simplify}, lod, context);
}

/// The meshes, or the one in parts. Returns the parts.
WrittenParts write_meshes(const ReconstructOptions& options, const std::vector<DetailLevel>& levels,
                          ReconstructReport& report, const Context& context) {
  context.check();
  WriteOptions write;
  write.ascii = options.ascii;
  write.coordinate_precision = coordinate_precision(report);
  write.voxel = report.grid.voxel;
  write.up = report.params.orient.up.value_or(Axis::z);
  WrittenParts written;
  if (const auto triangles = part_triangles(options.split)) {
    const std::string& system = report.input.coordinate_system;
    const PartsParams parts{*triangles, system, coordinate_system_of(system).unit};
    written = write_parts(options.output, levels[0].mesh, parts, write, context);
  } else {
    written.report = write_levels(options.output, levels, write, context);
  }
  for (const std::string& warning : written.report.warnings) {
    context.progress().warn(warning);
    report.warnings.push_back(warning);
  }
  return written;
}

std::string report_text(const ReconstructOptions& options, const ReconstructReport& report,
                        const std::vector<DetailLevel>& levels, const WrittenParts& parts) {
  if (!options.lod && options.split.empty()) return to_json(report);
  auto json = nlohmann::ordered_json::parse(to_json(report));
  if (options.lod) json["mesh"]["levels"] = levels_json(options.output, levels);
  if (!options.split.empty()) json["mesh"]["parts"] = parts_json(parts);
  return json_text(json) + "\n";
}

/// The mesh took long to compute: it is kept even if its report cannot be written.
void write_report(const ReconstructOptions& options, const ReconstructReport& report,
                  const std::vector<DetailLevel>& levels, const WrittenParts& parts) {
  try {
    write_text_file(options.report, report_text(options, report, levels, parts));
  } catch (const OutputError& error) {
    const std::string& mesh = options.split.empty() ? options.output : parts.index;
    throw OutputError(fmt::format("{}; {} is written all the same", error.what(), mesh));
  }
}

void check_mesh_place(const ReconstructOptions& options, const StandardStreams& streams) {
  if (streams.gives_output() && !options.split.empty())
    throw ParameterError("split: several files cannot go to standard output");
  if (options.split.empty())
    check_mesh_output(options.output);
  else
    check_parts_output(options.output);
}

/// Folders and standard streams become files. `writes`: outputs are looked at, too.
void find_files(ReconstructOptions& options, StandardStreams& streams, bool writes, Progress& progress) {
  const bool unnamed = options.output.empty() && options.inputs[0] == "-";
  if (unnamed) throw ParameterError("output: no name, must be given with -o where standard input is read");
  streams.take_output(options.output);
  if (!options.output.empty() && writes) check_mesh_place(options, streams);
  streams.take_input(options.inputs);
  std::vector<std::string> warnings;
  const std::string given = options.inputs[0];
  options.inputs = io::input_files(options.inputs, warnings);
  if (options.output.empty()) {
    const bool is_folder = std::filesystem::is_directory(given);
    options.output = default_mesh(is_folder ? given : options.inputs[0], options.preview);
    if (writes) check_mesh_place(options, streams);
  }
  const std::vector<std::string> files = lod_files(options.output, options.lod);
  if (streams.gives_output() && files.size() > 1)
    throw ParameterError("lod: several files cannot go to standard output; --format glb makes one");
  for (const std::string& file : files)
    if (options.split.empty() && writes) check_mesh_output(file);
  if (writes && !options.report.empty()) check_output(options.report);
  for (const std::string& warning : warnings) progress.warn(warning);
}

/// Options that processes of one run cannot follow together.
void refuse_on_ranks(const ReconstructOptions& options) {
  const auto& in = options.inputs;
  if (std::find(in.begin(), in.end(), "-") != in.end())
    throw ParameterError("standard input: several ranks cannot read it; give the name of a file");
  if (!options.levels_folder.empty()) throw ParameterError("write-levels: several ranks cannot; run one process");
}

/// Waits until all ranks are here.
void meet(Ranks& ranks) { of_all(ranks, uint8_t{1}); }

/// Of rank 0: call when all is written. If that fails all go on from their stages.
void end_writing(Ranks* ranks, const Context& context) {
  if (ranks) io::end_blocks(*ranks);
  remove_kept_stages(context);
}

/// The other ranks, while rank 0 has meshes to write.
int write_with_rank_0(Ranks& ranks, const Context& context) {
  io::write_blocks(ranks);
  remove_kept_stages(context);
  return 0;
}

/// Of memory, and where it does not suffice.
void set_limits(const ReconstructOptions& options, Context& context) {
  if (!options.memory.empty()) context.limit_memory(parse_memory(options.memory));
  if (!options.scratch.empty()) use_scratch(options.scratch, context);
  if (options.resume && options.scratch.empty()) throw ParameterError("resume: needs --scratch, where stages are kept");
  context.set_resume(options.resume);
}

/// What the program did beside the library: reading before it, checking and writing after it.
void add_own_facts(const ReadReport& read, const Stages& stages, const std::vector<RankTimes>& of_reading,
                   ReconstructReport& report) {
  report.input.dropped = read.dropped();
  report.input.no_return = no_returns(read);
  std::vector<std::string> warnings;
  for (const std::string& warning : read.warnings) warnings.push_back(with_known_names(warning));
  report.warnings.insert(report.warnings.begin(), warnings.begin(), warnings.end());
  for (const StageTime& stage : stages.times())
    report.stages.insert(stage.name == "read" ? report.stages.begin() : report.stages.end(), stage);
  add_first_stages(of_reading, report);
  report.peak_bytes = peak_memory_bytes();
}

int run(const CLI::App& app, ReconstructOptions& options, const GlobalOptions& global) {
  TerminalProgress progress(global);
  Context context(global.threads, progress);
  finish_params(app, options);
  if (global.ranks) refuse_on_ranks(options);
  set_limits(options, context);
  StandardStreams streams(options.format, context);
  find_files(options, streams, global.speaks(), progress);

  if (global.ranks) share_run(global.ranks, context);
  make_room_for(options.inputs, context);
  Stages stages(context);
  ReadReport read;
  PointCloud cloud = stages.run("read", [&] { return read_alike(global.ranks.get(), options, context, read); });
  check_names(options, read);
  const std::vector<RankTimes> of_reading = times_of_ranks(stages.times(), context);
  order_samples(cloud, context);
  if (options.preview) make_preview(options.params, cloud, progress);
  LevelFiles levels;
  const bool checks = options.params.checked = options.check || !options.report.empty();
  const Experiment levels_written{levels.writer(options.levels_folder, options.params.surface.threshold, context), {}};
  Reconstruction result;
  try {
    result = run(cloud, checks ? nullptr : &cloud, options.params, context, levels_written);
  } catch (const SamplesError& error) {
    throw InputError(fmt::format("{}: {}", fmt::join(options.inputs, ", "), error.what()));
  }
  if (global.ranks) meet(*global.ranks);  // what one of them could not finish must not be written
  if (!global.speaks()) return write_with_rank_0(*global.ranks, context);
  if (checks) stages.run("check", [&] { check_result(result, cloud, context); });
  ReconstructReport& report = result.report;
  if (report.topology) print_check(report, progress);

  const auto make_levels = [&] { return levels_of(std::move(result.mesh), report, options.lod, context); };
  const std::vector<DetailLevel> meshes = options.lod ? stages.run("levels", make_levels) : make_levels();
  const WrittenParts parts = stages.run("write", [&] { return write_meshes(options, meshes, report, context); });
  if (!report.input.coordinate_system.empty() && !streams.gives_output())
    write_text_file(coordinate_system_file(options), report.input.coordinate_system + "\n");
  report.command = global.command;
  add_own_facts(read, stages, of_reading, report);
  if (!options.report.empty()) write_report(options, report, meshes, parts);
  levels.keep();
  if (streams.gives_output()) streams.give_output();
  end_writing(global.ranks.get(), context);
  const std::string written = options.split.empty() ? options.output
                                                    : fmt::format("{}, {} file{}", parts.index, parts.parts.size(),
                                                                  parts.parts.size() == 1 ? "" : "s");
  progress.info(fmt::format("{}: {} vertices, {} triangles", written, report.mesh_vertices, report.mesh_triangles));
  announce_levels(options.output, meshes, progress);
  if (options.preview) progress.info("full run: " + full_run(global.arguments));
  constexpr int samples_lost = 4;  // besides program.cpp's exit codes, and no error: all is written
  return options.strict && report.self_check.lost > self_check_most_lost ? samples_lost : 0;
}

}  // namespace

void add_reconstruct(CLI::App& app, const GlobalOptions& global, Runner& runner) {
  auto options = std::make_shared<ReconstructOptions>();
  CLI::App* command = app.add_subcommand("reconstruct", "Scans to a watertight mesh, with a proof of optimality");
  add_reconstruct_options(*command, *options);
  command->callback([command, options, &global, &runner] {
    runner = [command, options, &global] { return run(*command, *options, global); };
  });
}

}  // namespace soapfilm::cli
