#include "cli/object.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>

#include "cli/parse.h"
#include "cli/read_cloud.h"
#include "cli/suggest.h"
#include "soapfilm/error.h"
#include "soapfilm/io.h"
#include "tools/scanner/scene.h"

namespace soapfilm::cli {

namespace {

KnownSurface shape_object(const ObjectOptions& options) {
  ShapeParams params = options.shape;
  if (!options.center.empty()) params.center = parse_point("center", options.center);
  const std::shared_ptr<const Shape> shape = make_shape(options.name, params);
  const ShapeFacts& facts = shape->facts();
  for (const CLI::Option* option : options.of_some_shapes) {
    const auto is_it = [&](const auto& parameter) { return "--" + std::string(parameter.first) == option->get_name(); };
    if (option->count() > 0 && std::none_of(facts.parameters.begin(), facts.parameters.end(), is_it))
      throw ParameterError(fmt::format("{}: shape {} has none", option->get_name(), facts.name));
  }
  return known_shape(shape, params.center);
}

void refuse_shape_options(const ObjectOptions& options, const char* kind) {
  for (const CLI::Option* option : options.shape_only)
    if (option->count() > 0)
      throw ParameterError(
          fmt::format("{}: only built-in shapes have it, {} is a {}", option->get_name(), options.name, kind));
}

}  // namespace

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
  warn_of(read, context.progress());
  require_surface(mesh, path);
  return mesh;
}

KnownSurface make_object(const char* option, const ObjectOptions& options, const Context& context) {
  const SurfaceName kind = surface_name(options.name);
  if (kind == SurfaceName::shape) return shape_object(options);
  if (kind == SurfaceName::scene) {
    refuse_shape_options(options, "scene");
    return known_scene(options.name, context);
  }
  const std::filesystem::path path(options.name);
  if (!path.has_extension() && !std::filesystem::exists(path))
    throw ParameterError(fmt::format("{} = {}, must be one of {}, or a mesh file{}", option, options.name,
                                     fmt::join(surface_names(), ", "), did_you_mean(options.name, surface_names())));
  refuse_shape_options(options, "mesh");
  return known_mesh(read_surface(options.name, context), options.name, context);
}

}  // namespace soapfilm::cli
