// Which files a list of files, folders and patterns stands for, and in which order.
#include "soapfilm/io/sets/input_files.h"

#include "files.h"
#include "samples.h"
#include "soapfilm/io.h"
#include "soapfilm/io/files.h"
#include "soapfilm/io/sets/file_pattern.h"

namespace soapfilm {
namespace TEST_FILE {

using Names = std::vector<std::string>;

/// A folder of files, all of them one sample's.
class InputFiles : public testing::Test {
 protected:
  std::string cloud(const std::string& name) {
    std::filesystem::create_directories(std::filesystem::path(folder / name).parent_path());
    write_points(folder / "one.ply", rich_cloud(1, 3, 1, 1));
    std::filesystem::rename(folder / "one.ply", folder / name);
    return folder / name;
  }
  std::string mesh(const std::string& name) {
    write_mesh(folder / name, torus_mesh(4, 1));
    return folder / name;
  }
  /// The files, without the folder's path.
  Names found(const Names& given) {
    warnings.clear();
    Names names = io::input_files(given, warnings);
    for (std::string& name : names) name = name.substr(name.rfind(folder / "", 0) == 0 ? (folder / "").size() : 0);
    return names;
  }
  void expect_warning(const std::string& text) {
    ASSERT_EQ(warnings.size(), 1u);
    EXPECT_NE(warnings[0].find(text), std::string::npos) << warnings[0];
    EXPECT_EQ(warnings[0].find('\n'), std::string::npos);
  }

