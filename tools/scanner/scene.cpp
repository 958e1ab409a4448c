#include "tools/scanner/scene.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "soapfilm/core/random.h"
#include "soapfilm/error.h"
#include "tools/scanner/scene_builder.h"

namespace soapfilm {

namespace {

using std::numbers::pi;

using SceneMaker = Scene (*)();
struct NamedScene {
  const char* name;
  SceneMaker make;
};
constexpr std::array<NamedScene, 6> scene_makers{{{"room", make_room},
                                                  {"yard", make_yard},
                                                  {"street", make_street},
                                                  {"terrain", make_terrain},
                                                  {"tunnel", make_tunnel},
                                                  {"facade", make_facade}}};

/// Bits of the faces of SceneBuilder::hollow.
constexpr unsigned low_x = 1, high_y = 8;

double hills(double x, double y) {
  return 6.0 * std::sin(x / 35.0) * std::cos(y / 48.0) + 2.0 * std::sin(x / 11.0 + y / 17.0) + 0.02 * x;
}

ScannerParams spinning(std::vector<Vec3d> positions, int columns, int rows, double lowest_deg, double highest_deg) {
  ScannerParams scanner;
  scanner.positions = std::move(positions);
  scanner.rays = Rays::spinning;
  scanner.columns = columns;
  scanner.rows = rows;
  scanner.lowest_deg = lowest_deg;
  scanner.highest_deg = highest_deg;
  scanner.max_incidence_deg = 89;
  return scanner;
}

}  // namespace

Scene make_room() {
  SceneBuilder build;
  const Box3d air{{0, 0, 0}, {6, 4, 2.6}};
  build.hollow(air, low_x | high_y);
  build.wall(air.lo, {0, 4, 0}, {0, 0, 2.6}, {{2.6, 0, 3.5, 2.0}});       // the door
  build.wall({0, 4, 0}, {6, 0, 0}, {0, 0, 2.6}, {{2.0, 0.9, 4.0, 2.1}});  // the window
  build.block({{4.2, 0, 0}, {5.4, 0.6, 1.9}}, Rests::on_the_floor);       // the cabinet
  build.block({{2.2, 1.6, 0.70}, {3.8, 2.4, 0.76}});                      // the table
  for (const double x : {2.25, 3.67})
    for (const double y : {1.65, 2.27}) build.block({{x, y, 0}, {x + 0.08, y + 0.08, 0.70}}, Rests::on_the_floor);
  build.block({{2.85, 1.85, 2.45}, {3.15, 2.15, 2.6}}, Rests::at_the_ceiling);  // the lamp
  return {"room", build.take(), spinning({{1.2, 1.0, 1.4}, {4.8, 3.0, 1.5}}, 420, 210, -88, 89)};
}

Scene make_yard() {
  SceneBuilder build;
  build.wall({-12, -12, 0}, {24, 0, 0}, {0, 24, 0});
  build.wall({-6, 12, 0}, {12, 0, 0}, {0, 0, 4});
  return {"yard", build.take(), spinning({{0, 0, 1.6}}, 1200, 400, -60, 30)};
}

Scene make_street() {
  SceneBuilder build;
  build.wall({-60, -6, 0}, {120, 0, 0}, {0, 12, 0});
  for (const double side : {-1.0, 1.0}) {  // kerbs of 12 cm and pavements up to the fronts
    const double edge = 6.0 * side, front = side > 0 ? 8.0 : -9.0;
    if (side > 0) {
      build.wall({-60, edge, 0}, {120, 0, 0}, {0, 0, 0.12});
      build.wall({-60, edge, 0.12}, {120, 0, 0}, {0, front - edge, 0});
    } else {
      build.wall({-60, edge, 0}, {0, 0, 0.12}, {120, 0, 0});
      build.wall({-60, front, 0.12}, {120, 0, 0}, {0, edge - front, 0});
    }
  }
  build.block({{-60, 8, 0.12}, {-10, 18, 9}}, Rests::on_the_floor);
  build.block({{-6, 8, 0.12}, {60, 18, 12}}, Rests::on_the_floor);
  build.block({{-50, -18, 0.12}, {60, -9, 8}}, Rests::on_the_floor);
  for (const double x : {-22.0, -14.0, 6.0, 14.0, 27.0}) {  // cars: a body on its shadow, a cabin
    build.block({{x, -5.6, 0}, {x + 4.2, -3.9, 0.9}}, Rests::on_the_floor);
    build.block({{x + 0.9, -5.4, 0.9}, {x + 3.2, -4.1, 1.5}}, Rests::on_the_floor);
  }
  for (const double x : {-30.0, -12.0, 9.0, 30.0}) build.post({x, 6.5, 0.12}, 0.12, 6.0);
  return {"street", build.take(), spinning({{0, 0, 1.73}}, 2000, 64, -24.8, 2)};
}

Scene make_terrain() {
  SceneBuilder build;
  build.ground(0, 0, 200, 200, 250, hills);
  constexpr std::array<std::array<double, 5>, 4> houses{
      {{40, 50, 12, 9, 5}, {90, 120, 15, 10, 6}, {150, 60, 10, 14, 7}, {130, 160, 18, 11, 5}}};
  for (const auto& [x, y, a, b, h] : houses) {  // walls into the ground, a gable roof along x
    const double foot = hills(x, y) - 4.0, eaves = hills(x, y) + h, ridge = eaves + 0.3 * b;
    const Vec3d p{x - a / 2, y - b / 2, foot}, q{x + a / 2, y + b / 2, foot}, up{0, 0, eaves - foot};
    build.wall(p, {a, 0, 0}, up);
    build.wall(q, {-a, 0, 0}, up);
    build.wall({p.x, q.y, foot}, {0, -b, 0}, up);
    build.wall({q.x, p.y, foot}, {0, b, 0}, up);
    build.wall({p.x, p.y, eaves}, {a, 0, 0}, {0, b / 2, ridge - eaves});
    build.wall({p.x, q.y, eaves}, {0, -b / 2, ridge - eaves}, {a, 0, 0});
  }
  Random random(4);
  for (int k = 0; k < 40; ++k) {
    const double x = random.uniform(5, 195), y = random.uniform(5, 195);
    build.ball({x, y, hills(x, y) + 3.0}, random.uniform(1.5, 3.5), 12);
  }
  ScannerParams scanner;
  scanner.positions = {{100, 100, 500}};
  scanner.rays = Rays::parallel;
  scanner.columns = scanner.rows = 400;
  scanner.max_incidence_deg = 89;
  return {"terrain", build.take(), scanner};
}

Scene make_tunnel() {
  SceneBuilder build;
  constexpr double length = 40, half = 2.5, spring = 2.0;  // the vault begins at this height
  constexpr int facets = 32;
  const Vec3d along{length, 0, 0};
  build.wall({0, -half, 0}, along, {0, 2 * half, 0});
  const std::vector<WallPart> niches{{6, 0, 8, 1.6}, {18, 0, 20, 1.6}, {30, 0, 32, 1.6}};
  build.wall({0, half, 0}, along, {0, 0, spring}, niches);
  for (const WallPart& niche : niches) build.niche({0, half, 0}, along, {0, 0, spring}, niche, 0.6);
  build.wall({0, -half, 0}, {0, 0, spring}, along);
  for (int k = 0; k < facets; ++k) {
    const auto at = [&](int i) {
      const double angle = pi * i / facets;
      return Vec3d{0, half * std::cos(angle), spring + half * std::sin(angle)};
    };
    build.wall(at(k), along, at(k + 1) - at(k));
  }
  return {"tunnel", build.take(), spinning({{8, 0.4, 1.6}, {30, -0.5, 1.6}}, 720, 240, -70, 89)};
}

Scene make_facade() {
  SceneBuilder build;
  const Vec3d corner{0, 0, 0}, u{30, 0, 0}, v{0, 0, 12};
  std::vector<WallPart> recesses{{14.2, 0, 15.6, 2.4}};  // the door
  for (int k = 0; k < 8; ++k)
    for (const double z : {5.0, 8.5}) recesses.push_back({2 + 3.5 * k, z, 3.4 + 3.5 * k, z + 1.8});
  for (const double x : {2.0, 5.5, 9.0, 19.5, 23.0, 26.5}) recesses.push_back({x, 1.5, x + 1.4, 3.3});
  build.wall(corner, u, v, recesses);
  for (const WallPart& recess : recesses) build.niche(corner, u, v, recess, 0.3);
  for (const auto& [x, z] : {std::pair{9.0, 4.2}, std::pair{20.0, 7.7}}) {  // a slab and a parapet each
    build.block({{x, -1.2, z}, {x + 4, 0, z + 0.2}});
    build.block({{x, -1.2, z + 0.2}, {x + 4, -1.08, z + 1.1}});
  }
  return {"facade", build.take(), spinning({{5, -9, 1.6}, {15, -9, 1.6}, {25, -9, 1.6}}, 900, 200, -12, 52)};
}

std::vector<std::string> scene_names() {
  std::vector<std::string> names;
  for (const NamedScene& maker : scene_makers) names.emplace_back(maker.name);
  return names;
}

Scene make_scene(const std::string& name) {
  for (const NamedScene& maker : scene_makers)
    if (name == maker.name) return maker.make();
  throw ParameterError(fmt::format("scene = {}, must be one of {}", name, fmt::join(scene_names(), ", ")));
}

}  // namespace soapfilm
