#include "cli/detail_levels.h"

#include <fmt/format.h>

#include <utility>

#include "soapfilm/error.h"
#include "soapfilm/simplify/coarser.h"

namespace soapfilm::cli {

namespace {

constexpr int most_levels = 16;  // the last one's tolerance is 65,536 times the first one's

}  // namespace

CLI::Option* add_lod(CLI::App& app, LodCount& count) {
  return app
      .add_option("--lod", count,
                  "Also N coarser meshes, each at twice the tolerance of the one before:\nFILE.1.ply, ...; all in one "
                  "file if it is a .glb")
      ->option_text("N");
}

std::vector<std::string> lod_files(const std::string& output, LodCount count) {
  if (count && (*count < 1 || *count > most_levels))
    throw ParameterError(fmt::format("lod = {}, must be in [1, {}]", *count, most_levels));
  return level_files(output, 1 + static_cast<size_t>(count.value_or(0)));
}

std::vector<DetailLevel> detail_levels(Simplified first, LodCount count, const Context& context) {
  auto wanted = static_cast<size_t>(count.value_or(0));
  if (wanted > 0 && !(first.report.tolerance > 0)) {
    context.progress().warn(
        fmt::format("no coarser levels: the mesh had only {} triangles, so there is no tolerance to double",
                    first.report.triangles));
    wanted = 0;
  }
  std::vector<Simplified> coarser = coarser_levels(first, wanted, context);
  if (coarser.size() < wanted)
    context.progress().warn(fmt::format("only {} of {} coarser levels: the next one would have no fewer triangles",
                                        coarser.size(), wanted));
  std::vector<DetailLevel> levels;
  levels.push_back({std::move(first.mesh), first.report.proved});
  for (Simplified& level : coarser) levels.push_back({std::move(level.mesh), level.report.proved});
  return levels;
}

void announce_levels(const std::string& output, const std::vector<DetailLevel>& levels, Progress& progress) {
  const std::vector<std::string> files = level_files(output, levels.size());
  for (size_t level = 1; level < levels.size(); ++level)
    progress.info(fmt::format("{}: {} triangles, proved within {:.3g} of the full mesh",
                              files.size() > 1 ? files[level] : fmt::format("{}, lod{}", output, level),
                              levels[level].mesh.triangles.size(), levels[level].proved));
}

nlohmann::ordered_json levels_json(const std::string& output, const std::vector<DetailLevel>& levels) {
  const std::vector<std::string> files = level_files(output, levels.size());
  auto rows = nlohmann::ordered_json::array();
  for (size_t level = 0; level < levels.size(); ++level) {
    nlohmann::ordered_json row = {{"file", files.size() > 1 ? files[level] : output}};
    if (files.size() == 1 && levels.size() > 1) row["node"] = fmt::format("lod{}", level);
    row["triangles"] = levels[level].mesh.triangles.size();
    row["proved_distance"] = levels[level].proved;
    rows.push_back(std::move(row));
  }
  return rows;
}

}  // namespace soapfilm::cli
