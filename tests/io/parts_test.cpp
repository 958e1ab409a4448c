// A mesh in several files: put together again it is the same mesh, and all of its files are there, or none.
#include "soapfilm/io/parts.h"

#include <sys/resource.h>

#include <csignal>
#include <map>
#include <nlohmann/json.hpp>
#include <numeric>
#include <set>
#include <tuple>

#include "files.h"
#include "samples.h"
#include "soapfilm/io/bytes/staged_files.h"
#include "soapfilm/io/files.h"
#include "soapfilm/io/meshes/mesh_blocks.h"

namespace soapfilm {
namespace TEST_FILE {

using Place = std::tuple<double, double, double>;
using PlacedCorners = std::array<Place, 3>;

Place place_of(const Vec3d& p) { return {p.x, p.y, p.z}; }

/// All triangles by the places of their corners, the lowest first, turned as they are.
std::multiset<PlacedCorners> triangles_of(const Mesh& mesh) {
  std::multiset<PlacedCorners> all;
  for (const Triangle& t : mesh.triangles) {
    PlacedCorners corners;
    for (size_t k = 0; k < 3; ++k) corners[k] = place_of(mesh.vertices[t[k]]);
    std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
    all.insert(corners);
  }
  return all;
}

/// What a vertex has beside its place.
struct Beside {
  Vec3f normal;
  Rgb8 color{};
  std::vector<float> values;
  bool operator==(const Beside&) const = default;
};

Beside beside(const Mesh& mesh, size_t v) {
  Beside all;
  if (!mesh.normals.empty()) all.normal = mesh.normals[v];
  if (!mesh.colors.empty()) all.color = mesh.colors[v];
  for (const Column& column : mesh.attributes) all.values.push_back(column.values[v]);
  return all;
}

/// Triangles somewhere, with corners of their own.
Mesh loose_triangles(size_t count, uint64_t seed) {
  Random random(seed);
  Mesh mesh;
  for (size_t i = 0; i < count; ++i) {
    const Vec3d middle{random.uniform(0, 3), random.uniform(0, 2), random.uniform()};
    for (int k = 0; k < 3; ++k)
      mesh.vertices.push_back(middle + 0.1 * Vec3d{random.normal(), random.normal(), random.normal()});
    const auto v = static_cast<uint32_t>(3 * i);
    mesh.triangles.push_back({v, v + 1, v + 2});
  }
  return mesh;
}

/// The files of a folder that are not hidden, and nothing hidden.
std::set<std::string> names_in(const TemporaryFolder& folder) {
  std::set<std::string> names;
  for (const auto& file : std::filesystem::directory_iterator(folder / "")) names.insert(file.path().filename());
  return names;
}

/// What the index and the parts say is what the whole mesh's file says.
void expect_whole(const std::string& path, const Mesh& whole, size_t most) {
  const auto index = nlohmann::json::parse(std::ifstream(parts_index(path)));
  EXPECT_EQ(index["format"], "soapfilm mesh parts");
  EXPECT_EQ(index["version"], 1);
  EXPECT_EQ(index["files"], index["parts"].size());
  std::multiset<PlacedCorners> triangles;
  std::map<Place, Beside> at;
  for (size_t v = 0; v < whole.vertices.size(); ++v) at[place_of(whole.vertices[v])] = beside(whole, v);
  std::set<Place> places;
  Box3d all;
  for (const auto& row : index["parts"]) {
    const Mesh part = read_mesh((std::filesystem::path(path).parent_path() / row["file"].get<std::string>()).string());
    EXPECT_EQ(row["triangles"], part.triangles.size());
    EXPECT_LE(part.triangles.size(), most);
    EXPECT_EQ(row["vertices"], part.vertices.size());
    const Box3d box = part.box();
    all.extend(box);
    for (size_t k = 0; k < 3; ++k) {
      EXPECT_EQ(row["box"]["lo"][k], box.lo[static_cast<int>(k)]);
      EXPECT_EQ(row["box"]["hi"][k], box.hi[static_cast<int>(k)]);
    }
    triangles.merge(triangles_of(part));
    for (size_t v = 0; v < part.vertices.size(); ++v) {
      const Place place = place_of(part.vertices[v]);
      places.insert(place);
      ASSERT_TRUE(at.contains(place)) << "a vertex that the whole mesh has not";
      EXPECT_EQ(at[place], beside(part, v));
    }
  }
  EXPECT_EQ(triangles, triangles_of(whole));
  EXPECT_EQ(index["triangles"], whole.triangles.size());
  EXPECT_EQ(index["vertices"], places.size());
  EXPECT_EQ(index["box"]["hi"][1], all.hi.y);
}

TEST(Parts, PutTogetherAreTheMeshInEveryFormat) {
  // Far from the origin coordinates are double where the format knows them, near it they are float.
  for (const Vec3d offset : {Vec3d{}, Vec3d{691000.125, 5334000.25, 520}})
    for (const std::string extension : {".ply", ".obj", ".off", ".stl", ".glb"}) {
      SCOPED_TRACE(extension);
      const TemporaryFolder folder;
      const Mesh mesh = torus_mesh(30, 100, offset);
      write_mesh(folder / ("whole" + extension), mesh);
      const Mesh whole = read_mesh(folder / ("whole" + extension));
      const std::string path = folder / ("city" + extension);
      const WrittenParts written = write_parts(path, mesh, {300, "EPSG:25832", "metre"}, {}, Context(1));
      EXPECT_EQ(written.parts.size(), 8u) << "1800 triangles, 3 times halved";
      EXPECT_EQ(written.parts[7].file, folder / ("city.part_008" + extension));
      EXPECT_EQ(names_in(folder).size(), 1u + 8u + 1u);
      ASSERT_NO_FATAL_FAILURE(expect_whole(path, whole, 300));
      const auto index = nlohmann::json::parse(folder.read("city.parts.json"));
      EXPECT_EQ(index["coordinate_system"], "EPSG:25832");
      EXPECT_EQ(index["unit"], "metre");
      EXPECT_EQ(index["origin"][0].get<double>(), extension == ".glb" ? mesh.box().center().x : 0);
      EXPECT_EQ(written.report.double_coordinates, offset.x > 0 && extension != ".stl" && extension != ".glb");
    }
}

/// The normals that a GLB has of its faces are those of the whole surface, along the cuts too.
TEST(Parts, OfAGlbHaveTheNormalsOfTheWholeMesh) {
  const TemporaryFolder folder;
  Mesh mesh = torus_mesh(20, 1);
  mesh.normals.clear();
  mesh.attributes.clear();
  write_mesh(folder / "whole.glb", mesh);
  write_parts(folder / "m.glb", mesh, {100, {}, {}}, {}, Context(1));
  ASSERT_NO_FATAL_FAILURE(expect_whole(folder / "m.glb", read_mesh(folder / "whole.glb"), 100));
  const auto index = nlohmann::json::parse(folder.read("m.parts.json"));
  EXPECT_TRUE(index["coordinate_system"].is_null());
  EXPECT_TRUE(index["unit"].is_null());
}

TEST(Parts, OfAnySizeHaveAllTriangles) {
  Random random(11);
  for (int trial = 0; trial < 25; ++trial) {
    const TemporaryFolder folder;
    const auto count = static_cast<size_t>(random.uniform(1, trial % 5 == 0 ? 3 : 90));
    const auto most = static_cast<size_t>(random.uniform(1, trial % 3 == 0 ? 3 : 120));
    SCOPED_TRACE(std::to_string(count) + " triangles, at most " + std::to_string(most));
    Mesh mesh = loose_triangles(count, static_cast<uint64_t>(trial));
    mesh.vertices.push_back({0.5, 0.5, 0.5});  // in no triangle
    const WrittenParts written = write_parts(folder / "m.ply", mesh, {most, {}, {}}, {}, Context(1));
    EXPECT_GE(written.parts.size(), (count + most - 1) / most);
    for (const WrittenPart& part : written.parts)
      EXPECT_TRUE(written.parts.size() == 1 || 2 * part.triangles + 1 >= most) << "smaller than it must be";
    write_mesh(folder / "whole.ply", mesh);
    ASSERT_NO_FATAL_FAILURE(expect_whole(folder / "m.ply", read_mesh(folder / "whole.ply"), most));
  }
}

TEST(Parts, OfOneTriangleAndOfNone) {
  const TemporaryFolder folder;
  const WrittenParts written = write_parts(folder / "m.ply", loose_triangles(1, 3), {1000, {}, {}}, {}, Context(1));
  ASSERT_EQ(written.parts.size(), 1u);
  EXPECT_EQ(names_in(folder), (std::set<std::string>{"m.part_001.ply", "m.parts.json"}));
  const TemporaryFolder none;
  expect_refusal<ParameterError>([&] { write_parts(none / "m.ply", {}, {}, {}, Context(1)); }, {"0 triangles"});
  expect_refusal<ParameterError>(
      [&] {
        write_parts(none / "m.ply", loose_triangles(1, 3), {0, {}, {}}, {}, Context(1));
      },
      {"triangles of a part = 0"});
  EXPECT_EQ(none.file_count(), 0u);
}

/// By sorting, and in double.
std::vector<std::vector<uint32_t>> reference_blocks(const Mesh& mesh, std::vector<uint32_t> triangles, size_t most) {
  if (triangles.size() <= most) {
    std::sort(triangles.begin(), triangles.end());
    return {triangles};
  }
  const auto centroid = [&](uint32_t t) {
    const Triangle& c = mesh.triangles[t];
    return (1.0 / 3) * (mesh.vertices[c[0]] + mesh.vertices[c[1]] + mesh.vertices[c[2]]);
  };
  Box3d box;
  for (const uint32_t t : triangles) box.extend(centroid(t));
  int axis = 0;
  for (int k = 1; k < 3; ++k)
    if (box.size()[k] > box.size()[axis]) axis = k;
  std::sort(triangles.begin(), triangles.end(),
            [&](uint32_t a, uint32_t b) { return std::pair(centroid(a)[axis], a) < std::pair(centroid(b)[axis], b); });
  const auto middle = triangles.begin() + static_cast<std::ptrdiff_t>(triangles.size() / 2);
  auto blocks = reference_blocks(mesh, {triangles.begin(), middle}, most);
  for (auto& block : reference_blocks(mesh, {middle, triangles.end()}, most)) blocks.push_back(std::move(block));
  return blocks;
}

TEST(Parts, AreHalvesAcrossTheLongestSide) {
  for (const size_t count : {1u, 2u, 7u, 1000u}) {
    const Mesh mesh = loose_triangles(count, count);
    std::vector<uint32_t> all(count);
    std::iota(all.begin(), all.end(), 0u);
    for (const size_t most : {1u, 3u, 100u}) {
      const auto expected = reference_blocks(mesh, all, most);
      const io::MeshBlocks blocks = io::cut_into_blocks(mesh, most, Context(2));
      ASSERT_EQ(blocks.size(), expected.size());
      for (size_t k = 0; k < blocks.size(); ++k)
        EXPECT_EQ(std::vector<uint32_t>(blocks[k].begin(), blocks[k].end()), expected[k]);
    }
  }
}

/// Equal places are told apart by the triangles' numbers; the longest coordinates are no infinity.
TEST(Parts, OfOnePlaceOrOfTheLargestNumbersAreCutToo) {
  Mesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1e308, 1e308, 1e308}, {-1e308, 1e308, 1e308}};
  mesh.triangles.assign(10, {0, 1, 2});
  const io::MeshBlocks same = io::cut_into_blocks(mesh, 3, Context(1));
  ASSERT_EQ(same.size(), 4u);
  EXPECT_EQ(std::vector<uint32_t>(same[0].begin(), same[0].end()), (std::vector<uint32_t>{0, 1}));
  EXPECT_EQ(std::vector<uint32_t>(same[3].begin(), same[3].end()), (std::vector<uint32_t>{7, 8, 9}));
  mesh.triangles = {{3, 3, 0}, {4, 4, 0}};
  const io::MeshBlocks far = io::cut_into_blocks(mesh, 1, Context(1));
  ASSERT_EQ(far.size(), 2u);
  EXPECT_EQ(far[0][0], 1u) << "the lower x first";
}

