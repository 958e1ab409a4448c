// soapfilm scan: virtual scans or even samples of a shape or a mesh, together with the truth.
#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <system_error>
#include <utility>

#include "cli/command.h"
#include "cli/overwrite.h"
#include "cli/scan_options.h"
#include "cli/shell.h"
#include "cli/terminal.h"
#include "soapfilm/core/json_text.h"
#include "soapfilm/core/stages.h"
#include "soapfilm/error.h"
#include "soapfilm/io.h"
#include "soapfilm/io/files.h"
#include "soapfilm/version.h"
#include "tools/mesh/json.h"
#include "tools/scanner/scan_files.h"

namespace soapfilm::cli {

namespace {

using nlohmann::ordered_json;

constexpr const char* conf_file = "scans.conf";
constexpr const char* samples_file = "samples.ply";
constexpr const char* truth_mesh_file = "truth.ply";
constexpr const char* truth_file = "truth.json";
constexpr double truth_tolerance = 2e-5;  // of the longest side
constexpr int truth_version = 1;

ordered_json positions_of(const std::vector<Vec3d>& positions) {
  ordered_json list = ordered_json::array();
  for (const Vec3d& position : positions) list.push_back(json_of(position));
  return list;
}

/// Of a spinning scanner's rings: each, or the lowest and the highest; else null.
ordered_json elevations_of(const ScannerParams& p) {
  if (p.rays != Rays::spinning) return nullptr;
  return p.rings_deg.empty() ? ordered_json{p.lowest_deg, p.highest_deg} : ordered_json(p.rings_deg);
}

ordered_json scanner_facts(const ScannerParams& p, const Box3d& box) {
  return {{"positions", positions_of(scanner_positions(box, p))},
          {"target", json_of(p.target.value_or(box.center()))},
          {"rays", p.rays == Rays::central    ? "central"
                   : p.rays == Rays::parallel ? "parallel"
                                              : "spinning"},
          {"columns", p.step > 0 ? ordered_json(nullptr) : ordered_json(p.columns)},
          {"rows", p.step > 0 ? ordered_json(nullptr) : ordered_json(p.rows)},
          {"step", p.step > 0 ? ordered_json(p.step) : ordered_json(nullptr)},
          {"elevations_deg", elevations_of(p)},
          {"max_range", p.max_range > 0 ? ordered_json(p.max_range) : ordered_json(nullptr)},
          {"noise", p.noise},
          {"ghosts", p.ghosts},
          {"ghost_depth", {p.ghost_lo, p.ghost_hi}},
          {"mixed_pixels", p.mixed_pixels},
          {"outliers", p.outliers},
          {"outlier_kind", p.outlier_kind == Outliers::ray ? "ray" : "box"},
          {"drop_out", p.drop_out},
          {"max_incidence_deg", p.max_incidence_deg},
          {"misalignment_deg", p.misalignment_deg},
          {"misalignment", p.misalignment},
          {"seed", p.seed}};
}

ordered_json sampling_facts(const SamplingParams& p) {
  return {{"directions", p.sensors.empty() ? "normals" : "views"},
          {"positions", positions_of(p.sensors)},
          {"noise", p.noise},
          {"outliers", p.outliers},
          {"seed", p.seed}};
}

/// What was measured, and how: scans or one cloud.
struct Measured {
  ScanSet scans;         ///< without poses when it is one cloud
  ordered_json files;    ///< entries of truth.json
  ordered_json missing;  ///< null when nothing was removed
};

void remove_missing(Measured& measured, const Surface& surface, MissingParams missing, uint64_t seed,
                    const Context& context) {
  if (missing.hole == 0.0 && missing.sparse_half == 1.0) return;
  missing.seed = seed;
  const size_t before = measured.scans.cloud.size();
  const std::vector<bool> keep = kept_samples(surface, measured.scans.cloud, missing, context);
  measured.scans.poses.empty() ? measured.scans.cloud.filter(keep) : filter(measured.scans, keep);
  measured.missing = {{"hole", missing.hole},
                      {"sparse_half", missing.sparse_half},
                      {"samples", before - measured.scans.cloud.size()},
                      {"seed", seed}};
}

Measured measure(const ScanOptions& options, const Surface& surface, const Context& context) {
  const Box3d box = surface.box();
  Measured measured;
  ordered_json how;
  if (options.even_samples()) {
    const SamplingParams params = sampling_params(options, box);
    measured.scans.cloud = sample_surface(surface, params, context);
    how = sampling_facts(params);
  } else {
    const ScannerParams params = scanner_params(options, box);
    measured.scans = virtual_scan(surface, params, context);
    how = scanner_facts(params, box);
  }
  remove_missing(measured, surface, options.missing, options.scanner.seed, context);
  const size_t samples = measured.scans.cloud.size();
  if (options.even_samples()) {
    measured.files = {{"samples", {{"file", samples_file}, {"samples", samples}}}, {"sampling", how}};
  } else {
    measured.files = {{"scans", {{"file", conf_file}, {"count", measured.scans.poses.size()}, {"samples", samples}}},
                      {"scanner", how}};
  }
  if (!measured.missing.is_null()) measured.files["missing"] = measured.missing;
  return measured;
}

/// Refuses before the work a folder that could not be written after it; checks its nearest parent that exists.
void check_folder(const ScanOptions& options) {
  const std::filesystem::path folder(options.folder);
  std::error_code error;
  std::vector<std::string> outputs{(folder / truth_mesh_file).string()};
  if (options.even_samples())
    outputs.push_back((folder / samples_file).string());
  else if (std::filesystem::path(options.object.name).filename().string().starts_with("scan_"))
    outputs.push_back((folder / std::filesystem::path(options.object.name).filename()).string());
  refuse_overwriting(outputs, {options.object.name});
  std::filesystem::path there = std::filesystem::absolute(folder, error), missing;
  while (!std::filesystem::exists(there, error) && there.has_relative_path()) {
    missing = there;
    there = there.parent_path();
  }
  if (!std::filesystem::is_directory(there, error))
    throw OutputError(fmt::format("{}: cannot make the folder: {} is not one", options.folder, there.string()));
  check_output((missing.empty() ? there / truth_file : missing).string());
}

void make_folder(const std::string& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw OutputError(fmt::format("{}: cannot make the folder: {}", folder, error.message()));
}

void write(const ScanOptions& options, const KnownSurface& object, const Mesh& truth, const Measured& measured,
           const Context& context) {
  make_folder(options.folder);
  const std::filesystem::path folder(options.folder);
  const Box3d box = object.surface->box();
  WriteOptions mesh_options;
  mesh_options.coordinate_precision = 1e-9 * box.longest();
  write_mesh((folder / truth_mesh_file).string(), truth, mesh_options);
  ordered_json report = {{"format", "soapfilm truth"},
                         {"format_version", truth_version},
                         {"soapfilm", version},
                         {"object", object.facts},
                         {"mesh", truth_mesh_file}};
  report["object"]["box"] = json_of(box);
  report.update(measured.files);
  write_text_file((folder / truth_file).string(), json_text(report) + "\n");
  if (options.even_samples()) {
    write_points((folder / samples_file).string(), measured.scans.cloud);
  } else {
    write_scans(options.folder, conf_file, measured.scans, context);
  }
}

int run(ScanOptions options, const GlobalOptions& global) {
  check_together(options);
  check_folder(options);
  TerminalProgress progress(global);
  const Context context(global.threads, progress);
  Stages stages(context);
  const KnownSurface object = stages.run("prepare", [&] { return make_object("object", options.object, context); });
  if (object.scanner) take_scanner_of_scene(options, *object.scanner);
  const Measured measured = stages.run("scan", [&] { return measure(options, *object.surface, context); });
  const Mesh truth = stages.run(
      "truth", [&] { return object.surface->tessellate(truth_tolerance * object.surface->box().longest()); });
  stages.run("write", [&] { write(options, object, truth, measured, context); });

  const size_t scans = measured.scans.poses.size();
  const std::string main_file = options.even_samples() ? samples_file : conf_file;
  const std::string input = (std::filesystem::path(options.folder) / main_file).string();
  const std::string in_scans = scans == 0 ? "" : fmt::format(" in {} scan{}", scans, scans == 1 ? "" : "s");
  progress.info(fmt::format("{}: {} samples{}; {} and {} beside it", input, measured.scans.cloud.size(), in_scans,
                            truth_mesh_file, truth_file));
  progress.info(fmt::format("next: soapfilm reconstruct {}", shell_word(input)));
  return 0;
}

constexpr const char* scan_footer =
    R"(A LENGTH is in input units, or with a percent sign in hundredths of the object's longest side.

WRITES
  DIR/scan_000.ply ...  each scan in its scanner's frame, with its range grid
  DIR/scans.conf        their poses: what soapfilm reconstruct reads
  DIR/samples.ply       with --samples instead of both
  DIR/truth.ply         the object as a mesh
  DIR/truth.json        what is known of it (topology, volume, ...) and how it was scanned

EXAMPLES
  soapfilm scan part -o scans
  soapfilm scan knot -o scans --views 24 --noise 0.2% --outliers 0.05 --misalignment 0.1%
  soapfilm scan horse.ply -o scans --orbit ring --elevations 0,35,-35 --views 8 --rays parallel
  soapfilm scan room -o room --noise 0.003 --mixed-pixels 0.3
  soapfilm scan street -o street --rings 2,1,0,-1,-2,-4,-8,-16 --ghosts 0.005 --max-range 70
  soapfilm scan torus -o even --samples 100000 --directions views --hole 0.1
)";

}  // namespace

void add_scan(CLI::App& app, const GlobalOptions& global, Runner& runner) {
  auto options = std::make_shared<ScanOptions>();
  CLI::App* command = app.add_subcommand("scan", "Virtual scans of a shape, a scene or a mesh, with the truth beside");
  add_scan_options(*command, *options);
  command->footer(scan_footer);
  command->callback([options, &global, &runner] { runner = [options, &global] { return run(*options, global); }; });
}

}  // namespace soapfilm::cli
