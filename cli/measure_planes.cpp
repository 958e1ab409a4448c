#include "cli/measure_planes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>

#include "cli/parse.h"
#include "soapfilm/error.h"

namespace soapfilm::cli {

namespace {

constexpr double most_planes = 10000;

bool names_axis(const std::string& text) {
  return text.size() > 1 && text[1] == '=' && std::string_view("xyz").find(text[0]) != std::string_view::npos;
}

Plane plane_across(char axis, double at) {
  Plane plane{{}, {}};
  plane.normal[axis - 'x'] = 1;
  plane.point[axis - 'x'] = at;
  return plane;
}

}  // namespace

bool looks_like_plane(const std::string& text) {
  return names_axis(text) || text.find_first_not_of("0123456789+-.,eE") == std::string::npos;
}

Plane parse_plane(const char* option, const std::string& text) {
  const std::string form = fmt::format("{}, all finite", plane_form);
  const auto all_finite = [&](const std::vector<double>& values) {
    return std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); });
  };
  const bool axis = names_axis(text);
  std::vector<double> v;
  try {
    v = parse_numbers(option, axis ? text.substr(2) : text, ',', axis ? 1 : 6, form.c_str());
  } catch (const ParameterError&) {  // it would quote the number alone
  }
  if (v.empty() || !all_finite(v)) throw ParameterError(fmt::format("{} = {}, must be {}", option, text, form));
  if (axis) return plane_across(text[0], v[0]);
  const Vec3d normal{v[3], v[4], v[5]};
  if (!(norm(normal) > 0)) throw ParameterError(fmt::format("{} = {}, its normal must not be zero", option, text));
  return {{v[0], v[1], v[2]}, normalized(normal)};
}

std::vector<Plane> parse_planes(const char* option, const std::string& text) {
  if (!names_axis(text) || text.find(':') == std::string::npos) return {parse_plane(option, text)};
  std::vector<double> v(3);
  try {
    v = parse_numbers(option, text.substr(2), ':', 3, "");
  } catch (const ParameterError&) {
  }
  const double steps = std::floor((v[1] - v[0]) / v[2] * (1 + 1e-12));
  if (!(v[2] > 0 && v[1] >= v[0] && steps < most_planes))
    throw ParameterError(fmt::format(
        "{} = {}, must be z=FROM:TO:STEP with FROM <= TO, STEP > 0 and at most 10000 planes", option, text));
  std::vector<Plane> planes;
  for (double k = 0; k <= steps; ++k) planes.push_back(plane_across(text[0], v[0] + k * v[2]));
  return planes;
}

}  // namespace soapfilm::cli
