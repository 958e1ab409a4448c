#include "tools/tiles/tileset.h"

#include <fmt/format.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <system_error>
#include <vector>

#include "soapfilm/core/vec.h"
#include "soapfilm/error.h"
#include "soapfilm/io.h"
#include "soapfilm/io/files.h"

namespace soapfilm {

namespace {

using nlohmann::ordered_json;

std::string name_of(const Tile& tile) {
  return fmt::format("tiles/{}_{}_{}_{}.glb", tile.depth, tile.cell.x, tile.cell.y, tile.cell.z);
}

ordered_json volume_json(const Box3d& box) {
  const Vec3d center = box.center(), half = (box.hi - box.lo) / 2.0;
  return {{"box", {center.x, center.y, center.z, half.x, 0, 0, 0, half.y, 0, 0, 0, half.z}}};
}

class TilesetJson {
 public:
  TilesetJson(const TileTree& tree, Vec3d origin) : tree_(tree), origin_(origin), boxes_(tree.tiles.size()) {
    for (size_t n = 0; n < boxes_.size(); ++n) {
      for (const Vec3d& v : tree.tiles[n].mesh.vertices) boxes_[n].extend(v - origin);
      for (const size_t child : tree.tiles[n].children)
        for (const Vec3d& corner : {boxes_[child].lo, boxes_[child].hi}) boxes_[n].extend(corner);
    }
  }

  ordered_json of(size_t n) const {
    const Tile& tile = tree_.tiles[n];
    ordered_json json{{"boundingVolume", volume_json(boxes_[n])},
                      {"geometricError", tile.error},
                      {"refine", "REPLACE"},
                      {"content", {{"uri", name_of(tile)}}}};
    for (const size_t child : tile.children) json["children"].push_back(of(child));
    return json;
  }
  /// The error of showing nothing at all.
  double size() const { return norm(boxes_.back().hi - boxes_.back().lo); }

 private:
  const TileTree& tree_;
  Vec3d origin_;
  std::vector<Box3d> boxes_;
};

}  // namespace

TilesetTransform translation_to(Vec3d place) {
  return {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, place.x, place.y, place.z, 1};
}

void write_tileset(const TileTree& tree, Vec3d origin, const TilesetTransform& transform, const std::string& folder,
                   const std::function<void(const std::string&)>& written, const Context& context) {
  const std::string meshes = (std::filesystem::path(folder) / "tiles").string();
  std::error_code error;
  std::filesystem::create_directories(meshes, error);
  if (error) throw OutputError(fmt::format("{}: cannot make the folder: {}", meshes, error.message()));
  written(meshes);
  for (size_t n = 0; n < tree.tiles.size(); ++n) {
    context.check();
    Mesh mesh = tree.tiles[n].mesh;
    for (Vec3d& v : mesh.vertices) v = v - origin;
    const std::string path = (std::filesystem::path(folder) / name_of(tree.tiles[n])).string();
    write_mesh(path, mesh, {}, context);
    written(path);
    context.progress().advance(static_cast<double>(n + 1) / static_cast<double>(tree.tiles.size()), path);
  }
  const TilesetJson tiles(tree, origin);
  ordered_json root = tiles.of(tree.tiles.size() - 1);
  root["transform"] = transform;
  const ordered_json json{
      {"asset", {{"version", "1.1"}, {"generator", "soapfilm"}}}, {"geometricError", tiles.size()}, {"root", root}};
  const std::string path = (std::filesystem::path(folder) / "tileset.json").string();
  write_text_file(path, json.dump(1) + "\n");
  written(path);
}

}  // namespace soapfilm