TEST(Parts, AreTheSameBytesForAnyNumberOfThreads) {
  const TemporaryFolder one, two;
  const Mesh mesh = torus_mesh(150, 3);
  for (const std::string name : {"m.ply", "m.glb"}) {
    write_parts(one / name, mesh, {3000, {}, {}}, {}, Context(1));
    write_parts(two / name, mesh, {3000, {}, {}}, {}, Context(2));
  }
  EXPECT_EQ(names_in(one), names_in(two));
  for (const std::string& name : names_in(one)) EXPECT_TRUE(one.read(name) == two.read(name)) << name;
}

TEST(Parts, AreAllThereOrNone) {
  const Mesh mesh = torus_mesh(20, 1);
  const auto refuse = [&](const TemporaryFolder& folder, const std::string& path, const std::string& part) {
    const std::set<std::string> before = names_in(folder);
    expect_refusal<OutputError>([&] { write_parts(path, mesh, {200, {}, {}}, {}, Context(1)); }, {part});
    EXPECT_EQ(names_in(folder), before);
  };
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder / "m.part_003.ply");  // two are written before
  refuse(folder, folder / "m.ply", folder / "m.part_003.ply: is a directory");
  std::filesystem::create_directory(folder / "n.parts.json");
  refuse(folder, folder / "n.ply", folder / "n.parts.json: is a directory");
  refuse(folder, folder / "none/m.ply", folder / "none/m.part_001.ply: cannot be written: No such file");

  // A full disk: no file may be longer than this.
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit few{3000, before.rlim_max};
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &few), 0);
  refuse(folder, folder / "full.ply", folder / "full.part_001.ply: cannot be written: File too large");
  setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, handler);
}

