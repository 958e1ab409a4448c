// soapfilm evaluate: a mesh against the truth.
#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <string>

#include "cli/command.h"
#include "cli/object.h"
#include "cli/overwrite.h"
#include "cli/parse.h"
#include "cli/print.h"
#include "cli/read_cloud.h"
#include "cli/terminal.h"
#include "soapfilm/core/json_text.h"
#include "soapfilm/core/stages.h"
#include "soapfilm/error.h"
#include "soapfilm/io.h"
#include "soapfilm/io/files.h"
#include "tools/evaluate/evaluate.h"
#include "tools/evaluate/evaluation_report.h"

namespace soapfilm::cli {

namespace {

/// The values of the options, before they are checked.
struct EvaluateOptions {
  std::string mesh;
  ObjectOptions truth;
  std::string samples;
  double voxel = 0;
  std::string json;
  std::string error_ply;
  double error_range = 0;  ///< 0: the 99 % of the mesh's distances
  const CLI::Option* voxel_option = nullptr;
  const CLI::Option* error_range_option = nullptr;
  EvaluationOptions evaluation;
};

void check(const EvaluateOptions& options) {
  validate(options.evaluation);
  const auto positive = [](const CLI::Option* option, const char* name, double value) {
    if (option->count() > 0 && !(value > 0.0 && std::isfinite(value)))
      throw ParameterError(fmt::format("{} = {}, must be > 0 and finite", name, value));
  };
  positive(options.voxel_option, "voxel", options.voxel);
  positive(options.error_range_option, "error_range", options.error_range);
  refuse_overwriting({options.json, options.error_ply}, {options.mesh, options.truth.name, options.samples});
  if (!options.json.empty()) check_output(options.json);
  if (options.error_ply.empty()) {
    if (options.error_range_option->count() > 0) throw ParameterError("--error-range: only --error-ply has it");
    return;
  }
  if (std::filesystem::path(options.error_ply).extension() != ".ply")
    throw ParameterError(fmt::format("error_ply = {}, must end in .ply", options.error_ply));
  check_mesh_output(options.error_ply);
}

void write_errors(const EvaluateOptions& options, Mesh mesh, const Surface& truth, const Evaluation& evaluation,
                  const Context& context) {
  const double found = evaluation.mesh_to_truth.distance.percentile99;
  // A mesh that lies on the truth has no error to scale by; with any range it is dark.
  const double top = options.error_range > 0 ? options.error_range : found > 0 ? found : truth.box().longest();
  WriteOptions write;
  write.comments = {fmt::format("colors: distance to the truth from 0 to {:.6g}", top)};
  write_mesh(options.error_ply, color_by_error(std::move(mesh), truth, top, context), write, context);
}

int run(const EvaluateOptions& options, const GlobalOptions& global) {
  TerminalProgress progress(global);
  const Context context(global.threads, progress);
  check(options);
  Stages stages(context);
  Mesh mesh;
  KnownSurface truth;
  std::optional<PointCloud> samples;
  stages.run("read", [&] {
    truth = make_object("truth", options.truth, context);  // first: its options are checked before files
    mesh = read_surface(options.mesh, context);
    if (!options.samples.empty()) {
      ReadReport read;
      samples = read_cloud({options.samples}, {}, context, read);
      std::vector<std::string> scans;  // of a set
      for (const FileReport& file : read.files) scans.push_back(file.path);
      refuse_overwriting({options.json, options.error_ply}, scans);
    }
  });
  const Evaluation evaluation = stages.run("evaluate", [&] {
    return evaluate(mesh, *truth.surface, options.evaluation, context, samples ? &samples->positions : nullptr);
  });
  const EvaluationSubject subject{options.mesh, truth.facts, options.samples, options.voxel, options.evaluation};
  if (!options.json.empty() || !options.error_ply.empty()) {
    stages.run("write", [&] {
      if (!options.error_ply.empty()) write_errors(options, std::move(mesh), *truth.surface, evaluation, context);
      if (!options.json.empty()) write_text_file(options.json, json_text(evaluation_json(subject, evaluation)) + "\n");
    });
  }
  print(stdout, evaluation_table(subject, evaluation));
  return 0;
}

void add_options(CLI::App& app, EvaluateOptions& o) {
  EvaluationOptions& e = o.evaluation;
  app.add_option("mesh", o.mesh, fmt::format("The mesh to judge ({})", mesh_extensions()))
      ->required()
      ->option_text("MESH");
  app.add_option("--truth", o.truth.name, object_description())
      ->required()
      ->check(also(surface_names()))
      ->option_text("SHAPE|MESH");
  app.add_option(
         "--samples", o.samples,
         fmt::format("Measure the distance of these samples too ({}), a folder is all in it", point_extensions()))
      ->option_text("CLOUD");
  o.voxel_option =
      app.add_option("--voxel", o.voxel, "Give distances in this unit too, the grid's cell")->option_text("SIZE");
  app.add_option("--f-score", e.f_score_distances, "F-scores at these distances, input units")
      ->delimiter(',')
      ->option_text("D,...");
  app.add_option("--points", e.points, "On each surface, even by area")
      ->check(CLI::Range(1, 100'000'000))
      ->option_text(fmt::format("N [{}]", e.points));
  app.add_option("--seed", e.seed, "Of where they lie")
      ->check(CLI::Range(int64_t{0}, std::numeric_limits<int64_t>::max()))
      ->option_text(fmt::format("N [{}]", e.seed));
  add_shape_options(app, o.truth);

  const auto output = [&](auto* option) { return option->group("Output"); };
  output(app.add_option("--json", o.json, "Write everything as JSON"))->option_text("FILE.json");
  output(app.add_option("--error-ply", o.error_ply,
                        "Write the mesh colored by its distance to the truth, with the vertex attribute 'distance'"))
      ->option_text("FILE.ply");
  o.error_range_option = output(app.add_option("--error-range", o.error_range,
                                               "Distance at the bright end (default: 99 % of the mesh is below)"))
                             ->option_text("D");
}

constexpr const char* evaluate_footer =
    R"(EXAMPLES
  soapfilm scan knot -o scans
  soapfilm reconstruct scans/scans.conf -o knot.ply
  soapfilm evaluate knot.ply --truth knot --samples scans/scans.conf --f-score 0.001,0.002
  soapfilm evaluate knot.ply --truth knot --error-ply error.ply --json knot.json
  soapfilm render error.ply -o error.png --color-by distance
)";

}  // namespace

void add_evaluate(CLI::App& app, const GlobalOptions& global, Runner& runner) {
  auto options = std::make_shared<EvaluateOptions>();
  CLI::App* command = app.add_subcommand("evaluate", "Judge a mesh against the truth: distances, normals, topology");
  add_options(*command, *options);
  command->footer(evaluate_footer);
  command->callback([options, &global, &runner] { runner = [options, &global] { return run(*options, global); }; });
}

}  // namespace soapfilm::cli
