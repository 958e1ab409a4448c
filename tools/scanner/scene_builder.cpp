#include "tools/scanner/scene_builder.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace soapfilm {

using std::numbers::pi;

uint32_t SceneBuilder::vertex(Vec3d p) {
  mesh_.vertices.push_back(p);
  return static_cast<uint32_t>(mesh_.vertices.size() - 1);
}

void SceneBuilder::quad(Vec3d a, Vec3d b, Vec3d c, Vec3d d) {
  const uint32_t i = vertex(a), j = vertex(b), k = vertex(c), l = vertex(d);
  mesh_.triangles.push_back({i, j, k});
  mesh_.triangles.push_back({i, k, l});
}

void SceneBuilder::wall(Vec3d corner, Vec3d u, Vec3d v, const std::vector<WallPart>& openings) {
  const double width = norm(u), height = norm(v);
  const Vec3d along = u / width, up = v / height;
  // Cells between all edges of openings; each is wholly open or wholly wall.
  std::vector<double> columns{0, width}, rows{0, height};
  for (const WallPart& o : openings) {
    columns.insert(columns.end(), {o.u0, o.u1});
    rows.insert(rows.end(), {o.v0, o.v1});
  }
  std::sort(columns.begin(), columns.end());
  std::sort(rows.begin(), rows.end());
  for (size_t i = 0; i + 1 < columns.size(); ++i) {
    for (size_t j = 0; j + 1 < rows.size(); ++j) {
      const double s = 0.5 * (columns[i] + columns[i + 1]), t = 0.5 * (rows[j] + rows[j + 1]);
      const bool open = std::any_of(openings.begin(), openings.end(),
                                    [&](const WallPart& o) { return s > o.u0 && s < o.u1 && t > o.v0 && t < o.v1; });
      if (open || columns[i] == columns[i + 1] || rows[j] == rows[j + 1]) continue;
      const auto at = [&](double a, double b) { return corner + along * a + up * b; };
      quad(at(columns[i], rows[j]), at(columns[i + 1], rows[j]), at(columns[i + 1], rows[j + 1]),
           at(columns[i], rows[j + 1]));
    }
  }
}

void SceneBuilder::block(const Box3d& box, Rests rests) {
  const Vec3d s = box.size(), x{s.x, 0, 0}, y{0, s.y, 0}, z{0, 0, s.z};
  wall(box.lo, x, z);
  wall(box.lo + y, z, x);
  wall(box.lo, z, y);
  wall(box.lo + x, y, z);
  if (rests != Rests::at_the_ceiling) wall(box.lo + z, x, y);
  if (rests != Rests::on_the_floor) wall(box.lo, y, x);
}

void SceneBuilder::hollow(const Box3d& box, unsigned without) {
  const Vec3d s = box.size(), x{s.x, 0, 0}, y{0, s.y, 0}, z{0, 0, s.z};
  const auto there = [&](int axis, int high) { return !(without >> (2 * axis + high) & 1U); };
  if (there(0, 0)) wall(box.lo, y, z);
  if (there(0, 1)) wall(box.lo + x, z, y);
  if (there(1, 0)) wall(box.lo, z, x);
  if (there(1, 1)) wall(box.lo + y, x, z);
  if (there(2, 0)) wall(box.lo, x, y);
  if (there(2, 1)) wall(box.lo + z, y, x);
}

void SceneBuilder::niche(Vec3d corner, Vec3d u, Vec3d v, const WallPart& opening, double depth) {
  const Vec3d along = normalized(u), up = normalized(v), inwards = cross(along, up) * -depth;
  const Vec3d a = corner + along * opening.u0 + up * opening.v0;
  const Vec3d width = along * (opening.u1 - opening.u0), height = up * (opening.v1 - opening.v0);
  wall(a + inwards, width, height);
  wall(a, inwards, height);
  wall(a + width, height, inwards);
  wall(a, width, inwards);
  wall(a + height, inwards, width);
}

void SceneBuilder::post(Vec3d foot, double radius, double height, int sides) {
  const Vec3d up{0, 0, height};
  const auto corner = [&](int k) {
    const double angle = 2.0 * pi * k / sides;
    return foot + Vec3d{radius * std::cos(angle), radius * std::sin(angle), 0};
  };
  for (int k = 0; k < sides; ++k) {
    const Vec3d a = corner(k), b = corner((k + 1) % sides);
    quad(a, b, b + up, a + up);
    mesh_.triangles.push_back({vertex(foot + up), vertex(a + up), vertex(b + up)});
  }
}

void SceneBuilder::ball(Vec3d center, double radius, int n) {
  const auto at = [&](int i, int j) {
    const double theta = pi * i / n, phi = pi * (j % (2 * n)) / n;
    return center + Vec3d{std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)} * radius;
  };
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < 2 * n; ++j) {
      const uint32_t a = vertex(at(i, j)), b = vertex(at(i + 1, j)), c = vertex(at(i + 1, j + 1));
      if (i + 1 < n) mesh_.triangles.push_back({a, b, c});
      if (i > 0) mesh_.triangles.push_back({a, c, vertex(at(i, j + 1))});
    }
  }
}

void SceneBuilder::ground(double x0, double y0, double x1, double y1, int n,
                          const std::function<double(double, double)>& height) {
  const auto first = static_cast<uint32_t>(mesh_.vertices.size()), row = static_cast<uint32_t>(n + 1);
  for (int j = 0; j <= n; ++j) {
    for (int i = 0; i <= n; ++i) {
      const double x = x0 + (x1 - x0) * i / n, y = y0 + (y1 - y0) * j / n;
      mesh_.vertices.push_back({x, y, height(x, y)});
    }
  }
  for (uint32_t j = 0; j + 1 < row; ++j) {
    for (uint32_t i = 0; i + 1 < row; ++i) {
      const uint32_t a = first + j * row + i;
      mesh_.triangles.push_back({a, a + 1, a + 1 + row});
      mesh_.triangles.push_back({a, a + 1 + row, a + row});
    }
  }
}

}  // namespace soapfilm
