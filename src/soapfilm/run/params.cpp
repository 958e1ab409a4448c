#include "soapfilm/params.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <concepts>
#include <nlohmann/json.hpp>
#include <set>
#include <type_traits>
#include <utility>

#include "soapfilm/border/border.h"
#include "soapfilm/components/components.h"
#include "soapfilm/core/json_text.h"
#include "soapfilm/core/method.h"
#include "soapfilm/core/names.h"
#include "soapfilm/core/printable.h"
#include "soapfilm/error.h"
#include "soapfilm/finish/trim.h"
#include "soapfilm/fuse/range_surface.h"
#include "soapfilm/lambda/cross_validation.h"
#include "soapfilm/orient/orient.h"
#include "soapfilm/refine/refine.h"
#include "soapfilm/relax/relax.h"
#include "soapfilm/run/defaults.h"
#include "soapfilm/solve/sor.h"

namespace soapfilm {

namespace {

using nlohmann::ordered_json;

/// Lists every parameter: visit(group, name, value).
template <class Params, class Visit>
void for_each_param(Params& p, Visit&& visit) {
  visit("solve", "method", p.method);
  visit("orient", "directions", p.orient.source);
  visit("orient", "sensor", p.orient.sensor);
  visit("orient", "up", p.orient.up);
  visit("orient", "neighbors", p.orient.neighbors);
  visit("orient", "radius", p.orient.radius);
  visit("place", "voxel", p.place.voxel);
  visit("place", "resolution", p.place.resolution);
  visit("place", "samples_per_voxel2", p.place.samples_per_voxel2);
  visit("place", "padding", p.place.padding);
  visit("place", "levels", p.place.levels);
  visit("place", "anchor", p.place.anchor);
  visit("place", "adapt", p.place.adapt);
  visit("energy", "lambda", p.energy.lambda);
  visit("energy", "lambda_per_density", p.energy.lambda_per_density);
  visit("energy", "cross_validate", p.energy.cross_validate);
  visit("energy", "by_area", p.energy.by_area);
  visit("energy", "norm", p.energy.norm);
  visit("border", "outside", p.border.outside);
  visit("border", "open_gain", p.border.open_gain);
  visit("cross_validation", "folds", p.cross_validation.folds);
  visit("cross_validation", "source", p.cross_validation.source);
  visit("cross_validation", "max_resolution", p.cross_validation.max_resolution);
  visit("cross_validation", "indifference", p.cross_validation.indifference);
  visit("cross_validation", "seed", p.cross_validation.seed);
  visit("cross_validation", "candidates", p.cross_validation.candidates);
  visit("solve", "tolerance", p.solve.tolerance);
  visit("solve", "max_iterations", p.solve.max_iterations);
  visit("solve", "settle", p.solve.settle);
  visit("solve", "check_every", p.solve.check_every);
  visit("solve", "step_balance", p.solve.step_balance);
  visit("sor", "epsilon", p.sor.epsilon);
  visit("sor", "omega", p.sor.omega);
  visit("sor", "renew_every", p.sor.renew_every);
  visit("sor", "levels", p.sor.levels);
  visit("sor", "tolerance", p.sor.tolerance);
  visit("sor", "max_iterations", p.sor.max_iterations);
  visit("sor", "order", p.sor.order);
  visit("sor", "gradient", p.sor.gradient);
  visit("sor", "skip_empty", p.sor.skip_empty);
  visit("sor", "snap", p.sor.snap);
  visit("poisson", "tolerance", p.poisson.tolerance);
  visit("poisson", "max_iterations", p.poisson.max_iterations);
  visit("graph_cut", "weights", p.graph_cut.weights);
  visit("vrip", "front", p.vrip.front);
  visit("vrip", "behind", p.vrip.behind);
  visit("vrip", "max_edge", p.vrip.surface.max_edge);
  visit("vrip", "max_incidence_deg", p.vrip.surface.max_incidence_deg);
  visit("vrip", "taper", p.vrip.surface.taper);
  visit("surface", "threshold", p.surface.threshold);
  visit("surface", "refine", p.surface.refine);
  visit("surface", "isovalue", p.surface.isovalue);
  visit("surface", "drop_components", p.surface.drop_components);
  visit("surface", "split_tolerance", p.surface.relax.split_tolerance);
  visit("surface", "distance", p.surface.distance);
  visit("surface", "support", p.surface.support);
  visit("surface", "gap", p.surface.gap);
  visit("surface", "volume_interval", p.surface.volume_interval);
  visit("surface", "attributes", p.surface.attributes);
  visit("components", "min_support", p.components.min_support);
  visit("components", "few_samples", p.components.few_samples);
  visit("components", "many_samples", p.components.many_samples);
  visit("components", "sparse_support", p.components.sparse_support);
  visit("refine", "smoothing", p.refine.smoothing);
  visit("refine", "normals", p.refine.normals);
  visit("refine", "reach", p.refine.reach);
  visit("refine", "sparse", p.refine.sparse);
  visit("refine", "holes", p.refine.holes);
  visit("trim", "on", p.trim.on);
  visit("trim", "distance", p.trim.distance);
  visit("trim", "holes", p.trim.holes);
  visit("trim", "fill_holes", p.trim.fill_holes);
  visit("simplify", "tolerance", p.simplify.tolerance);
  visit("simplify", "tolerance_vox", p.simplify.tolerance_vox);
  visit("simplify", "automatic", p.simplify.automatic);
  visit("simplify", "triangles", p.simplify.triangles);
  visit("memory", "checked", p.checked);
}

template <class T>
concept Enumeration = std::is_enum_v<T>;

template <class T>
ordered_json json_of(const T& value) {
  return value;
}
template <Enumeration T>
ordered_json json_of(const T& value) {
  return names_of<T>[static_cast<size_t>(value)];
}
ordered_json json_of(const Vec3d& v) { return {v.x, v.y, v.z}; }
template <class T>
ordered_json json_of(const std::optional<T>& value) {
  return value ? json_of(*value) : ordered_json(nullptr);
}

void require_type(bool holds, const char* type) {
  if (!holds) throw ParameterError(fmt::format("must be {}", type));
}
void read_value(const ordered_json& json, double& value) {
  require_type(json.is_number(), "a number");
  value = json.get<double>();
}
template <std::integral T>
requires(!std::same_as<T, bool>) void read_value(const ordered_json& json, T& value) {
  const bool fits = json.is_number_unsigned()  ? std::in_range<T>(json.get<uint64_t>())
                    : json.is_number_integer() ? std::in_range<T>(json.get<int64_t>())
                                               : false;
  require_type(fits, std::is_unsigned_v<T> ? "a whole number >= 0" : "a whole number");
  value = json.get<T>();
}
void read_value(const ordered_json& json, bool& value) {
  require_type(json.is_boolean(), "true or false");
  value = json.get<bool>();
}
template <Enumeration T>
void read_value(const ordered_json& json, T& value) {
  require_type(json.is_string(), "a string");
  const auto name = json.get<std::string>();
  const auto& names = names_of<T>;
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) throw ParameterError(fmt::format("must be one of {}", fmt::join(names, ", ")));
  value = static_cast<T>(found - names.begin());
}
void read_value(const ordered_json& json, std::vector<double>& values) {
  require_type(json.is_array(), "numbers");
  values.resize(json.size());
  for (size_t i = 0; i < values.size(); ++i) read_value(json[i], values[i]);
}
void read_value(const ordered_json& json, std::vector<std::string>& values) {
  require_type(json.is_array(), "strings");
  values.clear();
  for (const ordered_json& value : json) {
    require_type(value.is_string(), "strings");
    values.push_back(value.get<std::string>());
  }
}
void read_value(const ordered_json& json, Vec3d& v) {
  require_type(json.is_array() && json.size() == 3, "three numbers");
  for (int axis = 0; axis < 3; ++axis) read_value(json[static_cast<size_t>(axis)], v[axis]);
}
template <class T>
void read_value(const ordered_json& json, std::optional<T>& value) {
  if (json.is_null()) {
    value.reset();
    return;
  }
  T inner{};
  read_value(json, inner);
  value = inner;
}

/// A key of the text for a message of one line, cut where it is long.
std::string shown(std::string_view key) {
  constexpr size_t longest = 60;
  return printable(std::string(key.substr(0, longest)));
}

void refuse_unknown_keys(const ordered_json& json) {
  std::set<std::string> groups, names;
  ReconstructParams known;
  for_each_param(known, [&](const char* group, const char* name, auto&) {
    groups.insert(group);
    names.insert(std::string(group) + "." + name);
  });
  for (const auto& [group, values] : json.items()) {
    if (!groups.contains(group)) throw ParameterError(fmt::format("parameters: unknown key '{}'", shown(group)));
    if (!values.is_object()) throw ParameterError(fmt::format("parameters: '{}' must be an object", shown(group)));
    for (const auto& [name, value] : values.items())
      if (!names.contains(group + "." + name))
        throw ParameterError(fmt::format("parameters: unknown key '{}.{}'", shown(group), shown(name)));
  }
}

/// Reports and parameters of earlier versions have the limit that is the context's now. That of a run says nothing of
/// this one's machine; but who gives it to a run must know that it has no effect.
void take_memory_limit(ordered_json& json, bool of_report) {
  if (!json.contains("memory") || !json["memory"].is_object() || !json["memory"].contains("limit")) return;
  const ordered_json limit = json["memory"]["limit"];
  json["memory"].erase("limit");
  if (!limit.is_null() && !of_report)
    throw ParameterError(fmt::format(
        "parameters: memory.limit = {}: is no parameter, must be set on the context (--memory)", limit.dump()));
}

void require(bool holds, const char* name, double value, const char* constraint) {
  if (!holds) throw ParameterError(fmt::format("{} = {:g}, must be {}", name, value, constraint));
}

void check(const SimplifyParams& simplify) {
  if (simplify.tolerance) require(*simplify.tolerance > 0, "simplify tolerance", *simplify.tolerance, "> 0");
  if (simplify.tolerance_vox)
    require(*simplify.tolerance_vox > 0, "simplify tolerance_vox", *simplify.tolerance_vox, "> 0");
  if (simplify.triangles)
    require(*simplify.triangles >= 1, "simplify triangles", static_cast<double>(*simplify.triangles), ">= 1");
  const int given = int{simplify.tolerance.has_value()} + int{simplify.tolerance_vox.has_value()} +
                    int{simplify.automatic} + int{simplify.triangles.has_value()};
  if (given > 1)
    throw ParameterError("simplify: tolerance, tolerance_vox, automatic and triangles: only one of them may be given");
}

/// Parameters of a method that the chosen one does not have are an error.
void refuse_contradictions(const ReconstructParams& params) {
  const char* method = name_of(params.method);
  const bool by_energy = uses_lambda(params.method);
  if (params.energy.lambda && params.energy.cross_validate)
    throw ParameterError(
        fmt::format("lambda = {:g} and cross_validate: only one of them may be given", *params.energy.lambda));
  if (params.energy.cross_validate && !by_energy)
    throw ParameterError(fmt::format("lambda = auto: the surface of method {} does not depend on lambda", method));
  if (params.energy.norm != Norm::isotropic && (!by_energy || params.method == Method::tv_sor))
    throw ParameterError(fmt::format("norm = anisotropic: method {} has none", method));
  const Border outside = params.border.outside;
  if ((outside == Border::open && params.method != Method::tv) ||
      (outside == Border::solid && params.method == Method::vrip))
    throw ParameterError(fmt::format("outside = {}: method {} cannot have it", name_of(outside), method));
  if (params.surface.threshold != SurfaceParams{}.threshold && !is_certified(params.method))
    throw ParameterError(fmt::format("threshold = {:g}: method {} has none", params.surface.threshold, method));
  if (params.surface.gap && !is_certified(params.method))
    throw ParameterError(fmt::format("gap = true: method {} has no certificate", method));
  if (params.surface.volume_interval && params.method != Method::tv)
    throw ParameterError(fmt::format("volume_interval = {:g}: method {} has no certified solver",
                                     *params.surface.volume_interval, method));
  if (params.surface.isovalue && !by_energy)
    throw ParameterError(fmt::format("isovalue = {:g}: method {} finds its own", *params.surface.isovalue, method));
  if (params.surface.refine.value_or(false) && !by_energy)
    throw ParameterError(fmt::format("refine = on: method {} finds its own surface", method));
  if (params.surface.refine.value_or(false) && params.surface.isovalue)
    throw ParameterError(
        fmt::format("isovalue = {:g} and refine = on: only one of them may be given", *params.surface.isovalue));
  if (params.surface.drop_components.value_or(false) && !by_energy)
    throw ParameterError(fmt::format("drop_components = on: method {} finds its own surface", method));
  if (params.components.min_support != ComponentParams{}.min_support && !drops_components(params))
    throw ParameterError(
        fmt::format("min_support = {:g}: components are kept (drop_components = off)", params.components.min_support));
  const TrimParams& trim = params.trim;
  if (params.method == Method::vrip && (trim.on.value_or(false) || trim.distance || trim.holes || trim.fill_holes))
    throw ParameterError(fmt::format("trim: the surface of method {} ends by itself where nothing was seen", method));
  if (params.refine.smoothing && !refines(params))
    throw ParameterError(fmt::format("smoothing = {:g}: the surface is not refined", *params.refine.smoothing));
  if (params.surface.relax.split_tolerance != RelaxParams{}.split_tolerance && !refines(params))
    throw ParameterError(
        fmt::format("split_tolerance = {:g}: the surface is not refined", params.surface.relax.split_tolerance));
}

}  // namespace

