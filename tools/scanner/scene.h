// Places to scan that are no closed objects: the scanner stands in them, drives or flies through them.
#pragma once

#include <string>
#include <vector>

#include "soapfilm/mesh.h"
#include "tools/scanner/virtual_scan.h"

namespace soapfilm {

/// An open mesh in meters, z up. Its faces point into the air, from which they are scanned: a room's inwards. As a
/// Surface it is a MeshSurface with Faces::as_given.
struct Scene {
  std::string name;
  Mesh mesh;
  ScannerParams scanner;  ///< a suitable scanner: its positions, its rays, hits up to 89 degrees
};

/// 6 x 4 x 2.6: a table, a cabinet, a lamp at the ceiling; door and window are open and give no return. If these two
/// are closed the room's surface has genus 3, because of the legs of the table.
Scene make_room();
/// A floor of 24 x 24 around the origin and a house front of 12 x 4 at y = 12: beyond some meters rays meet the floor
/// at grazing angles.
Scene make_yard();
/// A road with kerbs, house fronts, parked cars and lamp posts along x, from -60 to 60.
Scene make_street();
/// 200 x 200 of hills with four houses and forty trees, from above.
Scene make_terrain();
/// A vaulted tunnel along x, 40 long, 5 wide and 4.5 high, with three niches; open at both ends.
Scene make_tunnel();
/// A house front of 30 x 12 with windows 0.3 deep, two balconies and a door, and nothing behind it.
Scene make_facade();

/// The names that make_scene knows, in the order above.
std::vector<std::string> scene_names();
/// By name. Throws ParameterError for an unknown one.
Scene make_scene(const std::string& name);

}  // namespace soapfilm
