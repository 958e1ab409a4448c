#include "cli/georeference.h"

#include <fmt/format.h>

#include <cmath>
#include <memory>

#include "soapfilm/core/vec.h"
#include "soapfilm/error.h"
#ifdef SOAPFILM_PROJ
#include "cli/proj_library.h"
#endif

namespace soapfilm::cli {

#ifdef SOAPFILM_PROJ

namespace {

struct Destroy {
  void operator()(PJ* p) const { proj_library().proj_destroy(p); }
  void operator()(PJ_CONTEXT* p) const { proj_library().proj_context_destroy(p); }
};
using Pj = std::unique_ptr<PJ, Destroy>;
using PjContext = std::unique_ptr<PJ_CONTEXT, Destroy>;

constexpr double semi_major = 6378137.0, semi_minor = 6356752.314245;  // meters, of WGS 84

/// Meters in the unit of the system's first axis; 1 for degrees.
double meters_of(PJ_CONTEXT* context, const PJ* system) {
  const PJ_TYPE type = proj_library().proj_get_type(system);
  if (type == PJ_TYPE_BOUND_CRS)
    return meters_of(context, Pj(proj_library().proj_get_source_crs(context, system)).get());
  if (type == PJ_TYPE_GEOGRAPHIC_2D_CRS || type == PJ_TYPE_GEOGRAPHIC_3D_CRS) return 1;
  const Pj axes(proj_library().proj_crs_get_coordinate_system(context, system));
  double factor = 1;
  if (axes)
    proj_library().proj_cs_get_axis_info(context, axes.get(), 0, nullptr, nullptr, nullptr, &factor, nullptr, nullptr,
                                         nullptr);
  return factor;
}

/// The place on the ellipsoid at longitude and latitude (degrees), and up from there.
Vec3d earth_place(double longitude, double latitude, double height) {
  constexpr double degree = 3.14159265358979323846 / 180;
  constexpr double eccentricity2 = 1 - (semi_minor / semi_major) * (semi_minor / semi_major);
  const double sine = std::sin(latitude * degree), cosine = std::cos(latitude * degree);
  const double to_axis = semi_major / std::sqrt(1 - eccentricity2 * sine * sine);
  return {(to_axis + height) * cosine * std::cos(longitude * degree),
          (to_axis + height) * cosine * std::sin(longitude * degree), (to_axis * (1 - eccentricity2) + height) * sine};
}

/// From a system to earth-centered coordinates (EPSG:4978).
class ToEarth {
 public:
  explicit ToEarth(const std::string& text)
      : context_(proj_library().proj_context_create()), name_(text.substr(0, 60)) {
    proj_library().proj_log_level(context_.get(), PJ_LOG_NONE);
    Pj system(proj_library().proj_create(context_.get(), text.c_str()));
    if (!system || !proj_library().proj_is_crs(system.get())) refuse("is no coordinate system that PROJ knows");
    is_centered_ = proj_library().proj_get_type(system.get()) == PJ_TYPE_GEOCENTRIC_CRS;
    Pj heights;
    if (proj_library().proj_get_type(system.get()) == PJ_TYPE_COMPOUND_CRS) {
      heights.reset(proj_library().proj_crs_get_sub_crs(context_.get(), system.get(), 1));
      system.reset(proj_library().proj_crs_get_sub_crs(context_.get(), system.get(), 0));
    }
    meters_of_height_ = meters_of(context_.get(), heights ? heights.get() : system.get());
    const Pj earth(proj_library().proj_create(context_.get(), is_centered_ ? "EPSG:4978" : "EPSG:4326"));
    if (!earth) refuse("cannot be placed: PROJ finds no data, as of the package proj-data");
    const Pj path(
        proj_library().proj_create_crs_to_crs_from_pj(context_.get(), system.get(), earth.get(), nullptr, nullptr));
    if (path) path_.reset(proj_library().proj_normalize_for_visualization(context_.get(), path.get()));
    if (!path_) refuse("has no way to WGS 84");
  }

  Vec3d operator()(Vec3d p) const {
    const PJ_COORD at = proj_library().proj_trans(path_.get(), PJ_FWD, PJ_COORD{{p.x, p.y, is_centered_ ? p.z : 0, 0}});
    const Vec3d place =
        is_centered_ ? Vec3d{at.xyz.x, at.xyz.y, at.xyz.z} : earth_place(at.xyz.x, at.xyz.y, p.z * meters_of_height_);
    const bool is_degrees = is_centered_ || (std::abs(at.xyz.x) <= 360 && std::abs(at.xyz.y) <= 90);
    if (!is_finite(place) || !is_degrees) refuse(fmt::format("does not hold the point {:.10g}, {:.10g}", p.x, p.y));
    return place;
  }

 private:
  [[noreturn]] void refuse(const std::string& why) const {
    throw ParameterError(fmt::format("coordinate system '{}' {}", name_, why));
  }

  PjContext context_;
  std::string name_;
  bool is_centered_ = false;
  double meters_of_height_ = 1;
  Pj path_;
};

}  // namespace

EarthFrame move_to_earth(const std::string& system, Vec3d center, std::vector<Vec3d>& points) {
  const ToEarth to_earth(system);
  const Vec3d origin = to_earth(center);
  constexpr double a2 = semi_major * semi_major, b2 = semi_minor * semi_minor;
  const Vec3d up = normalized(Vec3d{origin.x / a2, origin.y / a2, origin.z / b2});
  const Vec3d side = cross(Vec3d{0, 0, 1}, up);
  const Vec3d east = norm(side) > 1e-9 ? normalized(side) : Vec3d{1, 0, 0};  // at a pole any
  const Vec3d north = cross(up, east);
  for (Vec3d& p : points) {
    const Vec3d from = to_earth(p) - origin;
    p = {dot(east, from), dot(north, from), dot(up, from)};
  }
  return {
      {east.x, east.y, east.z, 0, north.x, north.y, north.z, 0, up.x, up.y, up.z, 0, origin.x, origin.y, origin.z, 1}};
}

bool knows_earth() { return true; }

#else

EarthFrame move_to_earth(const std::string&, Vec3d, std::vector<Vec3d>&) {
  throw ParameterError("coordinate systems need PROJ, without which this program was built");
}

bool knows_earth() { return false; }

#endif

}  // namespace soapfilm::cli
