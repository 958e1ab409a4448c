#include "nasty_cloud.h"

#include <algorithm>
#include <cmath>

namespace soapfilm::test {

double Chooser::power(double low, double high) { return std::pow(10.0, uniform(low, high)); }

Vec3d Chooser::direction() {
  const Vec3d v{normal(), normal(), normal()};
  return norm(v) > 0 ? v / norm(v) : Vec3d{0, 0, 1};
}

namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();

/// Evenly on the unit sphere.
Vec3d on_sphere(size_t i, size_t count) {
  const double z = 1 - (2.0 * static_cast<double>(i) + 1) / static_cast<double>(count);
  const double a = 2.399963229728653 * static_cast<double>(i), r = std::sqrt(std::max(0.0, 1 - z * z));
  return {r * std::cos(a), r * std::sin(a), z};
}

void add(NastyCloud& cloud, Vec3d position, Vec3d normal) {
  cloud.positions.push_back(position);
  cloud.normals.push_back(normal);
}

/// Clouds of a surface.
void add_surface(NastyCloud& cloud, Chooser& choose, size_t kind, size_t count) {
  const double noise = choose.one_in(2) ? 0 : choose.power(-6, -0.5);
  const auto jitter = [&] { return noise * Vec3d{choose.normal(), choose.normal(), choose.normal()}; };
  for (size_t i = 0; i < count; ++i) {
    const Vec3d n = on_sphere(i, count);
    switch (kind) {
      case 0:  // a ball
        add(cloud, n + jitter(), n);
        break;
      case 1: {  // a cube's faces, on a regular grid: many ties
        const size_t axis = i % 3, side = i / 3 % 2, cell = i / 6;
        Vec3d p, normal;
        p[static_cast<int>(axis)] = side == 0 ? -1 : 1;
        p[static_cast<int>((axis + 1) % 3)] = static_cast<double>(cell % 5) / 2 - 1;
        p[static_cast<int>((axis + 2) % 3)] = static_cast<double>(cell / 5 % 5) / 2 - 1;
        normal[static_cast<int>(axis)] = p[static_cast<int>(axis)];
        add(cloud, p, normal);
        break;
      }
      case 2:  // half a ball
        add(cloud, Vec3d{n.x, n.y, std::abs(n.z)} + jitter(), {n.x, n.y, std::abs(n.z)});
        break;
      case 3:  // a room, seen from inside
        add(cloud, n + jitter(), -1.0 * n);
        break;
      case 4:  // an ellipsoid as thin as a leaf, or a needle
        add(cloud, Vec3d{n.x, 0.3 * n.y, 0.01 * n.z} + jitter(), n);
        break;
      default:  // two balls far from each other
        add(cloud, (i % 2 == 0 ? Vec3d{} : Vec3d{10, 3, 0}) + n + jitter(), n);
    }
  }
}

/// Clouds of none.
void add_no_surface(NastyCloud& cloud, Chooser& choose, size_t kind, size_t count) {
  const Vec3d axis = choose.direction(), across = choose.direction(), normal = choose.direction();
  const double thin = choose.one_in(4) ? 0 : choose.power(-14, -1), far = choose.power(0, 14);
  for (size_t i = 0; i < count; ++i) {
    const Vec3d anywhere{choose.uniform(-1, 1), choose.uniform(-1, 1), choose.uniform(-1, 1)};
    switch (kind) {
      case 0:  // all the same
        add(cloud, axis, normal);
        break;
      case 1:  // a line
        add(cloud, anywhere.x * axis + thin * anywhere, normal);
        break;
      case 2:  // a plane
        add(cloud, anywhere.x * axis + anywhere.y * across + thin * anywhere, normal);
        break;
      case 3:  // two clusters, far from each other
        add(cloud, (i % 2 == 0 ? 0.0 : far) * axis + anywhere, choose.direction());
        break;
      default:  // anywhere
        add(cloud, anywhere, choose.direction());
    }
  }
}

void spoil(std::vector<Vec3d>& column, Chooser& choose) {
  constexpr double values[] = {nan, infinity, -infinity, 0, 1e300, -1e300, 1e-310, 1e39};
  for (Vec3d& v : column)
    if (choose.one_in(12)) v[static_cast<int>(choose.below(3))] = choose.of(values);
}

void spoil_normals(NastyCloud& cloud, Chooser& choose) {
  const double length = choose.power(-60, 60);
  const size_t kind = choose.below(12);
  if (kind == 0) cloud.normals.clear();
  for (Vec3d& n : cloud.normals) {
    if (kind == 1) n = {};
    if (kind == 2 && choose.one_in(3)) n = {};
    if (kind == 3 && choose.one_in(3)) n = -1.0 * n;
    if (kind == 4) n = length * n;
    if (kind == 5) n = choose.power(-45, 39) * n;
    if (kind == 6) n = {0, 0, 1};
  }
  if (kind == 7) spoil(cloud.normals, choose);
}

void add_weights(NastyCloud& cloud, Chooser& choose) {
  const size_t kind = choose.below(16);
  if (kind > 8) return;
  const double all = choose.power(-320, 308);
  constexpr double bad[] = {-1, nan, infinity, -0.0, 1e-310, 3e38, 1e39};
  for (size_t i = 0; i < cloud.positions.size(); ++i) {
    double w = 1;
    if (kind == 1) w = choose.uniform(0, 4);
    if (kind == 2) w = 0;
    if (kind == 3) w = choose.one_in(2) ? 0 : 1;
    if (kind == 4) w = all;
    if (kind == 5) w = choose.power(-30, 30);
    if (kind == 6 && choose.one_in(20)) w = choose.of(bad);
    if (kind == 7) w = i == 0 ? 1e6 : 1e-6;
    if (kind == 8) w = 0.001;
    cloud.weights.push_back(w);
  }
}

void add_sensors(NastyCloud& cloud, Chooser& choose, double scale) {
  const size_t kind = choose.below(12);
  cloud.scan_sensor = kind < 3;
  cloud.sensor = kind == 0                 ? 5 * scale * choose.direction()
                 : kind == 1               ? Vec3d{}
                 : cloud.positions.empty() ? Vec3d{}
                                           : cloud.positions[choose.below(cloud.positions.size())];
  if (kind < 3 || kind > 7) return;
  const Vec3d one = 5 * scale * choose.direction();
  for (const Vec3d& p : cloud.positions) {
    Vec3d s = one;
    if (kind == 4) s = p;
    if (kind == 5) s = choose.one_in(2) ? Vec3d{nan, nan, nan} : one;
    if (kind == 6) s = 0.1 * scale * choose.direction();
    if (kind == 7) {
      const double distance = choose.power(-5, 30);
      s = distance * choose.direction();
    }
    cloud.sensors.push_back(s);
  }
  if (choose.one_in(4)) spoil(cloud.sensors, choose);
}

/// Scans, of which one may lose all of its samples, and a range grid.
void divide(NastyCloud& cloud, Chooser& choose) {
  const size_t count = cloud.positions.size();
  if (count >= 2 && choose.one_in(3)) {
    const size_t first = 1 + choose.below(count - 1);
    cloud.scans = {first, count - first};
    if (choose.one_in(4)) std::fill_n(cloud.positions.begin(), first, Vec3d{nan, 0, 0});
    return;
  }
  if (count == 0 || !choose.one_in(4)) return;
  cloud.columns = 1 + static_cast<int>(choose.below(20));
  cloud.rows = 1 + static_cast<int>(count) / cloud.columns;
  const bool shuffled = choose.one_in(4);
  for (int cell = 0; cell < cloud.columns * cloud.rows; ++cell) {
    const bool seen = cell < static_cast<int>(count) && !choose.one_in(8);
    cloud.grid.push_back(!seen ? -1 : shuffled ? static_cast<int>(choose.below(count)) : cell);
  }
}

}  // namespace