void validate(const ReconstructParams& params) {
  const PlaceParams& place = params.place;
  if (place.voxel && place.resolution)
    throw ParameterError(fmt::format("voxel = {:g} and resolution = {}: only one of them may be given", *place.voxel,
                                     *place.resolution));
  // Negated comparisons refuse not-a-number too.
  if (place.voxel) require(*place.voxel > 0, "voxel", *place.voxel, "> 0");
  require(place.samples_per_voxel2 > 0, "samples_per_voxel2", place.samples_per_voxel2, "> 0");
  require(place.padding >= 2 && place.padding <= 4096, "padding", place.padding, ">= 2 and <= 4096");
  if (place.anchor && !place.voxel)
    throw ParameterError("anchor: needs voxel, as every other one moves with the samples");
  if (place.anchor && !is_finite(*place.anchor)) throw ParameterError("anchor: must be finite");
  if (place.adapt && !adapts(params.method))
    throw ParameterError(
        fmt::format("adapt: method {} has no levels, as it works on the whole box; tv, graph-cut-6 "
                    "and graph-cut-26 have",
                    name_of(params.method)));
  if (place.adapt && !refines(params))
    throw ParameterError("adapt: needs refinement, as the levels' surfaces are joined by their distances");
  require(place.levels >= 0 && place.levels <= 12, "levels", place.levels, ">= 0 and <= 12");
  // Coarse levels multiply lambda by powers of four, in float.
  const auto weight = [](double v) { return v > 0 && v <= 1e24; };
  if (params.energy.lambda) require(weight(*params.energy.lambda), "lambda", *params.energy.lambda, "> 0 and <= 1e24");
  require(weight(params.energy.lambda_per_density), "lambda_per_density", params.energy.lambda_per_density,
          "> 0 and <= 1e24");
  if (params.surface.volume_interval)
    require(*params.surface.volume_interval > 0 && *params.surface.volume_interval <= 1, "volume_interval",
            *params.surface.volume_interval, "> 0 and <= 1");
  require(params.solve.tolerance > 0, "tolerance", params.solve.tolerance, "> 0");
  require(params.solve.max_iterations >= 1, "max_iterations", params.solve.max_iterations, ">= 1");
  const bool checks = params.solve.check_every >= 1 && params.solve.check_every <= 1000;
  require(checks, "check_every", params.solve.check_every, ">= 1 and <= 1000");
  require(params.solve.step_balance > 0, "step_balance", params.solve.step_balance, "> 0");
  validate(params.orient);
  validate(params.sor);
  validate(params.border);
  validate(params.cross_validation);
  validate(params.components);
  validate(RefineSetup{params.refine});
  validate(params.trim);
  check(params.simplify);
  validate(params.vrip.surface);
  const auto reach = [](double v) { return v > 0 && v <= 1000; };
  require(reach(params.vrip.front), "front", params.vrip.front, "> 0 and <= 1000");
  require(reach(params.vrip.behind), "behind", params.vrip.behind, "> 0 and <= 1000");
  require(params.poisson.tolerance > 0 && params.poisson.tolerance < 1, "poisson tolerance", params.poisson.tolerance,
          "> 0 and < 1");
  require(params.poisson.max_iterations >= 1, "poisson max_iterations", params.poisson.max_iterations, ">= 1");
  refuse_contradictions(params);
  const auto inside_unit = [](double v) { return v > 0 && v < 1; };
  validate(params.surface.relax);
  require(inside_unit(params.surface.threshold), "threshold", params.surface.threshold, "> 0 and < 1");
  if (params.surface.isovalue)
    require(inside_unit(*params.surface.isovalue), "isovalue", *params.surface.isovalue, "> 0 and < 1");
}

std::string to_json(const ReconstructParams& params) {
  ordered_json json;
  for_each_param(params,
                 [&](const char* group, const char* name, const auto& value) { json[group][name] = json_of(value); });
  return json_text(json);
}

ReconstructParams params_from_json(const std::string& text) {
  ordered_json json;
  try {
    json = ordered_json::parse(text);
  } catch (const nlohmann::json::exception& error) {
    throw ParameterError(fmt::format("parameters: not JSON: {}", error.what()));
  }
  if (!json.is_object()) throw ParameterError("parameters: must be a JSON object");
  const bool of_report = json.contains("parameters");
  if (of_report) json = ordered_json(std::move(json["parameters"]));
  take_memory_limit(json, of_report);
  refuse_unknown_keys(json);
  ReconstructParams params;
  for_each_param(params, [&](const char* group, const char* name, auto& value) {
    if (!json.contains(group) || !json[group].contains(name)) return;
    try {
      read_value(json[group][name], value);
    } catch (const std::exception& error) {
      throw ParameterError(
          fmt::format("parameters: {}.{} = {}: {}", group, name, json[group][name].dump(), error.what()));
    }
  });
  validate(params);
  return params;
}

}  // namespace soapfilm
