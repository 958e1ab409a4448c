// Levels of detail in files: one GLB whose viewers show the finest, or a file for each.
#define TINYGLTF_NO_STB_IMAGE
#define TINYGLTF_NO_STB_IMAGE_WRITE
#define TINYGLTF_NO_EXTERNAL_IMAGE
#include "soapfilm/io/levels.h"

#include <tiny_gltf.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "files.h"
#include "samples.h"
#include "soapfilm/core/vec.h"
#include "soapfilm/io.h"

namespace soapfilm {
namespace TEST_FILE {

std::vector<DetailLevel> three_levels() {
  std::vector<DetailLevel> levels{{torus_mesh(40, 1), 0.01}, {torus_mesh(20, 1), 0.02}, {torus_mesh(10, 1), 0.05}};
  for (DetailLevel& level : levels)
    for (Vec3d& v : level.mesh.vertices) v = v + Vec3d{1000, 2000, 3000};
  return levels;
}

std::string bytes_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

TEST(Levels, AreOneGlbOfWhichViewersShowTheFinest) {
  const TemporaryFolder folder;
  const std::vector<DetailLevel> levels = three_levels();
  const std::string path = folder / "m.glb";
  EXPECT_EQ(level_files(path, 3), std::vector<std::string>{path});
  write_levels(path, levels, {}, Context(1));
  EXPECT_EQ(folder.file_count(), 1u);

  tinygltf::Model model;
  std::string error, warning;
  ASSERT_TRUE(tinygltf::TinyGLTF().LoadBinaryFromFile(&model, &error, &warning, path)) << error << warning;
  EXPECT_EQ(model.extensionsUsed, std::vector<std::string>{"MSFT_lod"});
  EXPECT_TRUE(model.extensionsRequired.empty());
  // The scene reaches one node with a mesh.
  std::vector<int> shown = model.scenes.at(0).nodes, meshes;
  ASSERT_EQ(model.scenes.size(), 1u);
  while (!shown.empty()) {
    const tinygltf::Node& node = model.nodes.at(static_cast<size_t>(shown.back()));
    shown.pop_back();
    if (node.mesh >= 0) meshes.push_back(node.mesh);
    shown.insert(shown.end(), node.children.begin(), node.children.end());
  }
  EXPECT_EQ(meshes, std::vector<int>{0});
  const tinygltf::Value& ids = model.nodes[0].extensions.at("MSFT_lod").Get("ids");
  ASSERT_EQ(ids.ArrayLen(), 2u);
  for (size_t k = 0; k < levels.size(); ++k) {
    const int index = k == 0 ? 0 : ids.Get(static_cast<int>(k) - 1).GetNumberAsInt();
    const tinygltf::Node& node = model.nodes.at(static_cast<size_t>(index));
    EXPECT_EQ(node.name, "lod" + std::to_string(k));
    EXPECT_EQ(node.translation, model.nodes[0].translation);
    const double proved = node.extras.Get("proved_distance").GetNumberAsDouble();
    EXPECT_GT(proved, levels[k].proved) << "rounding to float counts";
    EXPECT_LT(proved, levels[k].proved + 1e-6);
    const auto& triangles = model.meshes.at(static_cast<size_t>(node.mesh)).primitives.at(0);
    EXPECT_EQ(model.accessors.at(static_cast<size_t>(triangles.indices)).count, 3 * levels[k].mesh.triangles.size());
    EXPECT_EQ(triangles.attributes.count("_HEIGHT"), 1u);
    EXPECT_EQ(triangles.attributes.count("COLOR_0"), 1u);
  }
  const Mesh read = read_mesh(path);
  EXPECT_EQ(read.triangles, levels[0].mesh.triangles);
  EXPECT_LT(norm(read.vertices[7] - levels[0].mesh.vertices[7]), 1e-6);
}

/// Without coarser ones the file is what write_mesh() writes.
TEST(Levels, OneLevelIsTheMeshAlone) {
  const TemporaryFolder folder;
  const std::vector<DetailLevel> one{three_levels()[0]};
  for (const std::string name : {"m.glb", "m.ply"}) {
    write_levels(folder / name, one, {}, Context(1));
    write_mesh(folder / ("as " + name), one[0].mesh);
    EXPECT_EQ(bytes_of(folder / name), bytes_of(folder / ("as " + name)));
  }
}

TEST(Levels, AreAFileEachInOtherFormats) {
  const TemporaryFolder folder;
  const std::vector<DetailLevel> levels = three_levels();
  const std::vector<std::string> files = level_files(folder / "m.x.obj", 3);
  EXPECT_EQ(files, (std::vector<std::string>{folder / "m.x.obj", folder / "m.x.1.obj", folder / "m.x.2.obj"}));
  write_levels(files[0], levels, {}, Context(1));
  for (size_t k = 0; k < files.size(); ++k)
    EXPECT_EQ(read_mesh(files[k]).triangles.size(), levels[k].mesh.triangles.size());
}

TEST(Levels, AreAllWrittenOrNone) {
  const TemporaryFolder folder;
  std::vector<DetailLevel> levels = three_levels();
  for (const std::string name : {"m.stl", "m.glb"}) {
    for (Vec3d& v : levels[1].mesh.vertices) v = v * 1e60;  // no float
    EXPECT_THROW(write_levels(folder / name, levels, {}, Context(1)), OutputError);
    EXPECT_EQ(folder.file_count(), 0u) << name;
  }
}

}  // namespace TEST_FILE
}  // namespace soapfilm
