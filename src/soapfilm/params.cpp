#include "soapfilm/params.h"

#include <fmt/format.h>

#include <array>
#include <concepts>
#include <nlohmann/json.hpp>
#include <set>
#include <utility>

#include "soapfilm/core/error.h"

namespace soapfilm {

namespace {

using nlohmann::ordered_json;

constexpr std::array<const char*, 5> direction_names = {"auto", "normals", "sensor", "scan", "estimate"};

/// Names every parameter once: visit(group, name, value).
template <class Params, class Visit>
void for_each_param(Params& p, Visit&& visit) {
  visit("orient", "directions", p.orient.source);
  visit("orient", "sensor", p.orient.sensor);
  visit("orient", "neighbours", p.orient.neighbours);
  visit("place", "voxel", p.place.voxel);
  visit("place", "resolution", p.place.resolution);
  visit("place", "samples_per_voxel2", p.place.samples_per_voxel2);
  visit("place", "padding", p.place.padding);
  visit("energy", "lambda", p.energy.lambda);
  visit("energy", "lambda_per_density", p.energy.lambda_per_density);
  visit("solve", "tolerance", p.solve.tolerance);
  visit("solve", "max_iterations", p.solve.max_iterations);
  visit("solve", "check_every", p.solve.check_every);
  visit("solve", "step_balance", p.solve.step_balance);
  visit("surface", "threshold", p.surface.threshold);
  visit("surface", "isovalue", p.surface.isovalue);
  visit("memory", "limit", p.memory_limit);
}

template <class T>
ordered_json json_of(const T& value) {
  return value;
}
ordered_json json_of(DirectionSource source) { return direction_names[static_cast<size_t>(source)]; }
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
void read_value(const ordered_json& json, T& value) {
  const bool fits = json.is_number_unsigned()  ? std::in_range<T>(json.get<uint64_t>())
                    : json.is_number_integer() ? std::in_range<T>(json.get<int64_t>())
                                               : false;
  require_type(fits, std::is_unsigned_v<T> ? "a whole number >= 0" : "a whole number");
  value = json.get<T>();
}
void read_value(const ordered_json& json, DirectionSource& source) {
  require_type(json.is_string(), "a string");
  const auto name = json.get<std::string>();
  for (size_t i = 0; i < direction_names.size(); ++i)
    if (name == direction_names[i]) source = static_cast<DirectionSource>(i);
  if (name != direction_names[static_cast<size_t>(source)])
    throw ParameterError(fmt::format("must be one of {}", fmt::join(direction_names, ", ")));
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

void refuse_unknown_keys(const ordered_json& json) {
  std::set<std::string> groups, names;
  ReconstructParams known;
  for_each_param(known, [&](const char* group, const char* name, auto&) {
    groups.insert(group);
    names.insert(std::string(group) + "." + name);
  });
  for (const auto& [group, values] : json.items()) {
    if (!groups.contains(group)) throw ParameterError(fmt::format("parameters: unknown key '{}'", group));
    if (!values.is_object()) throw ParameterError(fmt::format("parameters: '{}' must be an object", group));
    for (const auto& [name, value] : values.items())
      if (!names.contains(group + "." + name))
        throw ParameterError(fmt::format("parameters: unknown key '{}.{}'", group, name));
  }
}

void require(bool holds, const char* name, double value, const char* constraint) {
  if (!holds) throw ParameterError(fmt::format("{} = {:g}, must be {}", name, value, constraint));
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
  require(place.padding >= 2, "padding", place.padding, ">= 2");
  if (params.energy.lambda) require(*params.energy.lambda > 0, "lambda", *params.energy.lambda, "> 0");
  require(params.energy.lambda_per_density > 0, "lambda_per_density", params.energy.lambda_per_density, "> 0");
  require(params.solve.tolerance > 0, "tolerance", params.solve.tolerance, "> 0");
  require(params.solve.max_iterations >= 1, "max_iterations", params.solve.max_iterations, ">= 1");
  require(params.solve.check_every >= 1, "check_every", params.solve.check_every, ">= 1");
  require(params.solve.step_balance > 0, "step_balance", params.solve.step_balance, "> 0");
  const auto inside_unit = [](double v) { return v > 0 && v < 1; };
  require(inside_unit(params.surface.threshold), "threshold", params.surface.threshold, "> 0 and < 1");
  if (params.surface.isovalue)
    require(inside_unit(*params.surface.isovalue), "isovalue", *params.surface.isovalue, "> 0 and < 1");
}

std::string to_json(const ReconstructParams& params) {
  ordered_json json;
  for_each_param(params,
                 [&](const char* group, const char* name, const auto& value) { json[group][name] = json_of(value); });
  return json.dump(2);
}

ReconstructParams params_from_json(const std::string& text) {
  ordered_json json;
  try {
    json = ordered_json::parse(text);
  } catch (const nlohmann::json::exception& error) {
    throw ParameterError(fmt::format("parameters: not JSON: {}", error.what()));
  }
  if (!json.is_object()) throw ParameterError("parameters: must be a JSON object");
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
