// soapfilm remesh: even triangles, for simulation.
#include "soapfilm/remesh/remesh.h"

#include <fmt/format.h>

#include <memory>
#include <string>

#include "cli/command.h"
#include "cli/overwrite.h"
#include "cli/parse.h"
#include "cli/print.h"
#include "cli/proved_mesh.h"
#include "cli/read_cloud.h"
#include "cli/terminal.h"
#include "soapfilm/core/stages.h"
#include "soapfilm/error.h"
#include "soapfilm/io.h"
#include "soapfilm/io/files.h"

namespace soapfilm::cli {

namespace {

struct RemeshOptions {
  std::string input, output, edge, tolerance;
  bool ascii = false;
};

RemeshParams params_of(const RemeshOptions& options, double longest) {
  RemeshParams params;
  params.edge = parse_length("edge", options.edge, longest);
  if (!options.tolerance.empty()) params.tolerance = parse_length("tolerance", options.tolerance, longest);
  return params;
}

void announce(const RemeshReport& report, const RemeshOptions& options, double edge, TerminalProgress& progress) {
  progress.info(fmt::format("{}: {} triangles for {}, each mesh proved within {:.3g} of the other", options.output,
                            report.triangles, report.triangles_before, report.proved));
  progress.info(fmt::format(
      "{:.2f} % of edges are 0.7 to 1.4 times {:.4g} long, {:.2f} % of triangles have no angle below 20 degrees, the "
      "smallest has {:.1f}",
      100 * report.even_edges, edge, 100 * report.good_angles, report.smallest_angle));
  if (!(report.proved <= 0.5 * edge))
    progress.warn(
        fmt::format("{}: details are finer than edges of {:.4g}: the distance is {:.3g}, more than half of that",
                    options.output, edge, report.proved));
  if (report.intersecting > 0)
    progress.warn(fmt::format("{}: {} pairs of triangles intersect", options.output, report.intersecting));
}

int run(const RemeshOptions& options, const GlobalOptions& global) {
  check_mesh_output(options.output);
  refuse_overwriting({options.output}, {options.input});
  TerminalProgress progress(global);
  const Context context(global.threads, progress);
  Stages stages(context);
  ReadReport read;
  const Mesh mesh = stages.run("read", [&] { return read_mesh(options.input, &read); });
  warn_of(read, progress);
  const RemeshParams params = params_of(options, mesh.box().longest());
  const Remeshed result =
      stages.run("remesh", [&] { return with_mesh_of(options.input, [&] { return remesh(mesh, params, context); }); });
  stages.run("write", [&] {
    const WriteReport written = write_mesh(options.output, result.mesh, proved_options(options.ascii), context);
    for (const std::string& warning : written.warnings) progress.warn(warning);
  });
  announce(result.report, options, params.edge, progress);
  return 0;
}

}  // namespace

void add_remesh(CLI::App& app, const GlobalOptions& global, Runner& runner) {
  auto options = std::make_shared<RemeshOptions>();
  CLI::App* command =
      app.add_subcommand("remesh", "Even triangles for simulation, within a proved distance of the mesh");
  command->add_option("mesh", options->input, fmt::format("A closed or open 2-manifold ({})", mesh_extensions()))
      ->required()
      ->option_text("MESH");
  command->add_option("-o,--output", options->output, "The mesh with even triangles, by extension")
      ->required()
      ->option_text("FILE");
  command
      ->add_option("--edge", options->edge, "The length that edges shall have: input units, or % of the longest side")
      ->required()
      ->option_text("LENGTH");
  command
      ->add_option("--tolerance", options->tolerance,
                   "No point of either mesh is farther than this from the other, by smaller triangles\n"
                   "where need be; by default half of the edges' length")
      ->option_text("TOL");
  command->add_flag("--ascii", options->ascii, "PLY and STL as text");
  command->callback([options, &global, &runner] { runner = [options, &global] { return run(*options, global); }; });
}

}  // namespace soapfilm::cli