TEST(Parts, StayAsTheyWereWhereCancelled) {
  const TemporaryFolder folder;
  Progress progress;
  const Context context(1, progress);
  progress.cancel();
  EXPECT_THROW(write_parts(folder / "m.ply", torus_mesh(20, 1), {100, {}, {}}, {}, context), Cancelled);
  EXPECT_EQ(folder.file_count(), 0u);
}

TEST(Parts, OfAnEarlierMeshAreToldAndReplaced) {
  const TemporaryFolder folder;
  write_parts(folder / "m.ply", torus_mesh(20, 1), {100, {}, {}}, {}, Context(1));
  const std::string first = folder.read("m.part_001.ply");
  const WrittenParts written = write_parts(folder / "m.ply", torus_mesh(20, 2), {200, {}, {}}, {}, Context(1));
  ASSERT_EQ(written.report.warnings.size(), 1u);
  EXPECT_NE(written.report.warnings[0].find("m.part_005.ply: the first of 4 parts of an earlier mesh"),
            std::string::npos)
      << written.report.warnings[0];
  EXPECT_NE(folder.read("m.part_001.ply"), first);
  EXPECT_EQ(nlohmann::json::parse(folder.read("m.parts.json"))["files"], 4);
}

TEST(Parts, AreKnownByTheirNames) {
  EXPECT_EQ(part_file("a/city.ply", 7, 12), "a/city.part_007.ply");
  EXPECT_EQ(part_file("city.mesh.glb", 7, 12345), "city.mesh.part_00007.glb");
  EXPECT_EQ(parts_index("a/city.mesh.ply"), "a/city.mesh.parts.json");
  EXPECT_TRUE(is_part_file("a/city.ply", "a/../a/city.part_007.ply"));
  for (const char* other : {"a/city.ply", "a/city.part_.ply", "a/city.part_1x.ply", "city.part_007.ply",
                            "a/city.part_007.obj", "a/town.part_007.ply"})
    EXPECT_FALSE(is_part_file("a/city.ply", other)) << other;
}