NastyCloud nasty_cloud(Chooser& choose) {
  NastyCloud cloud;
  const size_t count = choose.one_in(12)  ? choose.below(8)
                       : choose.one_in(3) ? choose.below(201)
                                          : 20 + choose.below(60);
  if (choose.below(5) != 0)
    add_surface(cloud, choose, choose.below(6), count);
  else
    add_no_surface(cloud, choose, choose.below(5), count);
  if (choose.one_in(8))  // samples that are there several times
    for (size_t i = 0; i < count / 2; ++i) {
      const size_t from = choose.below(count);
      add(cloud, cloud.positions[from], choose.one_in(2) ? cloud.normals[from] : -1.0 * cloud.normals[from]);
    }

  const double scale = choose.one_in(3)    ? choose.power(-4, 4)
                       : choose.one_in(6)  ? choose.power(-105, 105)
                       : choose.one_in(20) ? choose.power(-320, 308)
                                           : 1;
  const double shift = choose.one_in(5) ? choose.power(0, choose.one_in(3) ? 17 : 6) : 0;
  const Vec3d offset = shift * choose.direction();
  for (Vec3d& p : cloud.positions) p = scale * (p + offset);
  spoil_normals(cloud, choose);
  add_weights(cloud, choose);
  add_sensors(cloud, choose, scale);
  for (size_t i = 0; i < cloud.positions.size() && i < 400; ++i) {
    cloud.colors.push_back({static_cast<int>(i % 256), 128, 255});
    cloud.values.push_back(choose.one_in(8) ? nan : choose.one_in(50) ? 1e39 : choose.normal());
  }
  if (choose.one_in(2)) cloud.colors.clear();
  if (choose.one_in(2)) cloud.values.clear();
  if (choose.one_in(14)) spoil(cloud.positions, choose);
  divide(cloud, choose);
  return cloud;
}

}  // namespace soapfilm::test
