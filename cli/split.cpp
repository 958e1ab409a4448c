#include "cli/split.h"

#include <fmt/format.h>

#include <cmath>

#include "cli/parse.h"
#include "soapfilm/error.h"

namespace soapfilm::cli {

CLI::Option* add_split(CLI::App& app, std::string& text) {
  return app
      .add_option("--split", text,
                  fmt::format("Write the mesh in parts of at most N triangles, cut in blocks of space, as\n"
                              "NAME.part_001.ply, ... and NAME.parts.json, which lists them; auto: {} million",
                              PartsParams{}.triangles / 1'000'000))
      ->check(also({"auto"}))
      ->option_text("N|auto");
}

std::optional<size_t> part_triangles(const std::string& text) {
  if (text.empty()) return std::nullopt;
  const std::optional<double> count = number_or_auto("split", text, ">= 1, of triangles");
  if (!count) return PartsParams{}.triangles;
  constexpr double most = 4294967295;
  if (!(*count >= 1 && *count <= most && *count == std::floor(*count)))
    throw ParameterError(fmt::format("split = {}, must be 'auto' or a whole number of triangles, >= 1", text));
  return static_cast<size_t>(*count);
}

nlohmann::ordered_json parts_json(const WrittenParts& written) {
  return {{"index", written.index}, {"files", written.parts.size()}};
}

}  // namespace soapfilm::cli