TEST(Parts, AreRefusedWhereAFormatHoldsClosedSurfaces) {
  const TemporaryFolder folder;
  expect_refusal<OutputError>([&] { check_parts_output(folder / "m.vdb"); }, {"m.vdb: .vdb holds a closed surface"});
  expect_refusal<OutputError>([&] { check_parts_output(folder / "m.las"); }, {"m.las: extension '.las'"});
  check_parts_output(folder / "m.ply");
  EXPECT_EQ(folder.file_count(), 0u);
}

/// Warnings are told once, by the name of the file that is there.
TEST(Parts, WarnOnce) {
  const TemporaryFolder folder;
  const WrittenParts written = write_parts(folder / "m.stl", torus_mesh(20, 1), {100, {}, {}}, {}, Context(1));
  ASSERT_EQ(written.report.warnings.size(), 1u);
  EXPECT_EQ(written.report.warnings[0].rfind(folder / "m.part_001.stl: STL holds no colors", 0), 0u)
      << written.report.warnings[0];
}

void add_new(io::StagedFiles& files, const std::string& target) {
  files.write(target, [](io::AtomicFile& file) { file.append("new"); });
}

TEST(StagedFiles, WhereOneCannotBeNamedNoneIsLeft) {
  const TemporaryFolder folder;
  io::StagedFiles files;
  folder.write("index", "old");
  for (const char* name : {"a", "b", "index"}) add_new(files, folder / name);
  EXPECT_EQ(folder.read("index"), "old");
  std::filesystem::create_directory(folder / "b");
  expect_refusal<OutputError>([&] { files.commit(); }, {folder / "b: cannot be written: Is a directory"});
  EXPECT_EQ(names_in(folder), std::set<std::string>{"b"}) << "the old index named what is not there any more";
}

/// More than are kept open, and nothing is left where it dies of a signal.
TEST(StagedFiles, AreManyAndGoWithTheProcess) {
  const TemporaryFolder folder;
  constexpr size_t count = 300;
  for (const bool dies : {true, false}) {
    io::StagedFiles files;
    for (size_t k = 0; k < count; ++k) add_new(files, folder / part_file("m.ply", k, count));
    if (!dies) {
      files.commit();
      continue;
    }
    EXPECT_GT(folder.file_count(), 0u);
    remove_temporary_files();
    EXPECT_EQ(folder.file_count(), 0u);
  }
  EXPECT_EQ(folder.file_count(), count);
}

TEST(StagedFiles, ASymbolicLinkStaysALink) {
  const TemporaryFolder folder;
  folder.write("target", "old");
  std::filesystem::create_symlink(folder / "target", folder / "link");
  io::StagedFiles files;
  add_new(files, folder / "link");
  EXPECT_EQ(folder.read("target"), "old");
  files.commit();
  EXPECT_TRUE(std::filesystem::is_symlink(folder / "link"));
  EXPECT_EQ(folder.read("target"), "new");
}

}  // namespace TEST_FILE
}  // namespace soapfilm
