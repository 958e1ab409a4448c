#include "cli/object.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "cli/json.h"
#include "cli/parse.h"
#include "cli/suggest.h"
#include "soapfilm/error.h"
#include "soapfilm/io.h"
#include "tools/mesh/distance.h"
#include "tools/scanner/mesh_surface.h"
#include "tools/scanner/scene.h"

namespace soapfilm::cli {

namespace {

using nlohmann::ordered_json;

Object shape_object(const ObjectOptions& options) {
  ShapeParams params = options.shape;
  if (!options.center.empty()) params.center = parse_point("center", options.center);
  const std::shared_ptr<const Shape> shape = make_shape(options.name, params);
  const ShapeFacts& facts = shape->facts();
  for (const CLI::Option* option : options.of_some_shapes) {
    const auto is_it = [&](const auto& parameter) { return "--" + std::string(parameter.first) == option->get_name(); };
    if (option->count() > 0 && std::none_of(facts.parameters.begin(), facts.parameters.end(), is_it))
      throw ParameterError(fmt::format("{}: shape {} has none", option->get_name(), facts.name));
  }
  ordered_json json = {{"shape", facts.name}, {"parameters", ordered_json::object()}};
  for (const auto& [name, value] : facts.parameters) json["parameters"][name] = value;
  json["center"] = json_of(params.center);
  json["components"] = facts.components;
  json["genus"] = facts.genus;
  json["narrowest"] = facts.narrowest;
  json["volume"] = or_null(facts.volume);
  json["area"] = or_null(facts.area);
  return {shape, std::move(json)};
}

void refuse_shape_options(const ObjectOptions& options, const char* kind) {
  for (const CLI::Option* option : options.shape_only)
    if (option->count() > 0)
      throw ParameterError(
          fmt::format("{}: only built-in shapes have it, {} is a {}", option->get_name(), options.name, kind));
}

Object scene_object(const ObjectOptions& options, const Context& context) {
  refuse_shape_options(options, "scene");
  Scene scene = make_scene(options.name);
  const auto surface = std::make_shared<const MeshSurface>(std::move(scene.mesh), context, Faces::as_given);
  return {surface, {{"scene", scene.name}, {"volume", nullptr}, {"area", surface->mesh().area()}}, scene.scanner};
}

Object mesh_object(const ObjectOptions& options, const Context& context) {
  refuse_shape_options(options, "mesh");
  const auto mesh = std::make_shared<const MeshSurface>(read_surface(options.name, context), context);
  if (mesh->reversed())
    context.progress().warn(fmt::format("{}: inside-out (negative volume), its faces are turned", options.name));
  return {mesh,
          {{"file", options.name},
           {"turned", mesh->reversed()},
           {"volume", or_null(mesh->volume())},
           {"area", mesh->mesh().area()}}};
}

}  // namespace

std::vector<std::string> object_names() {
  std::vector<std::string> names = shape_names();
  for (std::string& scene : scene_names()) names.push_back(std::move(scene));
  return names;
}

std::string object_description() {
  return fmt::format("A built-in shape ({}),\na scene ({})\nor a mesh (.ply, .obj, .off, .stl)",
                     fmt::join(shape_names(), ", "), fmt::join(scene_names(), ", "));
}

void add_shape_options(CLI::App& app, ObjectOptions& o) {
  const auto shape = [&](auto* option) {
    o.shape_only.push_back(option);
    return option->group("Shape");
  };
  shape(app.add_option("--size", o.shape.size, "Longest side of a built-in shape"))
      ->option_text(fmt::format("V [{:g}]", o.shape.size));
  shape(app.add_option("--center", o.center, "Center of its box"))->option_text("X,Y,Z [0,0,0]");
  const auto some = [&](auto* option) {
    o.of_some_shapes.push_back(option);
    return shape(option);
  };
  some(app.add_option("--thickness", o.shape.thickness, "Of the plate and the sheets, as a part of the size"))
      ->option_text(fmt::format("V [{:g}]", o.shape.thickness));
  some(app.add_option("--gap", o.shape.gap, "Between the sheets or the arch's feet, as a part of the size"))
      ->option_text(fmt::format("V [{:g}]", o.shape.gap));
}

Mesh read_surface(const std::string& path, const Context& context) {
  ReadReport read;
  Mesh mesh = read_mesh(path, &read);
  for (const std::string& warning : read.warnings) context.progress().warn(warning);
  const double area = mesh.area();
  if (!(area > 0) || !std::isfinite(area))
    throw InputError(fmt::format("{}: a mesh of area {:g}, must be > 0 and finite", path, area));
  const double longest = mesh.box().longest(), most = ClosestPointQuery::longest_side;
  if (longest > most)
    throw InputError(fmt::format("{}: the longest side of its box = {:g}, must be <= {:g}", path, longest, most));
  return mesh;
}

Object make_object(const char* option, const ObjectOptions& options, const Context& context) {
  const auto among = [&](const std::vector<std::string>& known) {
    return std::find(known.begin(), known.end(), options.name) != known.end();
  };
  if (among(shape_names())) return shape_object(options);
  if (among(scene_names())) return scene_object(options, context);
  const std::vector<std::string> names = object_names();
  const std::filesystem::path path(options.name);
  if (!path.has_extension() && !std::filesystem::exists(path))
    throw ParameterError(fmt::format("{} = {}, must be one of {}, or a mesh file{}", option, options.name,
                                     fmt::join(names, ", "), did_you_mean(options.name, names)));
  return mesh_object(options, context);
}

}  // namespace soapfilm::cli