  TemporaryFolder folder;
  Names warnings;
};

TEST(Names, AreInTheOrderOfTheirNumbers) {
  const Names order{"A2",
                    "a",
                    "a.laz",
                    "a2",
                    "a02",
                    "a2.laz",
                    "a2b",
                    "a10.laz",
                    "a10_2.x",
                    "a10_10.x",
                    "a99999999999999999999",
                    "a100000000000000000000",
                    "b1",
                    "\xc3\xa4"};
  for (size_t i = 0; i < order.size(); ++i)
    for (size_t k = 0; k < order.size(); ++k)
      EXPECT_EQ(io::comes_before(order[i], order[k]), i < k) << order[i] << " and " << order[k];
}

TEST(Names, MatchAsInAShell) {
  const auto matched = [](const std::string& pattern, const Names& yes, const Names& no) {
    for (const std::string& name : yes) EXPECT_TRUE(io::matches(name, pattern)) << name << " and " << pattern;
    for (const std::string& name : no) EXPECT_FALSE(io::matches(name, pattern)) << name << " and " << pattern;
  };
  matched("*.laz", {"a.laz", "a.b.laz", "a.laz.laz"}, {".laz", ".a.laz", "a.las", "a.laz2", "alaz"});
  matched("tile_?.laz", {"tile_1.laz", "tile_\xc3\xa4.laz", "tile_\xff.laz"}, {"tile_.laz", "tile_10.laz"});
  matched("tile_[0-35].laz", {"tile_0.laz", "tile_3.laz", "tile_5.laz"}, {"tile_4.laz", "tile_-.laz", "tile_03.laz"});
  matched("[!a-c]*", {"d", "\xc3\xa4", "dab"}, {"a", "cd", ""});
  matched("[^a-c]", {"d"}, {"b"});
  matched("[\xc3\xa4\xc3\xb6]", {"\xc3\xa4", "\xc3\xb6"}, {"\xc3\xbc", "\xc3"});
  matched("[]x]", {"]", "x"}, {"[", "y"});
  matched("[a-]", {"a", "-"}, {"b"});
  matched("a[b", {"a[b"}, {"ab", "a["});  // nothing closes it
  matched("*a*b*", {"ab", "xaybz", "aab"}, {"ba", "a"});
  matched("*?", {"a", "ab"}, {""});
  matched(".*", {".a", "."}, {"a"});
  matched("?a", {"xa"}, {".a"});
  matched("", {""}, {"a"});
}

TEST_F(InputFiles, APatternIsTheFilesThatItMatches) {
  for (const char* name : {"tiles/t_10.ply", "tiles/t_9.ply", "tiles/t_1.laz", "tiles/u_1.ply", "other/t_3.ply"})
    cloud(name);
  folder.write("tiles/t_2.txt~", "no format");
  folder.write("tiles/.t_3.ply", "hidden");
  EXPECT_EQ(found({folder / "tiles/t_*"}), (Names{"tiles/t_1.laz", "tiles/t_9.ply", "tiles/t_10.ply"}));
  EXPECT_EQ(found({folder / "tiles/t_?.ply"}), (Names{"tiles/t_9.ply"}));
  EXPECT_EQ(found({folder / "*/t_[39].ply", folder / "tiles/u_1.ply"}),
            (Names{"other/t_3.ply", "tiles/t_9.ply", "tiles/u_1.ply"}));
  EXPECT_EQ(found({folder / "[ot]*"}),
            (Names{"other/t_3.ply", "tiles/t_1.laz", "tiles/t_9.ply", "tiles/t_10.ply", "tiles/u_1.ply"}))
      << "folders";
  EXPECT_EQ(found({folder / "tiles//t_9*"}), (Names{"tiles//t_9.ply"}));
  cloud("top.ply");
  EXPECT_EQ(found({folder / "*"}), (Names{"top.ply"})) << "not recursive where there are files";
  EXPECT_TRUE(warnings.empty());
}

TEST_F(InputFiles, WhatExistsIsNoPattern) {
  for (const char* name : {"a[1].ply", "a1.ply", "b*.ply", "b2.ply", "in[1]/c.ply", "in1/c.ply", "in[1]/d.ply"})
    cloud(name);
  EXPECT_EQ(found({folder / "a[1].ply"}), (Names{"a[1].ply"}));
  EXPECT_EQ(found({folder / "b*.ply"}), (Names{"b*.ply"}));
  EXPECT_EQ(found({folder / "in[1]"}), (Names{"in[1]/c.ply", "in[1]/d.ply"}));
  EXPECT_EQ(found({folder / "in[1]/[cd].ply"}), (Names{"in[1]/c.ply", "in[1]/d.ply"}));
  EXPECT_EQ(read_points(folder / "b*.ply").scans.size(), 1u);
  EXPECT_EQ(read_points(folder / "in[1]/*").scans.size(), 2u);
}

TEST_F(InputFiles, AFolderIsItsScansByName) {
  for (const char* name :
       {"tile_10.ply", "tile_2.ply", "tile_1.LAZ", "tile_3.e57", "tile_4.copc.laz", "sub/tile_5.ply"})
    cloud("tiles/" + std::string(name));
  folder.write("tiles/.tile_6.ply", "hidden");
  folder.write("tiles/readme.md", "no format");
  folder.write("tiles/notes.txt", "no points");
  EXPECT_EQ(found({folder / "tiles"}), (Names{"tiles/tile_1.LAZ", "tiles/tile_2.ply", "tiles/tile_3.e57",
                                              "tiles/tile_4.copc.laz", "tiles/tile_10.ply"}));
  EXPECT_TRUE(warnings.empty());
  EXPECT_EQ(found({folder / "tiles/"}).size(), 5u);
  folder.write("tiles/more.xyz", "0 0 0\n");
  EXPECT_EQ(found({folder / "tiles"}).size(), 5u);
  expect_warning("more.xyz: left out, text beside other scans; named by itself it is read");
}

TEST_F(InputFiles, MeshesInAFolderAreNoScans) {
  cloud("tiles/tile_2.ply");
  cloud("tiles/tile_1.ply");
  mesh("tiles/result.ply");
  mesh("tiles/model.obj");
  mesh("tiles/cad.stl");
  mesh("tiles/tile_1.mesh.ply");
  mesh("tiles/tile_1.mesh.part_001.ply");
  EXPECT_EQ(found({folder / "tiles"}), (Names{"tiles/tile_1.ply", "tiles/tile_2.ply"}));
  ASSERT_EQ(warnings.size(), 2u);
  EXPECT_NE(warnings[0].find(".part_001.ply and 1 more: left out, made by an earlier run"), std::string::npos)
      << warnings[0];
  EXPECT_NE(warnings[1].find("model.obj and 1 more: left out, a mesh with faces; named by itself it is read"),
            std::string::npos)
      << warnings[1];
  EXPECT_EQ(found({folder / "tiles/tile_1.ply", folder / "tiles/result.ply"}).size(), 2u) << "named by itself";
  EXPECT_TRUE(warnings.empty());
}

TEST_F(InputFiles, MeshesAloneInAFolderAreItsScans) {
  std::filesystem::create_directory(folder / "scans");
  mesh("scans/b.ply");
  mesh("scans/a.obj");
  mesh("scans/a.mesh.ply");
  folder.write("scans/notes.txt", "no points");
  EXPECT_EQ(found({folder / "scans"}), (Names{"scans/a.obj", "scans/b.ply"}));
  expect_warning("a.mesh.ply: left out, made by an earlier run; named by itself it is read");
  folder.write("scans/points.xyz", "0 0 0\n");
  EXPECT_EQ(found({folder / "scans"}), (Names{"scans/points.xyz"}));
  EXPECT_EQ(warnings.size(), 2u);
}

TEST_F(InputFiles, AFileIsReadOnce) {
  cloud("tiles/tile_1.ply");
  cloud("tiles/tile_2.ply");
  std::filesystem::create_symlink(folder / "tiles/tile_1.ply", folder / "link.ply");
  std::filesystem::create_hard_link(folder / "tiles/tile_2.ply", folder / "hard.ply");
  EXPECT_EQ(found({folder / "tiles/tile_2.ply", folder / "tiles"}), (Names{"tiles/tile_2.ply", "tiles/tile_1.ply"}));
  expect_warning("tiles/tile_2.ply: is named twice, read once");
  EXPECT_EQ(found({folder / "link.ply", folder / "tiles/*.ply"}), (Names{"link.ply", "tiles/tile_2.ply"}));
  expect_warning("tiles/tile_1.ply: the file " + folder / "link.ply: is named twice, read once");
  EXPECT_EQ(found({folder / "tiles", folder / "tiles/../tiles", folder / "hard.ply"}).size(), 2u);
  expect_warning("tiles/../tiles/tile_1.ply: the file " +
                 folder / "tiles/tile_1.ply, and 2 more files: are named twice");
  EXPECT_EQ(read_points(Names{folder / "link.ply", folder / "tiles"}).scans.size(), 2u);
}

TEST_F(InputFiles, AreRefusedInOneLineThatNamesThem) {
  cloud("tiles/a.ply");
  folder.write("tiles/notes.md", "");
  std::filesystem::create_directory(folder / "empty");
  const auto refused = [&](const std::string& path, const std::string& why) {
    expect_refusal<InputError>([&] { read_points(path); }, {path, why});
    expect_refusal<InputError>([&] { read_points(Names{path}); }, {path, why});
  };
  refused(folder / "tilez", "cannot be opened: No such file or directory");
  expect_refusal<InputError>([&] { read_points(Names{folder / "tilez/"}); }, {"tilez/: no such folder"});
  refused(folder / "tiles/*.laz", "a pattern that no file matches");
  refused(folder / "tilez/*.laz", "a pattern that no file matches");
  refused(folder / "tiles/*.md", "a pattern of 1 file");
  refused(folder / "tiles/*.md", "notes.md, must match files that end in .ply, .xyz");
  refused(folder / "empty", "a folder without scans, must hold files that end in .ply, .xyz");
  refused(folder / "tiles/a.ply/*", "a pattern that no file matches");
  mesh("empty/a.mesh.ply");
  refused(folder / "empty", "a folder without scans");
}

/// All scans come with their places, as when they are named one by one.
TEST_F(InputFiles, OfAFolderGiveTheCloudOfTheirNames) {
  std::filesystem::create_directory(folder / "scans");
  for (const int k : {2, 10, 1})
    write_points(folder / "scans/s_" + std::to_string(k) + ".ply", rich_cloud(2, 6, 5, static_cast<uint64_t>(k)));
  const PointCloud named =
      read_points(Names{folder / "scans/s_1.ply", folder / "scans/s_2.ply", folder / "scans/s_10.ply"});
  expect_same_cloud(read_points(folder / "scans"), named);
  expect_same_cloud(read_points(folder / "scans/s_*"), named);
  expect_same_cloud(read_points(Names{folder / "scans"}, nullptr, Context(2)), named);
  EXPECT_EQ(file_kind(folder / "scans"), FileKind::points);
}

}  // namespace TEST_FILE
}  // namespace soapfilm
