#include "cli/scan_options.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstdint>
#include <limits>

#include "cli/parse.h"
#include "soapfilm/error.h"

namespace soapfilm::cli {

namespace {

void add_view_options(CLI::App& app, ScanOptions& o) {
  ScannerParams& p = o.scanner;
  const auto views = [&](auto* option) {
    o.view_options.push_back(option);
    return option->group("Scanner positions");
  };
  const auto orbit = [&](auto* option) {
    o.orbit_options.push_back(option);
    return views(option);
  };
  orbit(app.add_option("--views", p.views, "Positions on the orbit, on each circle of a ring"))
      ->option_text(fmt::format("N [{}]", p.views));
  orbit(app.add_option("--orbit", p.orbit, "fibonacci: evenly over a sphere; ring: on circles"))
      ->transform(named<Orbit>({{"fibonacci", Orbit::fibonacci}, {"ring", Orbit::ring}}))
      ->option_text("ORBIT [fibonacci]");
  o.elevations =
      orbit(app.add_option("--elevations", p.elevations_deg, "Degrees of the ring's circles above the object"))
          ->delimiter(',')
          ->option_text(fmt::format("A,B,... [{:g}]", fmt::join(p.elevations_deg, ",")));
  orbit(app.add_option("--distance", p.distance, "From the target, in diagonals of the object's box"))
      ->option_text(fmt::format("V [{:g}]", p.distance));
  views(app.add_option("--position", o.positions, "A scanner position instead of an orbit; may be repeated"))
      ->allow_extra_args(false)
      ->option_text("X,Y,Z");
  views(app.add_option("--target", o.target, "What every view looks at (default: the box's center)"))
      ->option_text("X,Y,Z");
}

void add_ray_options(CLI::App& app, ScanOptions& o) {
  ScannerParams& p = o.scanner;
  const auto rays = [&](auto* option) {
    o.image_options.push_back(option);
    return option->group("Rays");
  };
  o.rays = rays(app.add_option("--rays", p.rays,
                               "central: all start at the scanner; parallel: one direction; spinning: a scanner that "
                               "turns once about the upright axis z"))
               ->transform(named<Rays>(
                   {{"central", Rays::central}, {"parallel", Rays::parallel}, {"spinning", Rays::spinning}}))
               ->option_text("KIND [central]");
  CLI::Option* image = rays(app.add_option("--image", o.image, "Columns and rows of each range image"))
                           ->option_text(fmt::format("CxR [{}x{}]", p.columns, p.rows));
  rays(app.add_option("--step", o.step, "Distance of neighboring rays at the target, instead of --image"))
      ->excludes(image)
      ->option_text("LENGTH");
  CLI::Option* span = rays(app.add_option("--span", o.span,
                                          "Of a spinning scanner: elevation of its lowest and highest "
                                          "ring, degrees; as many rings as the image has rows"))
                          ->option_text(fmt::format("LOW,HIGH [{:g},{:g}]", p.lowest_deg, p.highest_deg));
  o.rings = rays(app.add_option("--rings", p.rings_deg, "Instead: elevation of each ring, from the top"))
                ->delimiter(',')
                ->excludes(span)
                ->option_text("A,B,...");
  rays(app.add_option("--max-range", o.max_range, "Hits farther away are lost; 0: none"))->option_text("LENGTH [0]");
}

void add_sample_options(CLI::App& app, ScanOptions& o) {
  const auto even = [&](auto* option) { return option->group("Even samples instead of scans"); };
  o.samples_option =
      even(app.add_option("--samples", o.samples, "This many, independent and even by area, in one cloud"))
          ->option_text("N");
  o.directions_option =
      even(app.add_option("--directions", o.directions,
                          "normals: the true ones; views: for each sample only the scanner position, of those "
                          "above, that sees it best"))
          ->transform(named<Directions>({{"normals", Directions::normals}, {"views", Directions::views}}))
          ->option_text("KIND [normals]");
}

void add_error_options(CLI::App& app, ScanOptions& o) {
  ScannerParams& p = o.scanner;
  const auto errors = [&](auto* option) { return option->group("Errors of measurement"); };
  const auto of_scans = [&](auto* option) {
    o.image_options.push_back(option);
    return errors(option);
  };
  errors(app.add_option("--noise", o.noise, "Standard deviation along the ray; of --samples along the normal"))
      ->option_text("LENGTH [0]");
  errors(app.add_option("--outliers", p.outliers, "Share of the samples, 0 to 1"))
      ->option_text(fmt::format("V [{:g}]", p.outliers));
  of_scans(app.add_option("--outlier-kind", p.outlier_kind,
                          "ray: elsewhere on the ray; box: anywhere around the object, as with --samples"))
      ->transform(named<Outliers>({{"ray", Outliers::ray}, {"box", Outliers::box}}))
      ->option_text("KIND [ray]");
  of_scans(app.add_option("--drop-out", p.drop_out, "Share of the hits that are lost, 0 to 1"))
      ->option_text(fmt::format("V [{:g}]", p.drop_out));
  o.max_incidence =
      of_scans(app.add_option("--max-incidence", p.max_incidence_deg, "Hits at a larger angle to the normal are lost"))
          ->option_text(fmt::format("DEGREES [{:g}]", p.max_incidence_deg));
  of_scans(app.add_option("--ghosts", p.ghosts, "Share of the hits that come back late: behind the surface, 0 to 1"))
      ->option_text(fmt::format("V [{:g}]", p.ghosts));
  of_scans(app.add_option("--ghost-depth", o.ghost_depth, "How far behind it, along its normal, input units"))
      ->option_text(fmt::format("LOW,HIGH [{:g},{:g}]", p.ghost_lo, p.ghost_hi));
  of_scans(app.add_option("--mixed-pixels", p.mixed_pixels,
                          "Share of the pixels at a step in depth that measure between its two sides, 0 to 1"))
      ->option_text(fmt::format("V [{:g}]", p.mixed_pixels));
  errors(app.add_option("--hole", o.missing.hole, "Share of the surface, one patch of it, without samples, 0 to 0.9"))
      ->option_text(fmt::format("V [{:g}]", o.missing.hole));
  errors(app.add_option("--sparse-half", o.missing.sparse_half,
                        "Only one of this many samples beyond the middle of the longest side"))
      ->option_text(fmt::format("V [{:g}]", o.missing.sparse_half));
  of_scans(app.add_option("--misalignment", o.misalignment, "Standard deviation of each scan's shift along an axis"))
      ->option_text("LENGTH [0]");
  of_scans(app.add_option("--misalignment-angle", p.misalignment_deg, "The same of its rotation about its center"))
      ->option_text(fmt::format("DEGREES [{:g}]", p.misalignment_deg));
  errors(app.add_option("--seed", p.seed, "Of all random numbers"))
      ->check(CLI::Range(int64_t{0}, std::numeric_limits<int64_t>::max()))
      ->option_text(fmt::format("N [{}]", p.seed));
}

/// Refuses the first of `options` that was given.
void refuse(const std::vector<const CLI::Option*>& options, const char* why) {
  for (const CLI::Option* option : options)
    if (option->count() > 0) throw ParameterError(fmt::format("{}: {}", option->get_name(), why));
}

}  // namespace

void add_scan_options(CLI::App& app, ScanOptions& o) {
  app.add_option("object", o.object.name, object_description())
      ->required()
      ->check(also(surface_names()))
      ->option_text("SHAPE|MESH");
  app.add_option("-o,--output", o.folder, "Folder for the scans and the truth; made when absent")
      ->required()
      ->option_text("DIR");
  o.image_options.push_back(
      app.add_flag("--normals", o.scanner.normals, "Write the true normals with the samples of scans"));
  add_shape_options(app, o.object);
  add_view_options(app, o);
  add_ray_options(app, o);
  add_sample_options(app, o);
  add_error_options(app, o);
}

void check_together(const ScanOptions& o) {
  if (!o.even_samples()) {
    refuse({o.directions_option}, "only --samples has it, scans have their scanner");
  } else {
    refuse(o.image_options, "only scans have it, not --samples");
    if (o.directions == Directions::normals)
      refuse(o.view_options, "only scans, and --samples with --directions views, have it");
    if (o.samples < 1 || o.samples > 1'000'000'000)
      throw ParameterError(fmt::format("samples = {}, must be in [1, 1e9]", o.samples));
  }
  if (!o.positions.empty()) refuse(o.orbit_options, "only an orbit has it, not --position");
  if (o.elevations->count() > 0 && o.scanner.orbit != Orbit::ring)
    throw ParameterError("elevations: only --orbit ring has them");
}

void take_scanner_of_scene(ScanOptions& o, const ScannerParams& scene) {
  const auto given = [](const CLI::Option* option) { return option->count() > 0; };
  ScannerParams& p = o.scanner;
  if (o.positions.empty() && std::none_of(o.orbit_options.begin(), o.orbit_options.end(), given))
    p.positions = scene.positions;
  if (!given(o.rays)) p.rays = scene.rays;
  if (!given(o.max_incidence)) p.max_incidence_deg = scene.max_incidence_deg;
  if (o.image.empty() && o.step.empty()) p.columns = scene.columns, p.rows = scene.rows;
  if (o.span.empty()) p.lowest_deg = scene.lowest_deg, p.highest_deg = scene.highest_deg;
}

ScannerParams scanner_params(const ScanOptions& options, const Box3d& box) {
  ScannerParams params = options.scanner;
  const auto length = [&](const char* option, const std::string& text, double& value) {
    if (!text.empty()) value = parse_length(option, text, box.longest());
  };
  length("step", options.step, params.step);
  if (!options.step.empty() && !(params.step > 0))
    throw ParameterError(fmt::format("step = {}, must be > 0", options.step));
  length("noise", options.noise, params.noise);
  length("max-range", options.max_range, params.max_range);
  const auto pair = [](const char* option, const std::string& text, double& low, double& high) {
    if (text.empty()) return;
    const std::vector<double> values = parse_numbers(option, text, ',', 2, "two numbers such as 1,3");
    low = values[0], high = values[1];
  };
  pair("span", options.span, params.lowest_deg, params.highest_deg);
  pair("ghost-depth", options.ghost_depth, params.ghost_lo, params.ghost_hi);
  if (params.rays != Rays::spinning && (options.rings->count() > 0 || !options.span.empty()))
    throw ParameterError("rings, span: only --rays spinning has them");
  if (params.rays == Rays::spinning && !options.step.empty())
    throw ParameterError("step: a spinning scanner has --image instead, rays of a turn and rings");
  length("misalignment", options.misalignment, params.misalignment);
  for (const std::string& text : options.positions) params.positions.push_back(parse_point("position", text));
  if (!options.target.empty()) params.target = parse_point("target", options.target);
  if (!options.image.empty()) {
    const std::vector<double> size = parse_numbers("image", options.image, 'x', 2, "two whole numbers such as 300x300");
    for (const double n : size)
      if (!(n >= 1 && n <= 20000 && n == static_cast<int>(n)))
        throw ParameterError(fmt::format("image = {}, must be whole numbers in [1, 20000]", options.image));
    params.columns = static_cast<int>(size[0]);
    params.rows = static_cast<int>(size[1]);
  }
  return params;
}

SamplingParams sampling_params(const ScanOptions& options, const Box3d& box) {
  const ScannerParams scanner = scanner_params(options, box);
  SamplingParams params;
  params.count = static_cast<size_t>(options.samples);
  params.noise = scanner.noise;
  params.outliers = scanner.outliers;
  if (options.directions == Directions::views) params.sensors = scanner_positions(box, scanner);
  params.seed = scanner.seed;
  return params;
}

}  // namespace soapfilm::cli
