// soapfilm reconstruct --outside: what lies beyond the samples' box.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

#include "cli/reconstruct_runs.h"
#include "soapfilm/core/random.h"
#include "soapfilm/io.h"
#include "soapfilm/mesh/topology.h"
#include "support/sanitized.h"
#include "tools/scanner/mesh_surface.h"
#include "tools/scanner/sample_surface.h"
#include "tools/scanner/scene.h"
#include "tools/scanner/shape.h"

namespace soapfilm::test {
namespace TEST_FILE {

using nlohmann::json;

class Outside : public ReconstructRuns {
 protected:
  static constexpr size_t samples = 4000;

  /// Samples of a sphere, or of the part above a fraction of its height; seen from within or from outside.
  std::string sphere(bool from_within, double above = 0) const {
    PointCloud all = sample_surface(*make_sphere(), samples, 1);
    const Box3d box = all.box();
    std::vector<bool> keep(all.size());
    for (size_t i = 0; i < keep.size(); ++i) keep[i] = all.positions[i].z >= box.lo.z + above * box.size().z;
    all.filter(keep);
    if (from_within)
      for (Vec3f& n : all.normals) n = -n;
    const std::string file = folder.file("cloud.ply");
    write_points(file, all);
    return file;
  }
  Mesh written() const { return read_mesh(mesh); }

  static double sheet_height(double x, double y) { return 0.15 * std::sin(4 * x) * std::cos(3 * y); }

