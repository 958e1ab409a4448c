#include "tools/scanner/known_surface.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "soapfilm/error.h"
#include "tools/mesh/distance.h"
#include "tools/mesh/json.h"
#include "tools/scanner/mesh_surface.h"
#include "tools/scanner/scene.h"

namespace soapfilm {

using nlohmann::ordered_json;

SurfaceName surface_name(const std::string& name) {
  const auto among = [&](const std::vector<std::string>& known) {
    return std::find(known.begin(), known.end(), name) != known.end();
  };
  return among(shape_names()) ? SurfaceName::shape : among(scene_names()) ? SurfaceName::scene : SurfaceName::other;
}

std::vector<std::string> surface_names() {
  std::vector<std::string> names = shape_names();
  for (std::string& scene : scene_names()) names.push_back(std::move(scene));
  return names;
}

KnownSurface known_shape(const std::shared_ptr<const Shape>& shape, Vec3d center) {
  const ShapeFacts& facts = shape->facts();
  ordered_json json = {{"shape", facts.name}, {"parameters", ordered_json::object()}};
  for (const auto& [name, value] : facts.parameters) json["parameters"][name] = value;
  json["center"] = json_of(center);
  json["components"] = facts.components;
  json["genus"] = facts.genus;
  json["narrowest"] = facts.narrowest;
  json["volume"] = or_null(facts.volume);
  json["area"] = or_null(facts.area);
  return {shape, std::move(json)};
}

KnownSurface known_scene(const std::string& name, const Context& context) {
  Scene scene = make_scene(name);
  const auto surface = std::make_shared<const MeshSurface>(std::move(scene.mesh), context, Faces::as_given);
  return {surface, {{"scene", scene.name}, {"volume", nullptr}, {"area", surface->mesh().area()}}, scene.scanner};
}

KnownSurface known_mesh(Mesh mesh, const std::string& file, const Context& context) {
  require_surface(mesh, file);
  const auto surface = std::make_shared<const MeshSurface>(std::move(mesh), context);
  if (surface->reversed())
    context.progress().warn(fmt::format("{}: inside-out (negative volume), its faces are turned", file));
  return {surface,
          {{"file", file},
           {"turned", surface->reversed()},
           {"volume", or_null(surface->volume())},
           {"area", surface->mesh().area()}}};
}

void require_surface(const Mesh& mesh, const std::string& file) {
  const double area = mesh.area();
  if (!(area > 0) || !std::isfinite(area))
    throw InputError(fmt::format("{}: a mesh of area {:g}, must be > 0 and finite", file, area));
  const double longest = mesh.box().longest(), most = ClosestPointQuery::longest_side;
  if (longest > most)
    throw InputError(fmt::format("{}: the longest side of its box = {:g}, must be <= {:g}", file, longest, most));
}

}  // namespace soapfilm
