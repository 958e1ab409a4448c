// soapfilm measure: area, volume, sections of a mesh.
#include <fmt/format.h>

#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "cli/command.h"
#include "cli/measure_planes.h"
#include "cli/object.h"
#include "cli/overwrite.h"
#include "cli/parse.h"
#include "cli/print.h"
#include "cli/terminal.h"
#include "soapfilm/core/json_text.h"
#include "soapfilm/core/stages.h"
#include "soapfilm/error.h"
#include "soapfilm/io/files.h"
#include "tools/measure/measure.h"
#include "tools/measure/section_files.h"

namespace soapfilm::cli {

namespace {

/// The values of the options, before they are checked.
struct MeasureRequest {
  MeasureSubject subject;
  std::string above;  ///< a plane or a mesh
  std::vector<std::string> sections;
  std::string contours;
  std::string within;
  std::string json;
  const CLI::Option* cell_option = nullptr;
  const CLI::Option* voxel_option = nullptr;
};

Window parse_window(const std::string& text) {
  const std::vector<double> v = parse_numbers("within", text, ',', 4, "four numbers X0,Y0,X1,Y1");
  if (!(v[0] < v[2] && v[1] < v[3] && std::isfinite(v[2] - v[0]) && std::isfinite(v[3] - v[1])))
    throw ParameterError(fmt::format("within = {}, must be X0,Y0,X1,Y1 with X0 < X1 and Y0 < Y1", text));
  return {v[0], v[1], v[2], v[3]};
}

void check(MeasureRequest& r) {
  MeasureOptions& options = r.subject.options;
  const auto positive = [](const CLI::Option* option, const char* name, double value) {
    if (option->count() > 0 && !(value > 0.0 && std::isfinite(value)))
      throw ParameterError(fmt::format("{} = {}, must be > 0 and finite", name, value));
  };
  positive(r.cell_option, "cell", options.columns.cell);
  positive(r.voxel_option, "voxel", r.subject.voxel);
  if (!r.above.empty() && looks_like_plane(r.above)) options.above = parse_plane("above", r.above);
  if (!r.above.empty() && !options.above) r.subject.base = r.above;
  for (const std::string& text : r.sections)
    for (const Plane& plane : parse_planes("section", text)) options.sections.push_back(plane);
  const bool columns = !r.subject.base.empty() || !r.subject.before.empty();
  if (!r.within.empty()) {
    if (r.above.empty() && !columns) throw ParameterError("--within: only --above and --before have it");
    options.columns.window = parse_window(r.within);
    if (options.above && options.above->normal.z != 1)
      throw ParameterError(fmt::format("above = {}, must be z=Z beside --within, whose walls are vertical", r.above));
  }
  if (r.cell_option->count() > 0 && !columns)
    throw ParameterError("--cell: only a mesh of --above or --before has it; above a plane the volume is exact");
  if (!r.contours.empty() && r.sections.empty()) throw ParameterError("--contours: only --section has it");
  refuse_overwriting({r.json, r.contours}, {r.subject.mesh, r.subject.base, r.subject.before});
  for (const std::string& output : {r.json, r.contours})
    if (!output.empty()) check_output(output);
  if (!r.contours.empty()) check_section_output(r.contours);
}

int run(MeasureRequest& r, const GlobalOptions& global) {
  TerminalProgress progress(global);
  const Context context(global.threads, progress);
  check(r);
  Stages stages(context);
  Mesh mesh;
  std::optional<Mesh> base, before;
  stages.run("read", [&] {
    mesh = read_surface(r.subject.mesh, context);
    if (!r.subject.base.empty()) base = read_surface(r.subject.base, context);
    if (!r.subject.before.empty()) before = read_surface(r.subject.before, context);
  });
  const Measures measures = stages.run("measure", [&] {
    return measure(mesh, r.subject.options, context, base ? &*base : nullptr, before ? &*before : nullptr);
  });
  if (!r.json.empty() || !r.contours.empty()) {
    stages.run("write", [&] {
      if (!r.contours.empty()) write_sections(r.contours, measures.sections);
      if (!r.json.empty()) write_text_file(r.json, json_text(measure_json(r.subject, measures)) + "\n");
    });
  }
  print(stdout, measure_table(r.subject, measures));
  return 0;
}

void add_options(CLI::App& app, MeasureRequest& r) {
  app.add_option("mesh", r.subject.mesh, fmt::format("The mesh to measure ({})", mesh_extensions()))
      ->required()
      ->option_text("MESH");
  app.add_option("--above", r.above,
                 fmt::format("The volume above a plane ({})\nor above another mesh, such as bare ground", plane_form))
      ->option_text("PLANE|MESH");
  app.add_option("--before", r.subject.before, "The same place earlier: what was added and taken away since")
      ->option_text("MESH");
  app.add_option("--within", r.within, "Only these volumes within a rectangle, straight down")
      ->option_text("X0,Y0,X1,Y1");
  r.cell_option = app.add_option("--cell", r.subject.options.columns.cell,
                                 "Edge of the columns between two meshes (default: a million columns)")
                      ->option_text("SIZE");
  app.add_option("--section", r.sections,
                 "Cut the mesh by a plane, as of --above, or by those of z=FROM:TO:STEP; may be given again")
      ->allow_extra_args(false)
      ->option_text("PLANE");
  r.voxel_option =
      app.add_option("--voxel", r.subject.voxel, "Say how the volume changes when the surface moves by this much")
          ->option_text("SIZE");
  app.add_option("--unit", r.subject.unit, "Unit of the file's lengths, such as m; it is only shown")
      ->option_text("NAME");
  const auto output = [&](auto* option) { return option->group("Output"); };
  output(app.add_option("--contours", r.contours, "Write the sections' contours as SVG, DXF or CSV"))
      ->option_text("FILE");
  output(app.add_option("--json", r.json, "Write everything as JSON"))->option_text("FILE.json");
}

constexpr const char* measure_footer =
    R"(EXAMPLES
  soapfilm measure part.ply
  soapfilm measure heap.ply --above z=101.5 --within 10,10,60,45 --unit m
  soapfilm measure june.ply --before may.ply --cell 0.1
  soapfilm measure part.ply --section z=0:40:5 --contours sections.dxf
)";

}  // namespace

void add_measure(CLI::App& app, const GlobalOptions& global, Runner& runner) {
  auto request = std::make_shared<MeasureRequest>();
  CLI::App* command =
      app.add_subcommand("measure", "Area, volume, extents and sections of a mesh; what changed between two");
  add_options(*command, *request);
  command->footer(measure_footer);
  command->callback([request, &global, &runner] { runner = [request, &global] { return run(*request, global); }; });
}

}  // namespace soapfilm::cli