  /// side^2 samples of a wavy sheet over a square of side 2, seen from above. Returns its area.
  static double write_sheet(const std::string& file, int side) {
    PointCloud sheet;
    double area = 0;
    for (int i = 0; i < side * side; ++i) {
      const double x = 2.0 * (i % side) / (side - 1) - 1, y = 2.0 * (i / side) / (side - 1) - 1;
      const Vec3d up{-0.6 * std::cos(4 * x) * std::cos(3 * y), 0.45 * std::sin(4 * x) * std::sin(3 * y), 1};
      sheet.positions.push_back({x, y, sheet_height(x, y)});
      sheet.normals.push_back(static_cast<Vec3f>(normalized(up)));
      area += norm(up) * 4 / (side * side);
    }
    write_points(file, sheet);
    return area;
  }
};

TEST_F(Outside, AirIsWhatAClosedObjectHas) {
  const std::string cloud = sphere(false);
  const json chosen = reported({cloud, "--resolution", "48"});
  const std::string bytes = read_file(mesh);
  EXPECT_EQ(chosen["border"]["outside"], "air");
  EXPECT_FALSE(chosen["border"]["reason"].get<std::string>().empty());
  const json asked = reported({cloud, "--resolution", "48", "--outside", "air"});
  EXPECT_EQ(asked["parameters"]["border"]["outside"], "air");
  EXPECT_EQ(read_file(mesh), bytes);
}

/// The same surface as that of the object, with reversed triangles.
TEST_F(Outside, ARoomSeenFromWithinIsItsComplementTurned) {
  reported({sphere(false), "--resolution", "48", "--outside", "air"});
  const double volume = written().volume();
  const json room = reported({sphere(true), "--resolution", "48", "--outside", "solid"});
  EXPECT_EQ(room["border"]["turned"], false);
  EXPECT_EQ(room["mesh"]["closed"], true);
  EXPECT_EQ(room["mesh"]["components"], 1);
  EXPECT_GT(volume, 0);
  EXPECT_NEAR(written().volume(), -volume, 1e-9 * volume);
}

TEST_F(Outside, AnOpenSurfaceEndsAndIsProved) {
  const std::string bowl = sphere(false, 0.75);
  const json open = reported({bowl, "--resolution", "48", "--outside", "open"});
  const double open_area = written().area();
  EXPECT_EQ(open["mesh"]["closed"], false);
  EXPECT_EQ(open["mesh"]["manifold"], true);
  EXPECT_EQ(open["mesh"]["components"], 1);
  EXPECT_LT(open["certificate"]["relative_gap_binary"].get<double>(), 0.05);
  const json closed = reported({bowl, "--resolution", "48", "--outside", "air"});
  EXPECT_EQ(closed["mesh"]["closed"], true);
  EXPECT_LT(open["certificate"]["primal_binary"].get<double>(), closed["certificate"]["primal_binary"].get<double>());
  EXPECT_LT(open_area, written().area());
}

TEST_F(Outside, WhatNoSampleIsNearIsTrimmedOfOpenSurfacesByDefault) {
  const std::string bowl = sphere(false, 0.75);
  const json by_default = reported({bowl, "--resolution", "48", "--outside", "open"});
  const std::string bytes = read_file(mesh);
  const double area = written().area();
  ASSERT_FALSE(by_default["surface"]["trim"].is_null());
  EXPECT_GT(by_default["surface"]["trim"]["removed"], 0);
  EXPECT_EQ(by_default["mesh"]["manifold"], true);
  reported({bowl, "--resolution", "48", "--outside", "open", "--trim", "auto", "--threads", "1"});
  EXPECT_EQ(read_file(mesh), bytes);
  const json off = reported({bowl, "--resolution", "48", "--outside", "open", "--trim", "off"});
  EXPECT_TRUE(off["surface"]["trim"].is_null());
  EXPECT_GT(written().area(), area);
  // With a closed surface also the lid, on request.
  const json closed = reported({bowl, "--resolution", "48", "--outside", "air"});
  EXPECT_TRUE(closed["surface"]["trim"].is_null());
  const double closed_area = written().area();
  const json lid = reported({bowl, "--resolution", "48", "--outside", "air", "--trim", "0.05"});
  EXPECT_EQ(lid["surface"]["trim"]["distance"], 0.05);
  EXPECT_EQ(lid["mesh"]["closed"], false);
  EXPECT_LT(written().area(), closed_area);
}

/// Bare points do not show a side: with solid matter beyond, they are assumed to be seen from within.
TEST_F(Outside, SolidMatterTurnsTheGuessAtBarePoints) {
  PointCloud bare = sample_surface(*make_sphere(), samples, 1);
  bare.normals.clear();
  const std::string cloud = folder.file("bare.ply");
  write_points(cloud, bare);
  reported({cloud, "--resolution", "48"});
  const double volume = written().volume();
  const json room = reported({cloud, "--resolution", "48", "--outside", "solid"});
  EXPECT_EQ(room["mesh"]["components"], 1);
  EXPECT_GT(volume, 0);
  EXPECT_NEAR(written().volume(), -volume, 1e-9 * volume);
}

/// As if its normals were right, but for one warning.
TEST_F(Outside, ReversedNormalsOfABodyAreTurnedOver) {
  for (const char* shape : sanitized ? std::vector{"torus"} : std::vector{"torus", "knot", "arch"}) {
    PointCloud body = sample_surface(*make_shape(shape), 3 * samples, 1);
    const std::string cloud = folder.file("body.ply");
    write_points(cloud, body);
    ASSERT_EQ(reported({cloud, "--resolution", "64"})["border"]["turned"], false) << shape;
    const double volume = written().volume();
    for (Vec3f& n : body.normals) n = -n;
    write_points(cloud, body);
    const json turned = reported({cloud, "--resolution", "64"});
    EXPECT_EQ(turned["border"]["outside"], "air") << shape;
    EXPECT_EQ(turned["border"]["turned"], true) << shape;
    EXPECT_NE(turned["warnings"].dump().find("all are turned over"), std::string::npos) << shape;
    EXPECT_NE(turned["warnings"].dump().find("--outside solid"), std::string::npos) << shape;
    EXPECT_NEAR(written().volume(), volume, 1e-4 * volume) << shape;
  }
}

/// Its walls show a furnished room, in any pose; so does a scanner in a hollow ball.
TEST_F(Outside, WhatIsARoomStaysOne) {
  PointCloud room = sample_surface(MeshSurface(make_room().mesh, Context(1), Faces::as_given), 5 * samples, 1);
  const std::string cloud = folder.file("room.ply");
  for (const double angle : sanitized ? std::vector{0.6} : std::vector{0.0, 0.6}) {
    PointCloud turned = room;
    const auto turn = [&](auto v) {
      const Vec3d p(v);
      return Vec3d{std::cos(angle) * p.x - std::sin(angle) * p.y, std::sin(angle) * p.x + std::cos(angle) * p.y, p.z};
    };
    for (Vec3d& p : turned.positions) p = turn(p);
    for (Vec3f& n : turned.normals) n = static_cast<Vec3f>(turn(n));
    write_points(cloud, turned);
    const json report = reported({cloud, "--resolution", "64"});
    EXPECT_EQ(report["border"]["outside"], "solid") << angle;
    EXPECT_EQ(report["border"]["turned"], false) << angle;
    EXPECT_LT(written().volume(), 0) << angle;
  }
  EXPECT_EQ(reported({sphere(true), "--resolution", "48"})["border"]["turned"], true);
  const json seen = reported({sphere(true), "--resolution", "48", "--sensor", "0,0,0"});
  EXPECT_EQ(seen["border"]["outside"], "solid");
  EXPECT_LT(written().volume(), 0);
}

TEST_F(Outside, InwardNormalsAreWarnedOfUnlessSolidMatterIsBeyond) {
  const std::string inward = sphere(true);
  const auto warned = [&](const std::vector<std::string>& words) {
    std::vector<std::string> all = {inward, "--resolution", "48"};
    all.insert(all.end(), words.begin(), words.end());
    return reported(all)["warnings"].dump().find("most normals point towards the middle of the samples") !=
           std::string::npos;
  };
  EXPECT_FALSE(warned({}));
  EXPECT_FALSE(warned({"--outside", "solid"}));
  EXPECT_TRUE(warned({"--outside", "air"}));
  EXPECT_TRUE(warned({"--method", "graph-cut-6"}));
}

TEST_F(Outside, LevelsOfAnOpenSurfaceAreWritten) {
  const std::string bowl = sphere(false, 0.75);
  const std::string levels = folder.file("levels");
  const json open = reported({bowl, "--resolution", "64", "--outside", "open", "--write-levels", levels});
  const std::string bytes = read_file(mesh);
  const double area = written().area();
  for (const char* level : {"level_0.ply", "level_1.ply"}) {
    const Mesh drawn = read_mesh(levels + "/" + level);
    EXPECT_FALSE(drawn.triangles.empty()) << level;
    EXPECT_GT(drawn.area(), area) << level << ": unsmoothed, and not trimmed";
  }
  reported({bowl, "--resolution", "64", "--outside", "open"});
  EXPECT_EQ(read_file(mesh), bytes);
}

/// Not a vertex of the mesh closes it along the box, whatever is trimmed; its border lies on the box's sides.
TEST_F(Outside, AnOpenSheetEndsAtTheBox) {
  const std::string cloud = folder.file("sheet.ply");
  const double area = write_sheet(cloud, 80);
  for (const char* refine : {"on", "off"}) {
    const json open = reported({cloud, "--resolution", "72", "--outside", "open", "--trim", "off", "--refine", refine});
    ASSERT_FALSE(open.is_null()) << refine;
    const Mesh sheet = written();
    EXPECT_EQ(open["mesh"]["manifold"], true) << refine;
    EXPECT_EQ(open["mesh"]["components"], 1) << refine;
    EXPECT_EQ(open["mesh"]["closed"], false) << refine;
    EXPECT_GT(sheet.area(), area) << refine;
    const double voxel = open["grid"]["voxel"], side = 2 + 2 * 16 * voxel;  // to the ends of cells of level 3
    EXPECT_LT(sheet.area(), area / 4 * side * side) << refine;
  }
}

/// Half of the box is inside, so bricks that only the border divides lie on different sides.
TEST_F(Outside, LevelsOfAnOpenSheetEndAtTheirBox) {
  const std::string cloud = folder.file("sheet.ply"), levels = folder.file("levels");
  const double area = write_sheet(cloud, 80);
  const json open = reported({cloud, "--resolution", "72", "--outside", "open", "--write-levels", levels});
  ASSERT_FALSE(open.is_null());
  const double voxel = open["grid"]["voxel"];
  for (int level = 0; level < 3; ++level) {
    const Mesh drawn = read_mesh(levels + "/level_" + std::to_string(level) + ".ply");
    const double cell = voxel * (1 << level);
    ASSERT_FALSE(drawn.triangles.empty()) << level;
    const TopologyReport topology = check_topology(drawn);
    EXPECT_TRUE(topology.manifold()) << level;
    EXPECT_FALSE(topology.closed()) << level;
    EXPECT_EQ(topology.components.size(), 1u) << level;
    // Steps of whole cells have at most sqrt(3) times the area; a lid along the box would be as large as the sheet.
    EXPECT_LT(drawn.area(), 1.75 * area) << level;
    for (const Vec3d& v : drawn.vertices) ASSERT_NEAR(v.z, sheet_height(v.x, v.y), 2 * cell) << level;
  }
}

TEST_F(Outside, NeighborsAndRadiusReachTheEstimate) {
  PointCloud bare = sample_surface(*make_sphere(), samples, 1);
  bare.normals.clear();
  const std::string cloud = folder.file("bare.ply");
  write_points(cloud, bare);
  refused({cloud, "--neighbors", "2"}, "neighbors = 2, must be in [3, 1000]");
  refused({cloud, "--radius", "0"}, "radius = 0, must be > 0");
  const json told =
      reported({cloud, "--resolution", "48", "--directions", "estimate", "--neighbors", "24", "--radius", "0.2"});
  EXPECT_EQ(told["parameters"]["orient"]["neighbors"], 24);
  EXPECT_EQ(told["parameters"]["orient"]["radius"], 0.2);
  const std::string bytes = read_file(mesh);
  const json plain = reported({cloud, "--resolution", "48", "--directions", "estimate"});
  EXPECT_TRUE(plain["parameters"]["orient"]["radius"].is_null());
  EXPECT_NE(read_file(mesh), bytes);
}

TEST_F(Outside, DistancesToSamplesAreWrittenOnRequest) {
  const std::string bowl = sphere(false, 0.75);
  reported({bowl, "--resolution", "48"});
  EXPECT_TRUE(written().attributes.empty());
  const json report = reported({bowl, "--resolution", "48", "--outside", "air", "--distance"});
  EXPECT_EQ(report["parameters"]["surface"]["distance"], true);
  const Mesh with = written();
  ASSERT_EQ(with.attributes.size(), 1u);
  EXPECT_EQ(with.attributes[0].name, "distance");
  // The lid's middle is farthest, not its edge at the bowl's rim.
  const auto farthest = std::max_element(with.attributes[0].values.begin(), with.attributes[0].values.end());
  const Vec3d at = with.vertices[static_cast<size_t>(farthest - with.attributes[0].values.begin())];
  EXPECT_LT(std::hypot(at.x, at.y), 0.1);
  EXPECT_GT(*farthest, 0.2);
  EXPECT_LT(*farthest, 0.45);  // that is the distance at the rim
}

TEST_F(Outside, TheGapIsWrittenOnRequest) {
  const json report = reported({sphere(false), "--resolution", "48", "--gap"});
  EXPECT_EQ(report["parameters"]["surface"]["gap"], true);
  const Mesh with = written();
  ASSERT_EQ(with.attributes.size(), 1u);
  EXPECT_EQ(with.attributes[0].name, "gap");
  // Its mean is about that of the certificate (a tent sees less of the terms that are not in its middle).
  double sum = 0;
  for (const float gap : with.attributes[0].values) {
    ASSERT_GE(gap, 0);
    sum += double{gap};
  }
  const double mean = sum / static_cast<double>(with.vertices.size());
  const double certified = report["certificate"]["gap_per_area_binary"];
  EXPECT_GT(mean, 0.5 * certified);
  EXPECT_LT(mean, 1.5 * certified);
}

TEST_F(Outside, BadDistancesToTrimAreRefused) {
  const std::string cloud = sphere(false);
  refused({cloud, "--trim", "-1"}, "trim = -1");
  refused({cloud, "--trim", "much"}, "trim = much");
  refused({cloud, "--trim", "off", "--trim-holes"}, "trim_holes");
  refused({cloud, "--trim", "1", "--method", "vrip"}, "method vrip");
}

TEST_F(Outside, LostSamplesAreWarnedOfAndSetTheExitCodeOfStrictRuns) {
  const std::string cloud = sphere(false);
  const json good = reported({cloud, "--resolution", "48", "--strict"});
  EXPECT_EQ(good["self_check"]["lost"], 0);
  EXPECT_EQ(good["warnings"].size(), 0u);
  // One sample in ten far from the sphere, at distances that form no surface.
  PointCloud with = sample_surface(*make_sphere(), samples, 1);
  for (size_t i = 0; i < with.size(); i += 10)
    with.positions[i] = with.positions[i] * (1.6 + 0.1 * static_cast<double>(i / 10 % 7));
  const std::string bad = folder.file("bad.ply");
  write_points(bad, with);
  const json lost = reported({bad, "--resolution", "48"});
  EXPECT_GT(lost["self_check"]["lost"].get<double>(), 0.02);
  EXPECT_NE(lost["warnings"].dump().find("% of the samples are farther than 3 voxels"), std::string::npos);
  const ProcessResult strict = run({"reconstruct", bad, "-o", mesh, "--resolution", "48", "--strict"});
  EXPECT_EQ(strict.exit_code, 4);
  EXPECT_NE(strict.err.find("% of the samples are farther than 3 voxels"), std::string::npos);
  EXPECT_FALSE(written().triangles.empty());
}

/// Most signs are wrong, the others right: by the majority the body looks inward, as if all were wrong.
TEST_F(Outside, ABodyWithMostSignsWrongIsTurnedOver) {
  for (const double share : {0.3, 0.7, 0.8, 0.9}) {
    PointCloud all = sample_surface(*make_torus(), samples, 1);
    Random random(5);
    for (Vec3f& n : all.normals)
      if (random.uniform() < share) n = -n;
    const std::string cloud = folder.file("mixed.ply");
    write_points(cloud, all);
    const json turned = reported({cloud, "--resolution", "48"});
    EXPECT_GT(written().volume(), 0) << share;
    EXPECT_EQ(turned["border"]["turned"], share > 0.5) << share;
    const std::string warnings = turned["warnings"].dump();
    EXPECT_NE(warnings.find(share > 0.5 ? "oriented inward by" : "oriented outward by"), std::string::npos) << warnings;
    EXPECT_EQ(warnings.find("--outside solid") != std::string::npos, share > 0.5) << warnings;
  }
}

/// Where a closed mesh of negative volume stays, the warning names the options; not where it was asked for.
TEST_F(Outside, AHollowThatNobodyAskedForIsWarnedOf) {
  const auto is_warned = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.end(), {"--resolution", "48"});
    const json report = reported(arguments);
    EXPECT_EQ(report["mesh"]["closed"], true);
    const bool warned = report["warnings"].dump().find("hollow in solid matter") != std::string::npos;
    EXPECT_TRUE(!warned || written().volume() < 0);
    return warned;
  };
  EXPECT_TRUE(is_warned({sphere(true), "--outside", "open"}));
  EXPECT_FALSE(is_warned({sphere(true), "--outside", "solid"}));
  EXPECT_FALSE(is_warned({sphere(true)}));
  EXPECT_FALSE(is_warned({sphere(false), "--outside", "open"}));
  // The faces of a box look like a room's walls.
  PointCloud box;
  Random random(1);
  for (size_t i = 0; i < samples; ++i) {
    const int axis = static_cast<int>(i % 3), side = i % 2 == 0 ? 1 : -1;
    Vec3d p{random.uniform(), random.uniform(), random.uniform()};
    p[axis] = 0.5 + 0.5 * side;
    Vec3f n;
    n[axis] = static_cast<float>(-side);
    box.positions.push_back(p);
    box.normals.push_back(n);
  }
  const std::string cloud = folder.file("box.ply");
  write_points(cloud, box);
  EXPECT_TRUE(is_warned({cloud}));
  EXPECT_FALSE(is_warned({cloud, "--directions", "estimate"}));
}

TEST_F(Outside, OnlyTvMayBeOpen) {
  refused({sphere(false), "--outside", "open", "--method", "poisson"}, "outside = open: method poisson cannot have it");
  refused({sphere(false), "--outside", "water"}, "--outside");
}

}  // namespace TEST_FILE
}  // namespace soapfilm::test
