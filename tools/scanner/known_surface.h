// A surface that is known, by its name or from a mesh, with its facts for reports.
#pragma once

#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "soapfilm/context.h"
#include "tools/scanner/shape.h"
#include "tools/scanner/virtual_scan.h"

namespace soapfilm {

struct KnownSurface {
  std::shared_ptr<const Surface> surface;
  nlohmann::ordered_json facts;
  std::optional<ScannerParams> scanner{};  ///< that of a scene
};

enum class SurfaceName { shape, scene, other };
SurfaceName surface_name(const std::string& name);

/// The names of all shapes and scenes.
std::vector<std::string> surface_names();

KnownSurface known_shape(const std::shared_ptr<const Shape>& shape, Vec3d center);
KnownSurface known_scene(const std::string& name, const Context& context);
/// `file` names the mesh in facts and messages. Warns of a closed one that is inside-out; its faces are turned. Throws
/// InputError for a mesh without area, or one too large to measure.
KnownSurface known_mesh(Mesh mesh, const std::string& file, const Context& context);

/// Throws InputError, naming `file`, for a mesh that has no area to measure.
void require_surface(const Mesh& mesh, const std::string& file);

}  // namespace soapfilm
