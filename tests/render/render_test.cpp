#include "tools/render/render.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "soapfilm/error.h"
#include "tools/render/colormap.h"

namespace soapfilm {
namespace TEST_FILE {

const Vec3d far_corner{5e6, -5e6, 5e6};

/// A ball of latitudes and longitudes, counter-clockwise seen from outside.
Mesh ball(double radius, Vec3d center = {}, uint32_t rows = 60, uint32_t columns = 120) {
  Mesh mesh;
  for (uint32_t i = 0; i <= rows; ++i) {
    for (uint32_t j = 0; j < columns; ++j) {
      const double theta = std::numbers::pi * i / rows;
      const double phi = 2 * std::numbers::pi * j / columns;
      mesh.vertices.push_back(
          center + radius * Vec3d{std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)});
      const auto at = [&](uint32_t r, uint32_t c) { return r * columns + c % columns; };
      if (i == rows) continue;
      mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  return mesh;
}

Mesh square(double side, double z = 0) {
  Mesh mesh;
  mesh.vertices = {{0, 0, z}, {side, 0, z}, {side, side, z}, {0, side, z}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}

RenderParams quick(int size = 100) {
  RenderParams params;
  params.width = size;
  params.height = size;
  params.samples = 2;
  params.occlusion_rays = 0;
  params.background = std::nullopt;
  return params;
}

Image draw(const Mesh& mesh, const RenderParams& params, int threads = 1) {
  return render({{&mesh, ""}}, params, Context(threads));
}

/// Pixels covered by the item, antialiased ones in part; the background must be transparent.
double covered(const Image& image) {
  double sum = 0;
  for (const Rgba8& p : image.pixels) sum += p[3] / 255.0;
  return sum;
}

bool is_reddish(const Rgba8& p) { return p[3] > 0 && p[0] > 2 * p[1]; }

TEST(Render, SilhouetteOfABallHasTheAreaOfItsDisc) {
  const double radius_in_pixels = 200 * (1 - 2 * 0.04) / 2;
  const double disc = std::numbers::pi * radius_in_pixels * radius_in_pixels;
  for (const Vec3d from : {Vec3d{0, 0, 1}, Vec3d{1, 2, -0.5}, Vec3d{0, 1, 0}}) {
    RenderParams params = quick(200);
    params.from = from;
    EXPECT_NEAR(covered(draw(ball(3), params)) / disc, 1, 0.01);
  }
}

TEST(Render, GeoreferencedMeshesLoseNothing) {
  RenderParams params = quick(200);
  const double here = covered(draw(ball(1e-3), params));
  EXPECT_NEAR(covered(draw(ball(1e-3, far_corner), params)) / here, 1, 1e-3);
}

TEST(Render, TheSameBytesForAnyNumberOfThreads) {
  const Mesh mesh = ball(1);
  RenderParams params = quick(90);
  params.occlusion_rays = 5;
  params.shading = Shading::smooth;
  const Image one = draw(mesh, params, 1);
  for (const int threads : {2, 3, 8}) EXPECT_EQ(draw(mesh, params, threads).pixels, one.pixels);
}

TEST(Render, TheInsideOfASurfaceIsDrawnInTheBackColor) {
  Mesh mesh = square(1);
  const RenderParams params = quick(40);
  EXPECT_FALSE(is_reddish(draw(mesh, params).at(20, 20)));
  for (Triangle& t : mesh.triangles) std::swap(t[1], t[2]);
  EXPECT_TRUE(is_reddish(draw(mesh, params).at(20, 20)));
}

TEST(Render, AHoleShowsTheInside) {
  Mesh mesh = ball(1);
  mesh.triangles.erase(std::remove_if(mesh.triangles.begin(), mesh.triangles.end(),
                                      [&](const Triangle& t) { return mesh.vertices[t[0]].z > 0.95; }),
                       mesh.triangles.end());
  const Image image = draw(mesh, quick(100));
  EXPECT_TRUE(is_reddish(image.at(50, 50)));
  EXPECT_FALSE(is_reddish(image.at(50, 80)));
}

TEST(Render, OcclusionDarkensAnInnerCorner) {
  Mesh mesh = square(1);
  const Mesh wall = square(1);
  for (const Vec3d& v : wall.vertices) mesh.vertices.push_back({v.y, 1, v.x});  // upright along the square's far side
  mesh.triangles.push_back({4, 5, 6});
  mesh.triangles.push_back({4, 6, 7});
  RenderParams params = quick(60);
  params.samples = 4;
  const int open = draw(mesh, params).at(30, 5)[1];
  params.occlusion_rays = 20;
  const Image image = draw(mesh, params);
  EXPECT_LT(image.at(30, 5)[1], open - 10);
  EXPECT_GT(image.at(30, 55)[1], image.at(30, 5)[1] + 10);
}

TEST(Render, ZoomShowsTheNamedPartEnlarged) {
  Mesh mesh = square(1);
  RenderParams params = quick(100);
  const double whole = covered(draw(mesh, params));
  params.zoom = {0.25, 0.25, 0.75, 0.75};
  EXPECT_NEAR(covered(draw(mesh, params)), 10000, 1);
  params.zoom = {-0.5, -0.5, 1.5, 1.5};
  EXPECT_NEAR(covered(draw(mesh, params)) / whole, 0.25, 0.01);
  params.zoom = {0, 0, 0.5, 0.5};  // upper left quarter: the square's corner and the margin
  const Image corner = draw(mesh, params);
  EXPECT_EQ(corner.at(2, 2)[3], 0);
  EXPECT_EQ(corner.at(97, 97)[3], 255);
}

TEST(Render, ViewsHaveTheirRightAndUp) {
  const Vec3d y{0, 1, 0};
  const Vec3d z{0, 0, 1};
  EXPECT_EQ(view_direction("front", y), (Vec3d{0, 0, 1}));
  EXPECT_EQ(view_direction("right", y), (Vec3d{1, 0, 0}));
  EXPECT_EQ(view_direction("front", z), (Vec3d{0, -1, 0}));
  EXPECT_EQ(view_direction("right", z), (Vec3d{1, 0, 0}));
  for (const Vec3d up : {y, z, Vec3d{1, 0, 0}, Vec3d{0, -1, 0}, Vec3d{1, 2, 3}}) {
    for (const char* name : {"front", "back", "left", "right", "top", "bottom", "iso"}) {
      const ViewFrame f = view_frame(view_direction(name, up), up);
      EXPECT_NEAR(dot(cross(f.right, f.up), f.towards_viewer), 1, 1e-12) << name;
      EXPECT_GE(dot(f.up, up), -1e-12) << name;
    }
  }
  const ViewFrame top = view_frame(view_direction("top", y), y);
  EXPECT_NEAR(norm(top.up - Vec3d{0, 0, -1}), 0, 1e-12);  // the front at the bottom of the picture
  EXPECT_NEAR(norm(top.right - Vec3d{1, 0, 0}), 0, 1e-12);
}

TEST(Render, PanelsShareOneScaleUnlessFitted) {
  const Mesh small = ball(1);
  const Mesh large = ball(2, {10, 0, 0});
  RenderParams params = quick(100);
  const auto coverage = [&](Framing framing) {
    params.framing = framing;
    const Image image = render({{&small, ""}, {&large, ""}}, params, Context(1));
    EXPECT_EQ(image.width, 200);
    double left = 0, right = 0;
    for (int y = 0; y < 100; ++y) {
      for (int x = 0; x < 100; ++x) {
        left += image.at(x, y)[3];
        right += image.at(100 + x, y)[3];
      }
    }
    return right / left;
  };
  EXPECT_NEAR(coverage(Framing::shared), 4, 0.3);
  EXPECT_NEAR(coverage(Framing::centered), 4, 0.1);
  EXPECT_NEAR(coverage(Framing::fitted), 1, 0.01);
}

TEST(Render, PanelsAreLaidOutInRowsWithCaptionsAndLegend) {
  Mesh mesh = square(1);
  mesh.attributes = {{"height", {0, 1, 2, 3}}};
  std::vector<RenderItem> items(5, {&mesh, ""});
  RenderParams params = quick(64);
  Image image = render(items, params, Context(1));
  EXPECT_EQ(image.width, 3 * 64);
  EXPECT_EQ(image.height, 2 * 64);
  params.columns = 2;
  items[4].caption = "last";
  params.color_by = "height";
  image = render(items, params, Context(1));
  EXPECT_EQ(image.width, 2 * 64);
  EXPECT_GT(image.height, 3 * 64);
}

TEST(Render, CaptionsLeaveInkBelowTheirPanel) {
  const Mesh mesh = square(1);
  const Image with = render({{&mesh, "Soapfilm 512"}, {&mesh, ""}}, quick(100), Context(1));
  const auto ink = [&](int x0) {
    double sum = 0;
    for (int y = 100; y < with.height; ++y) {
      for (int x = x0; x < x0 + 100; ++x) sum += with.at(x, y)[3] / 255.0;
    }
    return sum;
  };
  EXPECT_GT(ink(0), 50);
  EXPECT_EQ(ink(100), 0);
}

TEST(Render, AttributesAreColoredByTheMap) {
  Mesh mesh = square(1);
  mesh.attributes = {{"error", {0, 0, 0, 0}}};
  RenderParams params = quick(40);
  params.color_by = "error";
  params.range = {0, 1};
  const Rgba8 low = draw(mesh, params).at(20, 20);
  mesh.attributes[0].values = {1, 1, 1, 1};
  const Rgba8 high = draw(mesh, params).at(20, 20);
  EXPECT_GT(low[2], low[1]);    // violet
  EXPECT_GT(high[1], high[2]);  // yellow
  EXPECT_GT(high[1], low[1] + 50);
}

TEST(Render, VertexColorsAreUsed) {
  Mesh mesh = square(1);
  mesh.colors.assign(4, {0, 200, 0});
  const Rgba8 p = draw(mesh, quick(40)).at(20, 20);
  EXPECT_GT(p[1], 2 * p[0]);
}

TEST(Render, PointsCloseIntoASurface) {
  PointCloud cloud;
  for (int i = 0; i < 100; ++i) {
    for (int j = 0; j < 100; ++j) cloud.positions.push_back({0.1 * i, 0.1 * j, 0});
  }
  RenderParams params = quick(100);
  const double expected = 100.0 * 100 * 0.92 * 0.92;
  EXPECT_NEAR(covered(render({{&cloud, ""}}, params, Context(1))) / expected, 1, 0.06);
  cloud.normals.assign(cloud.size(), {0, 0, -1});  // turned away
  const Image image = render({{&cloud, ""}}, params, Context(1));
  EXPECT_NEAR(covered(image) / expected, 1, 0.06);
  EXPECT_TRUE(is_reddish(image.at(50, 50)));
}

TEST(Render, OneSampleAndCoincidentSamplesAreDrawn) {
  PointCloud cloud;
  cloud.positions.assign(1, {1, 2, 3});
  EXPECT_GT(covered(render({{&cloud, ""}}, quick(40), Context(1))), 0);
  cloud.positions.assign(9, {1, 2, 3});
  EXPECT_GT(covered(render({{&cloud, ""}}, quick(40), Context(1))), 0);
}

TEST(Render, ScansHaveDifferentColors) {
  PointCloud cloud;
  cloud.positions = {{0, 0, 0}, {1, 0, 0}};
  cloud.scans.resize(2);
  cloud.scans[0].end = 1;
  cloud.scans[1].begin = 1;
  cloud.scans[1].end = 2;
  RenderParams params = quick(100);
  params.point_radius = 0.2;
  const Image image = render({{&cloud, ""}}, params, Context(1));
  EXPECT_NE(image.at(8, 50), image.at(92, 50));
}

TEST(Render, MapRisesInLightness) {
  double before = -1;
  for (int i = 0; i <= 50; ++i) {
    const Vec3f c = to_linear(map_color(i / 50.0));
    const double luminance = 0.2126 * c.x + 0.7152 * c.y + 0.0722 * c.z;
    EXPECT_GT(luminance, before);
    before = luminance;
  }
  EXPECT_EQ(map_color(-3), map_color(0));
  EXPECT_EQ(map_color(7), map_color(1));
}

TEST(Render, Refusals) {
  const Mesh good = square(1);
  const auto refuses = [&](auto&& change) {
    RenderParams params = quick(32);
    change(params);
    EXPECT_THROW(draw(good, params), ParameterError);
  };
  refuses([](RenderParams& p) { p.width = 3; });
  refuses([](RenderParams& p) { p.samples = 0; });
  refuses([](RenderParams& p) { p.samples = 17; });
  refuses([](RenderParams& p) { p.occlusion_rays = -1; });
  refuses([](RenderParams& p) { p.from = {}; });
  refuses([](RenderParams& p) { p.up = {0, std::nan(""), 1}; });
  refuses([](RenderParams& p) { p.zoom = {0.5, 0, 0.5, 1}; });
  refuses([](RenderParams& p) { p.range = {1, 1}; });
  refuses([](RenderParams& p) { p.point_radius = -1; });
  refuses([](RenderParams& p) { p.color_by = "no such attribute"; });
  EXPECT_THROW(view_direction("behind", {0, 1, 0}), ParameterError);
  EXPECT_THROW(render({}, quick(), Context(1)), ParameterError);
  EXPECT_THROW(draw(Mesh{}, quick()), ParameterError);
  Mesh bad = good;
  bad.triangles[0][1] = 4;
  EXPECT_THROW(draw(bad, quick()), ParameterError);
  bad = good;
  bad.vertices[3].x = std::numeric_limits<double>::infinity();
  EXPECT_THROW(draw(bad, quick()), ParameterError);
  PointCloud empty;
  EXPECT_THROW(render({{&empty, ""}}, quick(), Context(1)), ParameterError);
}

}  // namespace TEST_FILE
}  // namespace soapfilm
