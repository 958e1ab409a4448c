// soapfilm render: pictures of meshes and point clouds.
#include <fmt/format.h>

#include <cmath>
#include <memory>
#include <optional>
#include <sstream>
#include <string>
#include <variant>
#include <vector>

#include "cli/command.h"
#include "cli/parse.h"
#include "cli/print.h"
#include "cli/read_cloud.h"
#include "cli/suggest.h"
#include "cli/terminal.h"
#include "soapfilm/core/printable.h"
#include "soapfilm/error.h"
#include "soapfilm/io.h"
#include "soapfilm/io/files.h"
#include "soapfilm/io/sets/input_files.h"
#include "tools/render/render.h"

namespace soapfilm::cli {

namespace {

/// The values of the options, before they are checked.
struct Request {
  std::vector<std::string> inputs;
  std::string output;
  std::vector<std::string> captions;
  std::string view = "front";
  std::string up = "y";
  std::string size;
  std::string zoom;
  std::string range;
  std::string background = "white";
  std::string shading = "flat";
  std::string framing = "shared";
  bool as_points = false;
  RenderParams params;
};

std::vector<std::string> view_names() { return {"front", "back", "left", "right", "top", "bottom", "iso"}; }

/// `count` numbers separated by `separator`, or nothing.
std::optional<std::vector<double>> numbers(const std::string& text, char separator, size_t count) {
  std::vector<double> values;
  std::istringstream in(text);
  for (std::string part; std::getline(in, part, separator);) {
    size_t used = 0;
    try {
      values.push_back(std::stod(part, &used));
    } catch (const std::exception&) {
      return std::nullopt;
    }
    if (used != part.size() || !std::isfinite(values.back())) return std::nullopt;
  }
  if (values.size() != count || text.back() == separator) return std::nullopt;
  return values;
}

std::vector<double> required_numbers(const char* option, const std::string& text, char separator, size_t count,
                                     const char* form) {
  const auto values = numbers(text, separator, count);
  if (!values) throw ParameterError(fmt::format("{} = {}, must be {}", option, text, form));
  return *values;
}

Vec3d parse_up(const std::string& text) {
  const bool negative = text.size() == 2 && text[0] == '-';
  const std::string axis = negative ? text.substr(1) : text;
  const double sign = negative ? -1 : 1;
  if (axis == "x") return {sign, 0, 0};
  if (axis == "y") return {0, sign, 0};
  if (axis == "z") return {0, 0, sign};
  const auto v = required_numbers("--up", text, ',', 3, "x, y, z, -x, -y, -z or three numbers X,Y,Z");
  return {v[0], v[1], v[2]};
}

Vec3d parse_view(const std::string& text, Vec3d up) {
  if (const auto v = numbers(text, ',', 3)) return {(*v)[0], (*v)[1], (*v)[2]};
  try {
    return view_direction(text, up);
  } catch (const ParameterError& error) {
    throw ParameterError(error.what() + did_you_mean(text, view_names()));
  }
}

int whole(double value) { return std::abs(value) < 1e9 && value == std::floor(value) ? static_cast<int>(value) : -1; }

std::optional<Rgb8> parse_background(const std::string& text) {
  if (text == "transparent") return std::nullopt;
  if (text == "white") return Rgb8{255, 255, 255};
  if (text == "black") return Rgb8{0, 0, 0};
  if (text.size() == 7 && text[0] == '#' && text.find_first_not_of("0123456789abcdefABCDEF", 1) == std::string::npos) {
    const unsigned long hex = std::stoul(text.substr(1), nullptr, 16);
    return Rgb8{static_cast<uint8_t>(hex >> 16), static_cast<uint8_t>(hex >> 8), static_cast<uint8_t>(hex)};
  }
  throw ParameterError(fmt::format("--background = {}, must be white, black, transparent or #RRGGBB{}", text,
                                   did_you_mean(text, {"white", "black", "transparent"})));
}

RenderParams params_of(const Request& request) {
  RenderParams params = request.params;
  params.up = parse_up(request.up);
  params.from = parse_view(request.view, params.up);
  params.background = parse_background(request.background);
  params.shading = request.shading == "smooth" ? Shading::smooth : Shading::flat;
  params.framing = request.framing == "fitted"     ? Framing::fitted
                   : request.framing == "centered" ? Framing::centered
                                                   : Framing::shared;
  if (!request.size.empty()) {
    const auto v = required_numbers("--size", request.size, 'x', 2, "two whole numbers WxH");
    params.width = whole(v[0]);
    params.height = whole(v[1]);
  }
  if (!request.zoom.empty()) {
    const auto v = required_numbers("--zoom", request.zoom, ',', 4, "four numbers X0,Y0,X1,Y1");
    params.zoom = {v[0], v[1], v[2], v[3]};
  }
  if (!request.range.empty()) {
    const auto v = required_numbers("--range", request.range, ',', 2, "two numbers LOW,HIGH");
    if (params.color_by.empty()) throw ParameterError("--range: only --color-by has it");
    params.range = {v[0], v[1]};
  }
  if (request.captions.size() > request.inputs.size()) {
    throw ParameterError(fmt::format("--caption is given {} times, must be at most once for each of the {} files",
                                     request.captions.size(), request.inputs.size()));
  }
  return params;
}

bool is_png(const std::string& path) {
  const std::string end = path.size() < 4 ? "" : path.substr(path.size() - 4);
  return end == ".png" || end == ".PNG";
}

int run(Request& request, const GlobalOptions& options) {
  request.inputs = io::without_patterns(request.inputs);
  const RenderParams params = params_of(request);
  if (!is_png(request.output)) throw OutputError(fmt::format("{}: unknown extension, must be .png", request.output));
  check_output(request.output);

  TerminalProgress progress(options);
  const Context context(options.threads);
  using Shape = std::variant<Mesh, PointCloud>;
  std::vector<Shape> shapes;
  for (const std::string& path : request.inputs) {
    const bool is_mesh = !request.as_points && file_kind(path) == FileKind::mesh;
    ReadReport read;
    shapes.push_back(is_mesh ? Shape(read_mesh(path, &read)) : Shape(read_points(path, &read, context)));
    warn_of(read, progress);
  }
  std::vector<RenderItem> items(shapes.size());
  for (size_t i = 0; i < shapes.size(); ++i) {
    std::visit([&](const auto& shape) { items[i].shape = &shape; }, shapes[i]);
    if (i < request.captions.size()) items[i].caption = request.captions[i];
  }
  const Image image = render(items, params, context);
  write_png(request.output, image);
  if (!options.quiet)
    print(stdout, fmt::format("{}: {} x {} pixels\n", printable(request.output), image.width, image.height));
  return 0;
}

}  // namespace

void add_render(CLI::App& app, const GlobalOptions& options, Runner& runner) {
  auto request = std::make_shared<Request>();
  RenderParams& params = request->params;
  CLI::App* command = app.add_subcommand("render", "Draw meshes and point clouds into a PNG, side by side");

  command
      ->add_option("FILE", request->inputs,
                   fmt::format("Meshes ({}) and clouds ({}), a folder is the scans in it; a panel each",
                               mesh_extensions(), point_extensions()))
      ->required()
      ->option_text("...");
  command->add_option("-o,--output", request->output, "The picture, .png")->required()->option_text("FILE");
  command->add_option("--caption", request->captions, "Text below a panel; given again for the next file")
      ->allow_extra_args(false)
      ->option_text("TEXT");
  command->add_option("--columns", params.columns, "Panels in a row (default: chosen from their number)")
      ->option_text("N");
  command->add_option("--size", request->size, "Pixels of a panel")
      ->option_text(fmt::format("WxH [{}x{}]", params.width, params.height));

  const auto camera = [&](auto* option) { return option->group("Camera"); };
  camera(command->add_option("--view", request->view,
                             "Seen from front, back, left, right, top, bottom, iso or the direction X,Y,Z"))
      ->check(also(view_names()))
      ->option_text(fmt::format("VIEW [{}]", request->view));
  camera(command->add_option("--up", request->up, "Upright axis: x, y, z, -x, -y, -z or X,Y,Z"))
      ->check(also({"x", "y", "z", "-x", "-y", "-z"}))
      ->option_text(fmt::format("AXIS [{}]", request->up));
  camera(command->add_option("--framing", request->framing,
                             "shared: one window of space for all; centered: one scale, a center each; fitted: a scale "
                             "each"))
      ->check(one_of({"shared", "centered", "fitted"}))
      ->option_text(fmt::format("HOW [{}]", request->framing));
  camera(command->add_option("--zoom", request->zoom,
                             "Only this part, in fractions of the panel from its upper left corner"))
      ->option_text("X0,Y0,X1,Y1");

  const auto look = [&](auto* option) { return option->group("Look"); };
  look(command->add_option("--shading", request->shading, "flat: as the triangles are; smooth: interpolated normals"))
      ->check(one_of({"flat", "smooth"}))
      ->option_text(fmt::format("HOW [{}]", request->shading));
  look(command->add_option("--color-by", params.color_by, "Color by this vertex attribute, with a legend"))
      ->option_text("ATTRIBUTE");
  look(command->add_option("--range", request->range,
                           "Of --color-by: attribute values at the ends of the colors (default: their own)"))
      ->option_text("LOW,HIGH");
  look(command->add_flag("--points", request->as_points, "Draw a mesh's vertices as points"));
  look(command->add_option("--point-radius", params.point_radius, "Of points, input units (default: their spacing's)"))
      ->option_text("V");
  look(command->add_option("--background", request->background, "white, black, transparent or #RRGGBB"))
      ->check(also({"white", "black", "transparent"}))
      ->option_text(fmt::format("COLOR [{}]", request->background));
  look(command->add_option("--samples", params.samples, "Rays along each side of a pixel"))
      ->option_text(fmt::format("N [{}]", params.samples));
  look(command->add_option("--occlusion-rays", params.occlusion_rays, "For each sample; 0: no ambient occlusion"))
      ->option_text(fmt::format("N [{}]", params.occlusion_rays));

  command->callback([request, &options, &runner] { runner = [request, &options] { return run(*request, options); }; });
}

}  // namespace soapfilm::cli
