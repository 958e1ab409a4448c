#include "soapfilm/fuse/vrip.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>

#include "soapfilm/core/random.h"
#include "soapfilm/error.h"
#include "soapfilm/extract/isosurface.h"
#include "soapfilm/io.h"
#include "soapfilm/mesh/topology.h"
#include "support/real_data.h"
#include "tools/mesh/distance.h"
#include "tools/scanner/shape.h"
#include "tools/scanner/virtual_scan.h"

namespace soapfilm {
namespace TEST_FILE {

constexpr double degree = std::numbers::pi / 180;

struct Fusion {
  FusedField field;
  VripReport report;
  Mesh mesh;
};

Fusion fuse(const PointCloud& cloud, const Lattice& lattice, const VripParams& params = {}, int threads = 2) {
  const Context context(threads);
  Fusion fusion;
  fusion.field = fuse_scans({cloud}, lattice, params, context, fusion.report);
  fusion.mesh =
      extract_open_isosurface(fusion.field.grid, fusion.field.distance, fusion.field.weight, 0, lattice, context);
  return fusion;
}

/// A sphere of radius 1/2 around the origin without noise, its raster as fine as the voxel.
ScannerParams scanner_of(int cells) {
  ScannerParams scanner;
  scanner.step = 1.0 / cells;
  scanner.rays = Rays::parallel;
  return scanner;
}

Lattice lattice_of(int cells) { return place_lattice(make_sphere()->box(), 1.0 / cells, 6); }

PointCloud scans_of_sphere(const ScannerParams& scanner) {
  return virtual_scan(*make_sphere(), scanner, Context(2)).cloud;
}

/// A plane as a scan sees it: square of side 2 `half` around the origin, sampled evenly along its own axes.
PointCloud scan_of_plane(Vec3d normal, double offset, int half, std::optional<Vec3d> sensor,
                         std::optional<Vec3d> view) {
  const Vec3d n = normalized(normal);
  const Vec3d a = normalized(cross(n, std::abs(n.x) < 0.9 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0}));
  const Vec3d b = cross(n, a);
  PointCloud cloud;
  RangeGrid grid{2 * half + 1, 2 * half + 1, {}};
  for (int row = -half; row <= half; ++row) {
    for (int column = -half; column <= half; ++column) {
      grid.sample.push_back(static_cast<int32_t>(cloud.size()));
      cloud.positions.push_back(n * offset + a * static_cast<double>(column) + b * static_cast<double>(row));
    }
  }
  cloud.scans.push_back({"plane", 0, cloud.size(), sensor, view, std::move(grid)});
  return cloud;
}

/// 64 vertices along each axis around the origin, one unit apart.
Lattice lattice_around_origin() { return place_lattice({{-26, -26, -26}, {26, 26, 26}}, 1, 6, 1); }

/// The ends of the edges that lie in one triangle.
std::vector<Vec3d> border(const Mesh& mesh) {
  std::map<std::pair<uint32_t, uint32_t>, int> triangles;
  for (const Triangle& t : mesh.triangles)
    for (size_t k = 0; k < 3; ++k) ++triangles[std::minmax(t[k], t[(k + 1) % 3])];
  std::vector<Vec3d> ends;
  for (const auto& [edge, count] : triangles)
    if (count == 1) ends.insert(ends.end(), {mesh.vertices[edge.first], mesh.vertices[edge.second]});
  return ends;
}

/// Visits (position, distance, weight) of every vertex that was seen.
template <class Visit>
void for_each_seen(const Fusion& fusion, const Lattice& lattice, Visit&& visit) {
  for (size_t b = 0; b < fusion.field.grid.size(); ++b) {
    for (int i = 0; i < brick_volume; ++i) {
      const float weight = fusion.field.weight.brick(b)[i];
      const Vec3i v = fusion.field.grid.first_vertex(b) + vertex_in_brick(i);
      if (weight > 0) visit(lattice.to_world(Vec3d(v)), static_cast<double>(fusion.field.distance.brick(b)[i]), weight);
    }
  }
}

double mean_error_of_sphere(int cells) {
  const Fusion fusion = fuse(scans_of_sphere(scanner_of(cells)), lattice_of(cells));
  EXPECT_TRUE(check_topology(fusion.mesh).watertight()) << summary(check_topology(fusion.mesh));
  double sum = 0;
  for (const Vec3d& v : fusion.mesh.vertices) sum += std::abs(norm(v) - 0.5);
  return sum / static_cast<double>(fusion.mesh.vertices.size());
}

// First order along the borders of scans, which are ever fewer vertices: where one scan ends the mean of distances
// along different lines of sight changes its slope.
TEST(Vrip, SphereSeenFromAllSidesIsClosedAndOfSecondOrderSlow) {
  double coarser = mean_error_of_sphere(16);
  EXPECT_LT(coarser, 0.05 / 16);  // a twentieth of a voxel
  for (const int cells : {32, 64}) {
    const double error = mean_error_of_sphere(cells);
    EXPECT_GT(coarser / error, 3) << cells;
    EXPECT_LT(coarser / error, 5) << cells;
    coarser = error;
  }
}

TEST(Vrip, SphereSeenFromOneSideIsOpenThere) {
  ScannerParams scanner = scanner_of(32);
  scanner.positions = {{3, 0, 0}};
  for (const Rays rays : {Rays::parallel, Rays::central}) {
    scanner.rays = rays;
    const Fusion fusion = fuse(scans_of_sphere(scanner), lattice_of(32));
    const TopologyReport report = check_topology(fusion.mesh);
    EXPECT_TRUE(report.manifold()) << summary(report);
    // Crumbs at the border may touch the rest in single points.
    const auto largest = std::max_element(report.components.begin(), report.components.end(),
                                          [](auto& a, auto& b) { return a.triangles < b.triangles; });
    EXPECT_GT(static_cast<double>(largest->triangles), 0.99 * static_cast<double>(report.triangles));
    // It ends within three samples of where parallel rays meet the sphere at 75 degrees, and has no hole inside.
    for (const Vec3d& v : border(fusion.mesh)) {
      EXPECT_NEAR(std::hypot(v.y, v.z), 0.5 * std::sin(75 * degree), 3.0 / 32);
    }
    EXPECT_GT(report.boundary_edges, 60u);
    EXPECT_EQ(report.unreferenced_vertices, 0u);
    for (const Triangle& t : fusion.mesh.triangles) {
      const Vec3d a = fusion.mesh.vertices[t[0]];
      EXPECT_GT(a.x, 0);
      EXPECT_NEAR(norm(a), 0.5, 0.25 / 32);
      EXPECT_GT(dot(cross(fusion.mesh.vertices[t[1]] - a, fusion.mesh.vertices[t[2]] - a), a), 0);  // outward
    }
  }
}

TEST(Vrip, PlaneSeenObliquelyIsExact) {
  const Vec3d normal = normalized(Vec3d{0.31, -0.23, 0.92});
  const Vec3d across = normalized(cross(normal, Vec3d{0, 1, 0}));
  const Lattice lattice = lattice_around_origin();
  for (const double angle_deg : {0.0, 30.0, 60.0, 74.0}) {
    const double cosine = std::cos(angle_deg * degree);
    const Vec3d view = normal * cosine + across * std::sin(angle_deg * degree);
    const Fusion parallel = fuse(scan_of_plane(normal, 0.37, 16, {}, view), lattice);
    EXPECT_EQ(parallel.report.scans, 1u);
    EXPECT_EQ(parallel.report.triangles, 2u * 32 * 32);
    EXPECT_EQ(parallel.report.dropped_triangles, 0u);
    EXPECT_GT(parallel.mesh.area(), 0.75 * 32 * 32);
    EXPECT_TRUE(check_topology(parallel.mesh).manifold());
    for_each_seen(parallel, lattice, [&](Vec3d x, double distance, float) {
      EXPECT_NEAR(distance, (0.37 - dot(x, normal)) / cosine, 1e-5);
    });
    // The extraction keeps surface points a thousandth of a voxel away from vertices.
    for (const Vec3d& v : parallel.mesh.vertices) ASSERT_NEAR(dot(v, normal), 0.37, 1e-3) << angle_deg;
    // Central rays differ a little from one vertex to the next, and so do distances along them.
    for (const double range : {60.0, 1e5}) {
      const Fusion central = fuse(scan_of_plane(normal, 0.37, 12, view * range, {}), lattice);
      for (const Vec3d& v : central.mesh.vertices) ASSERT_NEAR(dot(v, normal), 0.37, 1e-3 + 1 / range) << angle_deg;
    }
  }
}

TEST(Vrip, DistanceIsSignedAndAlongTheLineOfSight) {
  const Lattice lattice = lattice_around_origin();
  const Vec3d view = normalized(Vec3d{std::sqrt(3.0), 0, 1});  // 60 degrees
  const Fusion oblique = fuse(scan_of_plane({0, 0, 1}, 0, 16, {}, view), lattice);
  size_t seen = 0;
  for_each_seen(oblique, lattice, [&](Vec3d x, double distance, float weight) {
    EXPECT_NEAR(distance, -2 * x.z, 1e-5);  // behind is inside
    EXPECT_LE(weight, 0.5001f);             // the cosine
    EXPECT_GT(x.z, -2);                     // the ramp, at right angles to the surface
    EXPECT_LT(x.z, 6);
    ++seen;
  });
  EXPECT_EQ(seen, oblique.report.vertices_seen);
  EXPECT_NEAR(static_cast<double>(seen), 32 * 32 * 8, 0.1 * 32 * 32 * 8);

  const Vec3d sensor{0, 0, 40};
  const Fusion central = fuse(scan_of_plane({0, 0, 1}, 0, 16, sensor, {}), lattice);
  for_each_seen(central, lattice, [&](Vec3d x, double distance, float) {
    EXPECT_NEAR(distance, -x.z * norm(sensor - x) / (40 - x.z), 1e-5);
  });
}

TEST(Vrip, ScansAreAveragedByTheirWeights) {
  const Lattice lattice = lattice_around_origin();
  PointCloud low = scan_of_plane({0, 0, 1}, 0, 16, {}, Vec3d{0, 0, 1});
  PointCloud high = scan_of_plane({0, 0, 1}, 0.8, 16, {}, Vec3d{0, 0, 1});
  high.weights.assign(high.size(), 3);
  low.append(std::move(high));
  VripParams params;
  params.behind = 6;  // so that both count in full on the cells between them
  const Fusion fusion = fuse(low, lattice, params);
  for (const Vec3d& v : fusion.mesh.vertices) EXPECT_NEAR(v.z, 0.6, 1e-5);
  for_each_seen(fusion, lattice, [&](Vec3d x, double, float weight) {
    if (std::abs(x.x) > 10 || std::abs(x.y) > 10 || std::abs(x.z) > 2) return;
    EXPECT_NEAR(weight, 4, 1e-5);
  });
}

TEST(Vrip, AVertexSeesAScanOnce) {
  // Two sheets, one behind the other on the same lines of sight: the nearer one to the vertex counts, not both.
  const Lattice lattice = lattice_around_origin();
  PointCloud cloud = scan_of_plane({0, 0, 1}, 0, 16, {}, Vec3d{0, 0, 1});
  const PointCloud behind = scan_of_plane({0, 0, 1}, -2, 16, {}, Vec3d{0, 0, 1});
  const auto first = static_cast<int32_t>(cloud.size());
  cloud.positions.insert(cloud.positions.end(), behind.positions.begin(), behind.positions.end());
  cloud.scans[0].end = cloud.size();
  RangeGrid& grid = *cloud.scans[0].range_grid;
  grid.rows *= 2;
  for (const int32_t s : behind.scans[0].range_grid->sample) grid.sample.push_back(first + s);
  const Fusion fusion = fuse(cloud, lattice);
  EXPECT_EQ(fusion.report.triangles, 4u * 32 * 32);
  for_each_seen(fusion, lattice, [&](Vec3d x, double distance, float weight) {
    EXPECT_LE(weight, 1.00001f);
    EXPECT_NEAR(distance, x.z > -1 ? -x.z : -2 - x.z, 1e-5);
  });
}

TEST(Vrip, TheSameBytesForAnyNumberOfThreads) {
  ScannerParams scanner = scanner_of(24);
  scanner.rays = Rays::central;
  scanner.views = 5;
  scanner.noise = 0.01;
  scanner.drop_out = 0.05;
  const PointCloud cloud = scans_of_sphere(scanner);
  const Fusion one = fuse(cloud, lattice_of(24), {}, 1);
  EXPECT_TRUE(check_topology(one.mesh).manifold()) << summary(check_topology(one.mesh));
  for (const int threads : {2, 3, 8}) {
    const Fusion many = fuse(cloud, lattice_of(24), {}, threads);
    ASSERT_EQ(many.field.grid.size(), one.field.grid.size());
    for (size_t b = 0; b < one.field.grid.size(); ++b) {
      ASSERT_TRUE(std::equal(one.field.distance.brick(b), one.field.distance.brick(b) + brick_volume,
                             many.field.distance.brick(b)));
      ASSERT_TRUE(
          std::equal(one.field.weight.brick(b), one.field.weight.brick(b) + brick_volume, many.field.weight.brick(b)));
    }
    ASSERT_EQ(many.mesh.vertices, one.mesh.vertices);
    ASSERT_EQ(many.mesh.triangles, one.mesh.triangles);
  }
}

TEST(Vrip, GeoreferencedScansLoseNothing) {
  ScannerParams scanner = scanner_of(16);
  scanner.rays = Rays::central;
  scanner.noise = 0.01;  // no ties between diagonals, which rounding would break either way
  PointCloud cloud = scans_of_sphere(scanner);
  Lattice lattice = lattice_of(16);
  const Mesh near = fuse(cloud, lattice).mesh;
  const Vec3d far{4e6, -5e6, 3e6};
  for (Vec3d& p : cloud.positions) p += far;
  for (Scan& scan : cloud.scans) *scan.sensor += far;
  lattice.first_vertex += far;
  const Mesh mesh = fuse(cloud, lattice).mesh;
  ASSERT_EQ(mesh.triangles, near.triangles);
  for (size_t i = 0; i < mesh.vertices.size(); ++i) ASSERT_LT(norm(mesh.vertices[i] - far - near.vertices[i]), 1e-6);
}

/// Scans along other axes of the world on a lattice that takes them back: the same, turned.
TEST(Vrip, TurnedAxesTurnTheMeshExactly) {
  for (const Rays rays : {Rays::parallel, Rays::central}) {
    ScannerParams scanner = scanner_of(16);
    scanner.rays = rays;
    scanner.noise = 0.01;
    const PointCloud cloud = scans_of_sphere(scanner);
    const Mesh mesh = fuse(cloud, lattice_of(16)).mesh;
    for (const int turn : {1, 2}) {
      Lattice lattice = lattice_of(16);
      lattice.axis_shift = turn;
      lattice.first_vertex = lattice.to_world_axes(lattice.first_vertex);
      PointCloud other = cloud;
      for (Vec3d& p : other.positions) p = lattice.to_world_axes(p);
      for (Scan& scan : other.scans) {
        if (scan.sensor) scan.sensor = lattice.to_world_axes(*scan.sensor);
        if (scan.view_direction) scan.view_direction = lattice.to_world_axes(*scan.view_direction);
      }
      const Mesh turned = fuse(other, lattice).mesh;
      ASSERT_EQ(turned.triangles, mesh.triangles);
      for (size_t i = 0; i < mesh.vertices.size(); ++i)
        ASSERT_LT(norm(lattice.from_world_axes(turned.vertices[i]) - mesh.vertices[i]), 1e-9);
    }
  }
}

TEST(Vrip, DroppedSamplesAreHolesInTheRangeGrid) {
  PointCloud cloud = scans_of_sphere(scanner_of(16));
  Random random(7);
  std::vector<bool> keep(cloud.size());
  for (size_t i = 0; i < keep.size(); ++i) keep[i] = random.uniform() < 0.9;
  PointCloud holes = cloud;
  for (Scan& scan : holes.scans)
    for (int32_t& s : scan.range_grid->sample)
      if (s >= 0 && !keep[scan.begin + static_cast<size_t>(s)]) s = -1;
  cloud.filter(keep);
  const Mesh a = fuse(cloud, lattice_of(16)).mesh;
  const Mesh b = fuse(holes, lattice_of(16)).mesh;
  EXPECT_EQ(a.vertices, b.vertices);
  EXPECT_EQ(a.triangles, b.triangles);
  EXPECT_GT(a.triangles.size(), 1000u);
}

template <class Change>
std::string refusal(Change&& change) {
  PointCloud cloud = scan_of_plane({0, 0, 1}, 0, 4, {}, Vec3d{0, 0, 1});
  VripParams params;
  Lattice lattice = lattice_around_origin();
  change(cloud, params, lattice);
  try {
    fuse(cloud, lattice, params);
  } catch (const ParameterError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(Vrip, RefusesWhatItCannotFuse) {
  EXPECT_EQ(refusal([](auto&, auto&, auto&) {}), "accepted");
  EXPECT_EQ(refusal([](auto& cloud, auto&, auto&) { cloud.scans.clear(); }),
            "vrip needs range scans: the cloud has none");
  EXPECT_EQ(refusal([](auto& cloud, auto&, auto&) { cloud.scans[0].range_grid.reset(); }),
            "vrip needs range scans: scan \"plane\" has no range grid");
  EXPECT_EQ(refusal([](auto& cloud, auto&, auto&) { cloud.scans[0].view_direction.reset(); }),
            "vrip needs range scans: scan \"plane\" has no sensor position and no viewing direction");
  EXPECT_EQ(refusal([](auto& cloud, auto&, auto&) { cloud.positions[3].y = std::nan(""); }),
            "sample 3: position is not finite");
  EXPECT_EQ(refusal([](auto&, auto& params, auto&) { params.front = 0; }), "front = 0, must be > 0 and <= 1000 voxels");
  EXPECT_EQ(refusal([](auto&, auto& params, auto&) { params.behind = -1; }),
            "behind = -1, must be > 0 and <= 1000 voxels");
  EXPECT_EQ(refusal([](auto&, auto& params, auto&) { params.surface.taper = -2; }), "taper = -2, must be >= 0 samples");
  EXPECT_EQ(refusal([](auto&, auto&, Lattice& lattice) { lattice.first_vertex.z = 1e4; }),
            "vrip: the 1 scan give 128 triangles and 0 dropped ones, none near the grid");
}

TEST(Vrip, BunnyIsTheZipperedOneSlow) {
  const auto scans = real_data("bunny/bun.conf"), zipper = real_data("bunny/bun_zipper.ply");
  if (!scans || !zipper) GTEST_SKIP() << "no bunny in SOAPFILM_DATA";
  const PointCloud cloud = read_points(*scans);
  const Lattice lattice = place_lattice(cloud.box(), voxel_of_resolution(cloud.box(), 128, 6), 6);
  const Fusion fusion = fuse(cloud, lattice);
  const TopologyReport report = check_topology(fusion.mesh);
  EXPECT_TRUE(report.manifold()) << summary(report);
  EXPECT_GT(report.boundary_edges, 0u);  // its base was hardly seen
  const PointCloud zippered = read_points(*zipper);
  const DistanceSummary distance = point_to_mesh_distance(zippered.positions, fusion.mesh, Context(2));
  EXPECT_LT(distance.mean, 0.1 * lattice.voxel);
  EXPECT_LT(distance.percentile95, 0.3 * lattice.voxel);
}

}  // namespace TEST_FILE
}  // namespace soapfilm
