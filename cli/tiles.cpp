// soapfilm tiles: a mesh as 3D Tiles, for the web.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "cli/command.h"
#include "cli/coordinate_system.h"
#include "cli/georeference.h"
#include "cli/parse.h"
#include "cli/read_cloud.h"
#include "cli/terminal.h"
#include "soapfilm/core/stages.h"
#include "soapfilm/core/vec.h"
#include "soapfilm/error.h"
#include "soapfilm/io.h"
#include "soapfilm/io/files.h"
#include "soapfilm/simplify.h"
#include "tools/tiles/tileset.h"

namespace soapfilm::cli {

namespace {

struct TilesRequest {
  std::string input, output, system = "auto", tolerance;
  TileParams params;
};

/// Files and folders of a run that is not done: they go when it fails.
class Unfinished {
 public:
  void add(const std::string& path) { made_.push_back(path); }
  void keep() { made_.clear(); }
  ~Unfinished() {
    std::error_code ignored;
    for (auto path = made_.rbegin(); path != made_.rend(); ++path) std::filesystem::remove(*path, ignored);
  }

 private:
  std::vector<std::string> made_;
};

/// Makes it, or takes an empty one.
void make_folder(const std::string& folder, Unfinished& unfinished) {
  namespace fs = std::filesystem;
  std::error_code error;
  if (fs::exists(folder, error)) {
    if (!fs::is_directory(folder, error)) throw OutputError(fmt::format("{}: is no folder", folder));
    if (!fs::is_empty(folder, error) || error) throw OutputError(fmt::format("{}: must be empty", folder));
    return;
  }
  fs::create_directories(folder, error);
  if (error) throw OutputError(fmt::format("{}: cannot make the folder: {}", folder, error.message()));
  unfinished.add(folder);
}

/// As asked for, or that of the file beside the mesh (`reconstruct` writes it); empty: none.
std::string system_of(const TilesRequest& request) {
  if (request.system == "none") return {};
  if (request.system != "auto") return request.system;
  std::ifstream file(std::filesystem::path(request.input).replace_extension(".prj"));
  std::string text{std::istreambuf_iterator<char>(file), {}};
  while (!text.empty() && (text.back() == '\n' || text.back() == '\r')) text.pop_back();
  return text;
}

int run(const TilesRequest& request, const GlobalOptions& global) {
  TerminalProgress progress(global);
  const Context context(global.threads, progress);
  Stages stages(context);
  Unfinished unfinished;
  make_folder(request.output, unfinished);
  ReadReport read;
  Mesh mesh = stages.run("read", [&] { return read_mesh(request.input, &read); });
  warn_of(read, progress);
  if (mesh.triangles.empty()) throw InputError(request.input + ": it has no triangles");

  const std::string system = system_of(request);
  Vec3d origin = mesh.box().center();
  TilesetTransform transform = translation_to(origin);
  if (!system.empty() && request.system == "auto" && !knows_earth()) {
    progress.warn("the tileset stands in no place of the globe: this program was built without PROJ");
  } else if (!system.empty()) {
    transform = move_to_earth(system, origin, mesh.vertices).to_earth;
    origin = {0, 0, 0};
    progress.info(fmt::format("placed on the globe: {}", coordinate_system_of(system).name));
  }

  double simplified = 0;
  if (!request.tolerance.empty()) {
    const double tolerance = parse_length("tolerance", request.tolerance, mesh.box().longest());
    Simplified simple = stages.run("simplify", [&] { return simplify(mesh, tolerance, context); });
    simplified = simple.report.proved;
    mesh = std::move(simple.mesh);
  }
  TileTree tree = stages.run("tiles", [&] { return make_tiles(mesh, request.params, context); });
  for (Tile& tile : tree.tiles) tile.error += simplified;
  stages.run("write", [&] {
    write_tileset(
        tree, origin, transform, request.output, [&](const std::string& path) { unfinished.add(path); }, context);
  });
  unfinished.keep();
  progress.info(fmt::format("{}: {} tiles, the coarsest {} of {} triangles, proved within {:.3g} of the mesh",
                            request.output, tree.tiles.size(), tree.root().mesh.triangles.size(), mesh.triangles.size(),
                            tree.root().error));
  return 0;
}

}  // namespace

void add_tiles(CLI::App& app, const GlobalOptions& global, Runner& runner) {
  auto request = std::make_shared<TilesRequest>();
  CLI::App* command = app.add_subcommand("tiles", "A mesh as 3D Tiles: coarse at first, fine where one looks");
  command->add_option("MESH", request->input, fmt::format("A closed or open 2-manifold ({})", mesh_extensions()))
      ->required();
  command->add_option("-o,--output", request->output, "Where tileset.json goes: a new folder, or an empty one")
      ->required()
      ->option_text("FOLDER");
  command->add_option("--triangles", request->params.triangles, "Of a tile, about")
      ->option_text(fmt::format("N [{}]", request->params.triangles));
  command
      ->add_option("--tolerance", request->tolerance,
                   "Simplify first: no point farther than this from the mesh, input units (meters\non the globe) or % "
                   "of the longest side (default: the finest tiles are the mesh)")
      ->option_text("TOL");
  command
      ->add_option("--coordinate-system", request->system,
                   "Of the mesh, as EPSG:NUMBER or WKT: the tileset is placed on the globe; auto: that\nof the file "
                   "MESH's name .prj, if it is there; none")
      ->option_text("SYSTEM [auto]");
  command->callback([request, &global, &runner] { runner = [request, &global] { return run(*request, global); }; });
}

}  // namespace soapfilm::cli
