// 3D Tiles 1.1 (OGC 22-025r4): a tree of tiles as tileset.json and one GLB for each tile.
#pragma once

#include <array>
#include <functional>
#include <string>

#include "soapfilm/context.h"
#include "tools/tiles/tile_tree.h"

namespace soapfilm {

/// Where a tileset stands: a rotation and a place, column by column. z is up.
using TilesetTransform = std::array<double, 16>;

TilesetTransform translation_to(Vec3d place);

/// Writes the tileset into an existing folder: the meshes into tiles/, tileset.json last. written(path) is called with
/// each file and folder that was made, in order. Tiles lie relative to `origin`, which `transform` puts in its place.
/// Geometric errors are those that the tiles have.
/// Throws OutputError, Cancelled.
void write_tileset(const TileTree& tree, Vec3d origin, const TilesetTransform& transform, const std::string& folder,
                   const std::function<void(const std::string&)>& written, const Context& context);

}  // namespace soapfilm
