// soapfilm simplify: fewer triangles, within a distance that is proved.
#include "soapfilm/simplify.h"

#include <fmt/format.h>

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "cli/command.h"
#include "cli/detail_levels.h"
#include "cli/overwrite.h"
#include "cli/parse.h"
#include "cli/print.h"
#include "cli/proved_mesh.h"
#include "cli/read_cloud.h"
#include "cli/terminal.h"
#include "soapfilm/core/json_text.h"
#include "soapfilm/core/printable.h"
#include "soapfilm/core/stages.h"
#include "soapfilm/error.h"
#include "soapfilm/io.h"
#include "soapfilm/io/files.h"

namespace soapfilm::cli {

namespace {

struct SimplifyOptions {
  std::string input, output, tolerance;
  std::optional<size_t> triangles;
  LodCount lod;
  bool ascii = false;
};

Simplified simplified(const Mesh& mesh, const SimplifyOptions& options, const Context& context) {
  if (options.triangles) return simplify_to(mesh, *options.triangles, context);
  return simplify(mesh, parse_length("tolerance", options.tolerance, mesh.box().longest()), context);
}

int run(const SimplifyOptions& options, const GlobalOptions& global) {
  if (options.tolerance.empty() == !options.triangles)
    throw ParameterError("simplify: one of --tolerance and --triangles must be given");
  const std::vector<std::string> files = lod_files(options.output, options.lod);
  for (const std::string& file : files) check_mesh_output(file);
  refuse_overwriting(files, {options.input});
  TerminalProgress progress(global);
  const Context context(global.threads, progress);
  Stages stages(context);
  ReadReport read;
  const Mesh mesh = stages.run("read", [&] { return read_mesh(options.input, &read); });
  warn_of(read, progress);
  Simplified result = stages.run(
      "simplify", [&] { return with_mesh_of(options.input, [&] { return simplified(mesh, options, context); }); });
  const SimplifyReport report = result.report;
  const auto make_levels = [&] { return detail_levels(std::move(result), options.lod, context); };
  const std::vector<DetailLevel> levels = options.lod ? stages.run("levels", make_levels) : make_levels();
  stages.run("write", [&] {
    const WriteReport written = write_levels(options.output, levels, proved_options(options.ascii), context);
    for (const std::string& warning : written.warnings) progress.warn(warning);
  });
  progress.info(fmt::format(
      "{}: {} of {} triangles ({:.3g} %), each mesh proved within {:.3g} of the other", options.output,
      report.triangles, report.triangles_before,
      100.0 * static_cast<double>(report.triangles) / static_cast<double>(report.triangles_before), report.proved));
  announce_levels(options.output, levels, progress);
  return 0;
}

}  // namespace

void add_simplify(CLI::App& app, const GlobalOptions& global, Runner& runner) {
  auto options = std::make_shared<SimplifyOptions>();
  CLI::App* command = app.add_subcommand("simplify", "Fewer triangles, within a proved distance of the mesh");
  command->add_option("mesh", options->input, fmt::format("A closed or open 2-manifold ({})", mesh_extensions()))
      ->required()
      ->option_text("MESH");
  command->add_option("-o,--output", options->output, "The smaller mesh, by extension")
      ->required()
      ->option_text("FILE");
  command
      ->add_option(
          "--tolerance", options->tolerance,
          "No point of either mesh is farther than this from the other: input units,\nor % of the longest side")
      ->option_text("TOL");
  command
      ->add_option("--triangles", options->triangles,
                   "Instead: at most so many triangles, by the smallest distance that does")
      ->option_text("N");
  add_lod(*command, options->lod);
  command->add_flag("--ascii", options->ascii, "PLY and STL as text");
  command->callback([options, &global, &runner] { runner = [options, &global] { return run(*options, global); }; });
}

}  // namespace soapfilm::cli
