// A known surface named on the command line: a built-in shape with its options, a built-in scene, or a mesh file.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "soapfilm/context.h"
#include "tools/scanner/known_surface.h"

namespace soapfilm::cli {

/// The values of the options, before they are checked.
struct ObjectOptions {
  std::string name;  ///< shape, scene or file
  std::string center;
  ShapeParams shape;
  std::vector<const CLI::Option*> shape_only;      ///< options that do not apply to a mesh
  std::vector<const CLI::Option*> of_some_shapes;  ///< the parameters of a few shapes only
};

/// "A built-in shape (sphere, ...), a scene (room, ...) or a mesh (...)", for the option that names the object.
std::string object_description();

/// --size, --center, --thickness, --gap.
void add_shape_options(CLI::App& app, ObjectOptions& options);

/// A mesh that has an area to measure; throws InputError naming the file.
Mesh read_surface(const std::string& path, const Context& context);

/// `option` names the object in error messages. Warns of a closed mesh that is inside-out; its faces are flipped.
KnownSurface make_object(const char* option, const ObjectOptions& options, const Context& context);

}  // namespace soapfilm::cli
