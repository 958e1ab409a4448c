// soapfilm compare: a scan or a mesh against its design.
#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "cli/command.h"
#include "cli/object.h"
#include "cli/overwrite.h"
#include "cli/print.h"
#include "cli/read_cloud.h"
#include "cli/terminal.h"
#include "soapfilm/core/json_text.h"
#include "soapfilm/core/stages.h"
#include "soapfilm/error.h"
#include "soapfilm/io.h"
#include "soapfilm/io/files.h"
#include "soapfilm/io/sets/input_files.h"
#include "tools/compare/compare_report.h"
#include "tools/render/render.h"
#include "tools/view/view.h"

namespace soapfilm::cli {

namespace {

/// The values of the options, before they are checked.
struct CompareRequest {
  CompareSubject subject;
  ReadOptions read;
  std::string output, picture, html, json;
  double range = 0;  ///< distance at the ends of the colors; 0: twice the tolerance, or 99 % of the part
  const CLI::Option* range_option = nullptr;
  const CLI::Option* tolerance_option = nullptr;
  const CLI::Option* least_option = nullptr;
};

using ComparedPart = std::variant<MeshPart, ScanPart>;
using Colored = std::variant<Mesh, PointCloud>;

void check(const CompareRequest& r) {
  validate(r.subject.options);
  const auto positive = [](const CLI::Option* option, const char* name, double value) {
    if (option->count() > 0 && !(value > 0.0 && std::isfinite(value)))
      throw ParameterError(fmt::format("{} = {}, must be > 0 and finite", name, value));
  };
  positive(r.tolerance_option, "tolerance", r.subject.options.tolerance);
  positive(r.range_option, "range", r.range);
  if (r.least_option->count() > 0 && r.tolerance_option->count() == 0)
    throw ParameterError("--least: only --tolerance has it");
  if (r.range_option->count() > 0 && r.output.empty() && r.picture.empty() && r.html.empty())
    throw ParameterError("--range: only --output, --picture and --html have it");
  const std::vector<std::string> outputs{r.output, r.picture, r.html, r.json};
  refuse_overwriting(outputs, {r.subject.part, r.subject.model});
  for (const std::string& output : outputs)
    if (!output.empty()) check_output(output);
  if (!r.picture.empty() && std::filesystem::path(r.picture).extension() != ".png")
    throw ParameterError(fmt::format("picture = {}, must end in .png", r.picture));
  if (!r.output.empty() && std::filesystem::path(r.output).extension() != ".ply")
    throw ParameterError(fmt::format("output = {}, must end in .ply", r.output));
  if (!r.html.empty() && !has_viewer()) viewer_page({}, {}, Context(1));  // says how to get one
}

ComparedPart read_part(CompareRequest& r, const Context& context) {
  const std::vector<std::string> files = io::without_patterns({r.subject.part});
  r.subject.is_scan = files.size() > 1 || file_kind(files[0]) == FileKind::points;
  if (!r.subject.is_scan) return MeshPart{read_surface(files[0], context), {}};
  ReadReport read;
  ScanPart part{read_cloud({r.subject.part}, r.read, context, read), {}};
  std::vector<std::string> scans;  // of a set
  for (const FileReport& file : read.files) scans.push_back(file.path);
  refuse_overwriting({r.output, r.picture, r.html, r.json}, scans);
  return part;
}

double range_of(const CompareRequest& r, const Comparison& comparison) {
  if (r.range > 0) return r.range;
  return comparison.part_to_model.histogram_end;
}

/// From both sides, as half of a part is behind.
void draw(const CompareRequest& r, const Colored& colored, double top, const Context& context) {
  const std::string colors = fmt::format("blue {:+.3g}, green 0, red {:+.3g}{}", -top, top,
                                         r.subject.unit.empty() ? "" : " " + r.subject.unit);
  RenderItem item;
  std::visit([&](const auto& shape) { item.shape = &shape; }, colored);
  item.caption = colors;
  RenderParams params;
  params.up = {0, 0, 1};
  params.from = {1, -1, 0.7};
  const Image front = render({item}, params, context);
  params.from = {-1, 1, -0.7};
  const Image back = render({item}, params, context);
  Image both(front.width + back.width, front.height, {});
  for (int y = 0; y < front.height; ++y) {
    for (int x = 0; x < front.width; ++x) both.at(x, y) = front.at(x, y);
    for (int x = 0; x < back.width; ++x) both.at(front.width + x, y) = back.at(x, y);
  }
  write_png(r.picture, both);
}

void write_outputs(const CompareRequest& r, const ComparedPart& part, const Mesh& model, const Comparison& comparison,
                   const Context& context) {
  if (!r.json.empty()) write_text_file(r.json, json_text(compare_json(r.subject, comparison)) + "\n");
  if (r.output.empty() && r.picture.empty() && r.html.empty()) return;
  const double top = range_of(r, comparison);
  const Colored colored = std::visit([&](const auto& p) { return Colored(color_by_deviation(p, top)); }, part);
  WriteOptions write;
  write.comments = {fmt::format("distance: to the model, positive outside; colors from {:.6g} to {:.6g}", -top, top)};
  if (!r.output.empty()) {
    if (const Mesh* mesh = std::get_if<Mesh>(&colored)) write_mesh(r.output, *mesh, write, context);
    if (const PointCloud* cloud = std::get_if<PointCloud>(&colored)) write_points(r.output, *cloud, write, context);
  }
  if (!r.picture.empty()) draw(r, colored, top, context);
  if (!r.html.empty()) {
    std::vector<ViewItem> items(2);
    std::visit([&](const auto& shape) { items[0].shape = &shape; }, colored);
    items[0].name = named_path(r.subject.part).filename().string();
    items[1].shape = &model;
    items[1].name = std::filesystem::path(r.subject.model).filename().string();
    ViewParams params;
    params.unit = r.subject.unit;
    params.up = UpAxis::z;
    write_text_file(r.html, viewer_page(items, params, context));
  }
}

int run(CompareRequest& r, const GlobalOptions& global) {
  TerminalProgress progress(global);
  const Context context(global.threads, progress);
  check(r);
  Stages stages(context);
  Mesh model;
  ComparedPart part;
  stages.run("read", [&] {
    model = read_surface(r.subject.model, context);
    part = read_part(r, context);
  });
  const Comparison comparison = stages.run("compare", [&] {
    return std::visit([&](auto& p) { return compare(p, model, r.subject.options, context); }, part);
  });
  stages.run("write", [&] { write_outputs(r, part, model, comparison, context); });
  print(stdout, compare_table(r.subject, comparison));
  constexpr int not_within = 4;  // as of reconstruct --strict; all is written
  return comparison.within_tolerance.value_or(true) ? 0 : not_within;
}

void add_options(CLI::App& app, CompareRequest& r) {
  CompareOptions& o = r.subject.options;
  app.add_option("part", r.subject.part,
                 fmt::format("A mesh ({})\nor a scan ({}),\na folder of scans", mesh_extensions(), point_extensions()))
      ->required()
      ->option_text("SCAN|MESH");
  app.add_option("model", r.subject.model, "What it is to be: a mesh, such as of a CAD program")
      ->required()
      ->option_text("MODEL");
  r.tolerance_option =
      app.add_option("--tolerance", o.tolerance, "Distance that is allowed, in input units: gives a verdict")
          ->option_text("D");
  r.least_option = app.add_option("--least", o.least, "Share that must be within it, from both sides")
                       ->option_text(fmt::format("SHARE [{:g}]", o.least));
  app.add_flag("--align", o.align, "Move the part onto the model first: rigid best fit, from near its place")
      ->option_text(" ");
  app.add_option("--points", o.points, "On each mesh, even by area")
      ->check(CLI::Range(1, 100'000'000))
      ->option_text(fmt::format("N [{}]", o.points));
  app.add_option("--seed", o.seed, "Of where they lie")
      ->check(CLI::Range(int64_t{0}, std::numeric_limits<int64_t>::max()))
      ->option_text(fmt::format("N [{}]", o.seed));
  app.add_option("--unit", r.subject.unit, "Unit of the files' lengths, such as mm; it is only shown")
      ->option_text("NAME");
  add_read_options(app, r.read);

  const auto output = [&](auto* option) { return option->group("Output"); };
  output(app.add_option("-o,--output", r.output,
                        "Write the part, moved by --align, with colors and the attribute 'distance'"))
      ->option_text("FILE.ply");
  output(app.add_option("--picture", r.picture, "Draw it in these colors, z up"))->option_text("FILE.png");
  output(app.add_option("--html", r.html, "Write a page for the browser: the part beside the model"))
      ->option_text("FILE");
  r.range_option = output(app.add_option("--range", r.range,
                                         "Distance at the ends of the colors (default: twice the tolerance, or 99 %\n"
                                         "of the part are below)"))
                       ->option_text("D");
  output(app.add_option("--json", r.json, "Write everything as JSON"))->option_text("FILE.json");
}

constexpr const char* compare_footer =
    R"(EXAMPLES
  soapfilm compare scan.ply cad.stl --align --tolerance 0.1 --unit mm
  soapfilm compare part.ply cad.stl --tolerance 0.1 --picture part.png --html part.html --json part.json

EXIT CODE
  0 within tolerance, or measured without one; 4 not within; 2 refused
)";

}  // namespace

void add_compare(CLI::App& app, const GlobalOptions& global, Runner& runner) {
  auto request = std::make_shared<CompareRequest>();
  CLI::App* command =
      app.add_subcommand("compare", "How far a scan or a mesh is from its design: distances, verdict, picture");
  add_options(*command, *request);
  command->footer(compare_footer);
  command->callback([request, &global, &runner] { runner = [request, &global] { return run(*request, global); }; });
}

}  // namespace soapfilm::cli
