// soapfilm scan: virtual scans of a shape or a mesh, and the truth beside them.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "cli/command.h"
#include "cli/terminal.h"
#include "soapfilm/core/error.h"
#include "soapfilm/core/stages.h"
#include "soapfilm/io/io.h"
#include "soapfilm/scanner/mesh_surface.h"
#include "soapfilm/scanner/scan_files.h"
#include "soapfilm/scanner/shape.h"
#include "soapfilm/version.h"

namespace soapfilm::cli {

namespace {

using nlohmann::ordered_json;

constexpr const char* conf_file = "scans.conf";
constexpr const char* truth_mesh_file = "truth.ply";
constexpr const char* truth_file = "truth.json";
constexpr double truth_tolerance = 2e-5;  // of the longest side
constexpr int truth_version = 1;

/// What the options say, before it is checked. Lengths may be given in percent of the longest side.
struct Options {
  std::string object;
  std::string folder;
  std::string image;
  std::string step, noise, misalignment;
  std::vector<std::string> positions;
  std::string target;
  std::string centre;
  ShapeParams shape;
  std::vector<const CLI::Option*> shape_only;  ///< options that a mesh has no use for
  ScannerParams scanner;
  const CLI::Option* elevations = nullptr;
};

/// Numbers separated by `separator`, exactly `count` of them.
std::vector<double> numbers(const char* option, const std::string& text, char separator, size_t count,
                            const char* form) {
  std::vector<double> values;
  for (size_t begin = 0; begin <= text.size();) {
    const size_t end = std::min(text.find(separator, begin), text.size());
    const std::string word = text.substr(begin, end - begin);
    size_t used = 0;
    try {
      values.push_back(std::stod(word, &used));
    } catch (const std::exception&) {
      used = 0;
    }
    if (used != word.size() || used == 0) throw ParameterError(fmt::format("{} = {}, must be {}", option, text, form));
    begin = end + 1;
  }
  if (values.size() != count) throw ParameterError(fmt::format("{} = {}, must be {}", option, text, form));
  return values;
}

Vec3d parse_point(const char* option, const std::string& text) {
  const std::vector<double> v = numbers(option, text, ',', 3, "three numbers X,Y,Z");
  return {v[0], v[1], v[2]};
}

/// A length in input units, or with a percent sign in hundredths of `longest`.
double parse_length(const char* option, std::string text, double longest) {
  const bool percent = !text.empty() && text.back() == '%';
  const std::string number = percent ? text.substr(0, text.size() - 1) : text;
  const double value = numbers(option, number, '\0', 1, "a number >= 0, or one with a percent sign")[0];
  return percent ? 0.01 * value * longest : value;
}

ScannerParams finish_params(const Options& options, const Box3d& box) {
  ScannerParams params = options.scanner;
  if (options.elevations->count() > 0 && params.orbit != Orbit::ring)
    throw ParameterError("elevations: only --orbit ring has them");
  const auto length = [&](const char* option, const std::string& text, double& value) {
    if (!text.empty()) value = parse_length(option, text, box.longest());
  };
  length("step", options.step, params.step);
  length("noise", options.noise, params.noise);
  length("misalignment", options.misalignment, params.misalignment);
  for (const std::string& text : options.positions) params.positions.push_back(parse_point("position", text));
  if (!options.target.empty()) params.target = parse_point("target", options.target);
  if (!options.image.empty()) {
    const std::vector<double> size = numbers("image", options.image, 'x', 2, "two whole numbers such as 300x300");
    for (const double n : size)
      if (!(n >= 1 && n <= 20000 && n == static_cast<int>(n)))
        throw ParameterError(fmt::format("image = {}, must be whole numbers in [1, 20000]", options.image));
    params.columns = static_cast<int>(size[0]);
    params.rows = static_cast<int>(size[1]);
  }
  return params;
}

/// What is scanned, and what is known about it.
struct Object {
  std::shared_ptr<const Surface> surface;
  ordered_json facts;
};

ordered_json json_of(const Vec3d& v) { return {v.x, v.y, v.z}; }

Object make_object(const Options& options, const Parallel& parallel, Progress& progress) {
  const std::vector<std::string> names = shape_names();
  Object object;
  if (std::find(names.begin(), names.end(), options.object) != names.end()) {
    ShapeParams params = options.shape;
    if (!options.centre.empty()) params.centre = parse_point("centre", options.centre);
    const std::shared_ptr<const Shape> shape = make_shape(options.object, params);
    const ShapeFacts& facts = shape->facts();
    object.facts = {{"shape", facts.name}, {"parameters", ordered_json::object()}};
    for (const auto& [name, value] : facts.parameters) object.facts["parameters"][name] = value;
    object.facts["centre"] = json_of(params.centre);
    object.facts["components"] = facts.components;
    object.facts["genus"] = facts.genus;
    object.facts["narrowest"] = facts.narrowest;
    object.facts["volume"] = facts.volume ? ordered_json(*facts.volume) : ordered_json(nullptr);
    object.facts["area"] = facts.area ? ordered_json(*facts.area) : ordered_json(nullptr);
    object.surface = shape;
    return object;
  }
  const std::filesystem::path path(options.object);
  if (!path.has_extension() && !std::filesystem::exists(path))
    throw ParameterError(
        fmt::format("object = {}, must be one of {}, or a mesh file", options.object, fmt::join(names, ", ")));
  for (const CLI::Option* option : options.shape_only)
    if (option->count() > 0)
      throw ParameterError(
          fmt::format("{}: only built-in shapes have it, {} is a mesh", option->get_name(), options.object));
  const auto mesh = std::make_shared<const MeshSurface>(read_mesh(options.object), parallel);
  if (mesh->turned())
    progress.warn(fmt::format("{}: inside-out (negative volume), its faces are turned", options.object));
  object.facts = {{"file", options.object},
                  {"turned", mesh->turned()},
                  {"volume", mesh->mesh().volume()},
                  {"area", mesh->mesh().area()}};
  object.surface = mesh;
  return object;
}

ordered_json json_of(const ScannerParams& p, const Box3d& box) {
  ordered_json positions = ordered_json::array();
  for (const Vec3d& position : scanner_positions(box, p)) positions.push_back(json_of(position));
  return {{"positions", positions},
          {"target", json_of(p.target.value_or(box.centre()))},
          {"rays", p.rays == Rays::central ? "central" : "parallel"},
          {"columns", p.step > 0 ? ordered_json(nullptr) : ordered_json(p.columns)},
          {"rows", p.step > 0 ? ordered_json(nullptr) : ordered_json(p.rows)},
          {"step", p.step > 0 ? ordered_json(p.step) : ordered_json(nullptr)},
          {"noise", p.noise},
          {"outliers", p.outliers},
          {"outlier_kind", p.outlier_kind == Outliers::ray ? "ray" : "box"},
          {"drop_out", p.drop_out},
          {"max_incidence_deg", p.max_incidence_deg},
          {"misalignment_deg", p.misalignment_deg},
          {"misalignment", p.misalignment},
          {"seed", p.seed}};
}

void make_folder(const std::string& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error || !std::filesystem::is_directory(folder))
    throw OutputError(fmt::format("{}: cannot make the folder: {}", folder,
                                  error ? error.message() : "a file of that name is in the way"));
}

int run(const Options& options, const GlobalOptions& global) {
  TerminalProgress progress(global);
  const Parallel parallel(global.threads);
  Stages stages(progress);
  const Object object = stages.run("prepare", [&] { return make_object(options, parallel, progress); });
  const Box3d box = object.surface->box();
  const ScannerParams params = finish_params(options, box);
  const ScanSet set = stages.run("scan", [&] { return virtual_scan(*object.surface, params, parallel, progress); });
  const Mesh truth = stages.run("truth", [&] { return object.surface->tessellate(truth_tolerance * box.longest()); });

  stages.run("write", [&] {
    make_folder(options.folder);
    const std::filesystem::path folder(options.folder);
    MeshWriteOptions mesh_options;
    mesh_options.coordinate_precision = 1e-9 * box.longest();
    write_mesh((folder / truth_mesh_file).string(), truth, mesh_options);
    ordered_json object_facts = object.facts;
    object_facts["box"] = {{"lo", json_of(box.lo)}, {"hi", json_of(box.hi)}};
    const ordered_json report = {
        {"format", "soapfilm truth"},
        {"format_version", truth_version},
        {"soapfilm", version},
        {"object", object_facts},
        {"mesh", truth_mesh_file},
        {"scans", {{"file", conf_file}, {"count", set.poses.size()}, {"samples", set.cloud.size()}}},
        {"scanner", json_of(params, box)}};
    write_text_file((folder / truth_file).string(), report.dump(2) + "\n");
    write_scans(options.folder, conf_file, set, progress);
  });
  const std::string conf = (std::filesystem::path(options.folder) / conf_file).string();
  progress.info(fmt::format("{}: {} samples in {} scan{}; {} and {} beside it", conf, set.cloud.size(),
                            set.poses.size(), set.poses.size() == 1 ? "" : "s", truth_mesh_file, truth_file));
  progress.info(fmt::format("next: soapfilm reconstruct {} -o mesh.ply", conf));
  return 0;
}

void add_object_options(CLI::App& app, Options& o) {
  app.add_option(
         "object", o.object,
         fmt::format("A built-in shape ({})\nor a mesh (.ply, .obj, .off, .stl)", fmt::join(shape_names(), ", ")))
      ->required()
      ->option_text("SHAPE|MESH");
  app.add_option("-o,--output", o.folder, "Folder for the scans and the truth; made when absent")
      ->required()
      ->option_text("DIR");
  app.add_flag("--normals", o.scanner.normals, "Write the true normals with the samples");

  const auto shape = [&](auto* option) {
    o.shape_only.push_back(option);
    return option->group("Shape");
  };
  shape(app.add_option("--size", o.shape.size, "Longest side of a built-in shape"))
      ->option_text(fmt::format("V [{:g}]", o.shape.size));
  shape(app.add_option("--centre", o.centre, "Centre of its box"))->option_text("X,Y,Z [0,0,0]");
  shape(app.add_option("--thickness", o.shape.thickness, "Of the plate and the sheets, as a part of the size"))
      ->option_text(fmt::format("V [{:g}]", o.shape.thickness));
  shape(app.add_option("--gap", o.shape.gap, "Between the sheets, as a part of the size"))
      ->option_text(fmt::format("V [{:g}]", o.shape.gap));
}

void add_view_options(CLI::App& app, Options& o) {
  ScannerParams& p = o.scanner;
  const auto views = [&](auto* option) { return option->group("Scanner positions"); };
  views(app.add_option("--views", p.views, "Positions on the orbit, on each circle of a ring"))
      ->option_text(fmt::format("N [{}]", p.views));
  views(app.add_option("--orbit", p.orbit, "fibonacci: evenly over a sphere; ring: on circles"))
      ->transform(CLI::CheckedTransformer(std::vector<std::pair<std::string, Orbit>>{{"fibonacci", Orbit::fibonacci},
                                                                                     {"ring", Orbit::ring}})
                      .description(""))
      ->option_text("ORBIT [fibonacci]");
  o.elevations =
      views(app.add_option("--elevations", p.elevations_deg, "Degrees of the ring's circles above the object"))
          ->delimiter(',')
          ->option_text(fmt::format("A,B,... [{:g}]", fmt::join(p.elevations_deg, ",")));
  views(app.add_option("--distance", p.distance, "From the target, in diagonals of the object's box"))
      ->option_text(fmt::format("V [{:g}]", p.distance));
  views(app.add_option("--position", o.positions, "A scanner position instead of an orbit; may be repeated"))
      ->allow_extra_args(false)
      ->option_text("X,Y,Z");
  views(app.add_option("--target", o.target, "What every view looks at (default: the box's centre)"))
      ->option_text("X,Y,Z");

  const auto rays = [&](auto* option) { return option->group("Rays"); };
  rays(app.add_option("--rays", p.rays, "central: all start at the scanner; parallel: one direction"))
      ->transform(CLI::CheckedTransformer(std::vector<std::pair<std::string, Rays>>{{"central", Rays::central},
                                                                                    {"parallel", Rays::parallel}})
                      .description(""))
      ->option_text("KIND [central]");
  CLI::Option* image = rays(app.add_option("--image", o.image, "Columns and rows of each range image"))
                           ->option_text(fmt::format("CxR [{}x{}]", p.columns, p.rows));
  rays(app.add_option("--step", o.step, "Distance of neighbouring rays at the target, instead of --image"))
      ->excludes(image)
      ->option_text("LENGTH");
}

void add_error_options(CLI::App& app, Options& o) {
  ScannerParams& p = o.scanner;
  const auto errors = [&](auto* option) { return option->group("Errors of measurement"); };
  errors(app.add_option("--noise", o.noise, "Standard deviation along the ray"))->option_text("LENGTH [0]");
  errors(app.add_option("--outliers", p.outliers, "Share of the samples, 0 to 1"))
      ->option_text(fmt::format("V [{:g}]", p.outliers));
  errors(app.add_option("--outlier-kind", p.outlier_kind, "ray: elsewhere on the ray; box: anywhere around the object"))
      ->transform(CLI::CheckedTransformer(
                      std::vector<std::pair<std::string, Outliers>>{{"ray", Outliers::ray}, {"box", Outliers::box}})
                      .description(""))
      ->option_text("KIND [ray]");
  errors(app.add_option("--drop-out", p.drop_out, "Share of the hits that are lost, 0 to 1"))
      ->option_text(fmt::format("V [{:g}]", p.drop_out));
  errors(app.add_option("--max-incidence", p.max_incidence_deg, "Hits at a larger angle to the normal are lost"))
      ->option_text(fmt::format("DEGREES [{:g}]", p.max_incidence_deg));
  errors(app.add_option("--misalignment", o.misalignment, "Standard deviation of each scan's shift along an axis"))
      ->option_text("LENGTH [0]");
  errors(app.add_option("--misalignment-angle", p.misalignment_deg, "The same of its rotation about its centre"))
      ->option_text(fmt::format("DEGREES [{:g}]", p.misalignment_deg));
  errors(app.add_option("--seed", p.seed, "Of all random numbers"))
      ->check(CLI::NonNegativeNumber)
      ->option_text(fmt::format("N [{}]", p.seed));
}

constexpr const char* footer =
    R"(A LENGTH is in input units, or with a percent sign in hundredths of the object's longest side.

WRITES
  DIR/scan_000.ply ...  each scan in its scanner's frame, with its range grid
  DIR/scans.conf        their poses: what soapfilm reconstruct reads
  DIR/truth.ply         the object as a mesh
  DIR/truth.json        what is known of it (topology, volume, ...) and how it was scanned

EXAMPLES
  soapfilm scan part -o scans
  soapfilm scan knot -o scans --views 24 --noise 0.2% --outliers 0.05 --misalignment 0.1%
  soapfilm scan horse.ply -o scans --orbit ring --elevations 0,35,-35 --views 8 --rays parallel
)";

}  // namespace

void add_scan(CLI::App& app, const GlobalOptions& global, Runner& runner) {
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("scan", "Virtual scans of a shape or a mesh, with the truth beside them");
  add_object_options(*command, *options);
  add_view_options(*command, *options);
  add_error_options(*command, *options);
  command->footer(footer);
  command->callback([options, &global, &runner] { runner = [options, &global] { return run(*options, global); }; });
}

}  // namespace soapfilm::cli
