// From where a range grid was seen: perspective and angular images about the origin, and grids that are none.
#include "soapfilm/io/grid_view.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "samples.h"
#include "soapfilm/core/vec.h"
#include "soapfilm/io/range_image.h"

namespace soapfilm {
namespace TEST_FILE {

struct Image {
  std::vector<Vec3d> positions;
  Scan scan;
};

/// `position(u, v)` for u and v from 0 to 1.
Image image_of(int columns, int rows, const std::function<Vec3d(double, double)>& position) {
  Image image;
  image.scan.range_grid = io::full_grid(columns, rows);
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < columns; ++c) image.positions.push_back(position((c + 0.5) / columns, (r + 0.5) / rows));
  image.scan.end = image.positions.size();
  return image;
}

io::GridView view(const Image& image) { return io::judge_view(image.positions, image.scan, {}); }

/// The point of the scene along the ray: a ball before a wall at z = 3.
Vec3d hit(const Vec3d& d) {
  const Vec3d center{0.2, 0.1, 2};
  const double a = dot(d, d), b = dot(d, center), q = b * b - a * (dot(center, center) - 0.36);
  return (q > 0 ? (b - std::sqrt(q)) / a : 3 / d.z) * d;
}

/// The point of a room's walls along the ray.
Vec3d wall(const Vec3d& d) {
  const Vec3d lo{-2, -3, -1.5}, hi{3, 4, 1.7};
  double t = 1e9;
  for (int k = 0; k < 3; ++k)
    if (d[k] != 0) t = std::min(t, (d[k] > 0 ? hi[k] : lo[k]) / d[k]);
  return t * d;
}

Vec3d ray(double u, double v, double width) { return {(u - 0.5) * width, (v - 0.5) * 0.75 * width, 1}; }

Vec3d turned(double u, double v, double range = 2 * 3.14159265358979, double tilt = 0) {
  const double azimuth = (u - 0.5) * range, height = 1 - 2 * v;
  const Vec3d d{std::cos(height) * std::cos(azimuth), std::cos(height) * std::sin(azimuth), std::sin(height)};
  return {d.x, std::cos(tilt) * d.y - std::sin(tilt) * d.z, std::sin(tilt) * d.y + std::cos(tilt) * d.z};
}

TEST(GridView, PerspectiveImagesAreSeenFromTheCamera) {
  Random random(3);
  for (const double width : {0.3, 1.2, 2.0}) {
    EXPECT_EQ(view(image_of(160, 120, [&](double u, double v) { return hit(ray(u, v, width)); })),
              io::GridView::seen_from)
        << width;
    EXPECT_EQ(view(image_of(60, 45,
                            [&](double u, double v) { return (1 + 0.01 * random.normal()) * hit(ray(u, v, width)); })),
              io::GridView::seen_from)
        << width;
  }
  const Image elsewhere = image_of(160, 120, [&](double u, double v) { return hit(ray(u, v, 1.2)) + Vec3d{1, 2, 1}; });
  EXPECT_NE(view(elsewhere), io::GridView::seen_from);
  EXPECT_EQ(io::judge_view(elsewhere.positions, elsewhere.scan, {1, 2, 1}), io::GridView::seen_from);
  // A plane looks the same from many places.
  EXPECT_EQ(view(image_of(160, 120, [&](double u, double v) { return 3.0 * ray(u, v, 1.2); })), io::GridView::unclear);
}

TEST(GridView, AngularImagesAreSeenFromTheScanner) {
  for (const double tilt : {0.0, 0.5})
    for (const double range : {6.28318530717958, 2.0})
      EXPECT_EQ(view(image_of(120, 60, [&](double u, double v) { return wall(turned(u, v, range, tilt)); })),
                io::GridView::seen_from)
          << tilt << " " << range;
  EXPECT_EQ(view(image_of(120, 60,
                          [&](double u, double v) {
                            return wall(turned(u, v)) + Vec3d{0.8, 0.5, 0};
                          })),
            io::GridView::not_from);
}

TEST(GridView, HeightsOverAMapWereNotSeenFromItsOrigin) {
  const auto map = [](double x, double y, double height, double rough) {
    return view(image_of(60, 60, [=](double u, double v) {
      const double px = x + 60 * u, py = y + 60 * v;
      return Vec3d{px, py, height + rough * std::sin(px / 7) * std::cos(py / 9)};
    }));
  };
  for (const double rough : {0.0, 3.0}) {
    EXPECT_EQ(map(-30, -30, -1.7, rough), io::GridView::not_from);
    EXPECT_NE(map(0, 0, 100, rough), io::GridView::seen_from);
    EXPECT_NE(map(20, 20, 3, rough), io::GridView::seen_from);
    EXPECT_NE(map(600, 100, 100, rough), io::GridView::seen_from);
    EXPECT_NE(map(5000, 800, 100, rough), io::GridView::seen_from);
  }
  EXPECT_NE(view(image_of(100, 80,
                          [](double u, double v) {
                            return Vec3d{u, v, 3 + 0.3 * std::cos(6 * u) * std::sin(4 * v)};
                          })),
            io::GridView::seen_from);
}

TEST(GridView, FewSamplesTellNothing) {
  EXPECT_EQ(view(image_of(9, 9, [&](double u, double v) { return hit(ray(u, v, 1)); })), io::GridView::unclear);
  EXPECT_EQ(view(image_of(400, 2, [&](double u, double v) { return wall(turned(u, v)); })), io::GridView::unclear);
}

}  // namespace TEST_FILE
}  // namespace soapfilm
