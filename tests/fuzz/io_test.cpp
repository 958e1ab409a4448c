// Valid files of every format, cut and changed at random: each must be read or refused with InputError, under the
// sanitizers too. Deterministic; SOAPFILM_FUZZ_ROUNDS sets the number of changed files per seed file (default 3000).
#include <cstdlib>
#include <functional>

#include "../io/files.h"
#include "../io/laz_files.h"
#include "../io/samples.h"
#include "soapfilm/core/random.h"
#include "soapfilm/io.h"
#include "support/laws_of_files.h"

namespace soapfilm {
namespace TEST_FILE {

int rounds() {
  const char* text = std::getenv("SOAPFILM_FUZZ_ROUNDS");
  return text != nullptr ? std::atoi(text) : 3000;
}

/// Words that are likely to upset a reader, pasted over what was there.
const std::vector<std::string> nasty{"-1",          "0",
                                     "4294967295",  "18446744073709551615",
                                     "nan",         "1e999",
                                     "list",        "\n",
                                     " ",           "element",
                                     "property",    "char",
                                     "double",      "ascii",
                                     "\xff",        "\r\n",
                                     "vertex",      "end_header\n",
                                     "-2147483648", "#",
                                     "ply\n"};

std::string mutated(const std::string& original, Random& random) {
  const auto below = [&random](size_t n) { return static_cast<size_t>(random.next() % std::max<size_t>(n, 1)); };
  std::string bytes = original;
  const size_t changes = 1 + below(4);
  for (size_t i = 0; i < changes && !bytes.empty(); ++i) {
    // The head decides most: half of the changes go there.
    const size_t at = random.next() % 2 == 0 ? below(bytes.size()) : below(std::min<size_t>(bytes.size(), 400));
    switch (random.next() % 7) {
      case 0:
        bytes[at] = static_cast<char>(random.next());
        break;
      case 1:
        bytes[at] = static_cast<char>(bytes[at] ^ (1 << random.next() % 8));
        break;
      case 2:
        bytes.resize(at);
        break;
      case 3:
        bytes.erase(at, 1 + below(20));
        break;
      case 4:
        bytes.insert(at, bytes.substr(below(bytes.size()), 1 + below(60)));
        break;
      case 5:
        bytes.insert(at, nasty[below(nasty.size())]);
        break;
      default: {
        const std::string& word = nasty[below(nasty.size())];
        bytes.replace(at, word.size(), word);
      }
    }
  }
  return bytes;
}

struct Outcome {
  int read = 0;
  int refused = 0;
};

/// Reads `count` changed versions of a file.
template <class Read>
Outcome fuzz(const TemporaryFolder& folder, const std::string& name, uint64_t seed, Read&& read) {
  Random random(seed);
  const std::string original = folder.read(name);
  Outcome outcome;
  for (int i = 0; i < rounds(); ++i) {
    const std::string path = folder.write("changed-" + name, mutated(original, random));
    try {
      read(path);
      ++outcome.read;
    } catch (const InputError& error) {
      ++outcome.refused;
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
    }
  }
  EXPECT_GT(outcome.refused, 0) << name;
  return outcome;
}

/// What was accepted must hang together.
void check_cloud(const PointCloud& cloud) { ASSERT_EQ(test::broken_law(cloud), ""); }
void check_mesh(const Mesh& mesh) { ASSERT_EQ(test::broken_law(mesh), ""); }

TEST(Fuzz, PlyPoints) {
  const TemporaryFolder folder;
  Outcome all;
  for (const bool ascii : {false, true})
    for (const int scans : {1, 2}) {
      WriteOptions options;
      options.ascii = ascii;
      write_points(folder / "cloud.ply", rich_cloud(scans, 4, 3, 2), options);
      const Outcome outcome = fuzz(folder, "cloud.ply", static_cast<uint64_t>(100 + 2 * scans + ascii),
                                   [](const std::string& path) { check_cloud(read_points(path)); });
      all.read += outcome.read;
    }
  EXPECT_GT(all.read, 0);
}

TEST(Fuzz, Meshes) {
  const TemporaryFolder folder;
  Outcome all;
  uint64_t seed = 200;
  for (const char* name : {"m.ply", "m.obj", "m.stl"})
    for (const bool ascii : {false, true}) {
      WriteOptions options;
      options.ascii = ascii;
      write_mesh(folder / name, torus_mesh(4, 1), options);
      all.read += fuzz(folder, name, ++seed, [](const std::string& path) { check_mesh(read_mesh(path)); }).read;
    }
  folder.write("m.off",
               "COFF\n4 4 6\n0 0 0 1 2 3 4\n1 0 0 1 2 3 4\n0 1 0 1 2 3 4\n0 0 1 0.1 0.2 0.3 1\n3 0 2 1\n"
               "3 0 1 3\n3 1 2 3\n3 0 3 2\n");
  all.read += fuzz(folder, "m.off", ++seed, [](const std::string& path) { check_mesh(read_mesh(path)); }).read;
  EXPECT_GT(all.read, 0);
}

TEST(Fuzz, Text) {
  const TemporaryFolder folder;
  folder.write("p.xyz",
               "//X Y Z Nx Ny Nz R G B\n1 2 3 0 0 1 10 20 30\n4 5 6 0 1 0 10 20 30 # said\n7 8 9 1 0 0 255 0 0\n");
  folder.write("p.pts", "2\n1 2 3 -100 1 2 3\n4 5 6 -100 1 2 3\n1\n7 8 9 5 1 2 3\n");
  folder.write("p.csv", "\"x\",\"y\",\"z\",sx,sy,sz,weight,note\n1.5,2,3,,,,1,\"a, b\"\n4,5,6,0,1,NA,2,\n");
  folder.write("p.txt", "1;1,5;2,25;3,125\r\n2;1,5;2,5;3\r\n3;1;2;1e3\r\n4;2;2,5;-3\r\n");
  folder.write("p.pwn", "2\n1 2 3\n4 5 6\n0 0 1\n0 0.6 -0.8\n");
  uint64_t seed = 300;
  for (const char* name : {"p.xyz", "p.pts", "p.csv", "p.txt", "p.pwn"}) {
    check_cloud(read_points(folder / name));
    fuzz(folder, name, ++seed, [](const std::string& path) { check_cloud(read_points(path)); });
  }
}

TEST(Fuzz, ScanSets) {
  const TemporaryFolder folder;
  write_points(folder / "a.ply", rich_cloud(1, 3, 3, 4));
  folder.write("b.xyz", "1 2 3\n");
  folder.write("set.conf", "camera 0 0 0\nbmesh a.ply 1 2 3 0 0 0 1\nbmesh b.xyz 1e3 2 3 0.6 0 0 0.8\n");
  fuzz(folder, "set.conf", 400, [](const std::string& path) { check_cloud(read_points(path)); });
}

TEST(Fuzz, LasAndItsTrajectory) {
  const TemporaryFolder folder;
  ReadOptions options;
  options.trajectory = folder.write("way.txt", "time x y z\n0 1 2 3\n2 3 4 5\n");
  LasFile file;
  file.minor = 4;
  file.format = 10;
  file.records = {LasFile::record("LASF_Projection", 34735, bytes_of<uint16_t>({1, 1, 0, 1, 3072, 0, 1, 26915})),
                  LasFile::record("LASF_Spec", 4, LasFile::extra("a", 3, 8, 0.1) + LasFile::extra("b", 1))};
  file.extended_records = {LasFile::record("LASF_Projection", 2112, "PROJCS[]", true)};
  for (int i = 0; i < 5; ++i) {
    file.points.push_back({{i, 2 * i, 7}, 1, 2, 17, i == 3, 0.5 * i, {1, 2, 3}, 4, "abc"});
  }
  const std::string las = folder.write("p.las", file.bytes());
  fuzz(folder, "p.las", 500,
       [&](const std::string& path) { check_cloud(read_points(path, nullptr, Context(1), options)); });
  file.extended_records.clear();
  folder.write("p.laz", laz_of(file.bytes(), {.chunk_points = 3}));
  fuzz(folder, "p.laz", 502,
       [&](const std::string& path) { check_cloud(read_points(path, nullptr, Context(1), options)); });
  fuzz(folder, "way.txt", 501, [&](const std::string& path) {
    ReadOptions changed;
    changed.trajectory = path;
    check_cloud(read_points(las, nullptr, Context(1), changed));
  });
}

TEST(Fuzz, SweepsAndArrays) {
  const TemporaryFolder folder;
  folder.write("a.bin", bytes_of<float>({1, 2, 3, 0.5, 4, 5, 6, 1, 7, 8, 9, 1, 1, 5, 3, 0, 2, 8, 7, 1}));
  const auto npy = [&](const char* name, const std::string& head, const std::string& data) {
    folder.write(name, std::string("\x93NUMPY\x01\0", 8) + bytes_of(static_cast<uint16_t>(head.size())) + head + data);
  };
  npy("b.npy", "{'descr': '<f4', 'fortran_order': True, 'shape': (2, 7), }",
      bytes_of<float>({1, 2, 3, 4, 5, 6, 1, 0, 0, 1, 0, 0, 7, 8}));
  npy("c.npy",
      "{'descr': [('xyz', '<f4', (3,)), ('', '|V2'), ('q', [('weight', '|u1')]), ('s', '|S1')], "
      "'fortran_order': False, 'shape': (2,), }",
      bytes_of<float>({1, 2, 3}) + "??wS" + bytes_of<float>({4, 5, 6}) + "??xS");
  uint64_t seed = 600;
  for (const char* name : {"a.bin", "b.npy", "c.npy"})
    fuzz(folder, name, ++seed, [](const std::string& path) { check_cloud(read_points(path)); });
}

// Every length of a file: the end may come anywhere.
TEST(Fuzz, EveryTruncation) {
  const TemporaryFolder folder;
  for (const bool ascii : {false, true}) {
    WriteOptions options;
    options.ascii = ascii;
    write_points(folder / "cloud.ply", rich_cloud(1, 3, 2, 2), options);
    const std::string whole = folder.read("cloud.ply");
    for (size_t length = 0; length + 2 < whole.size(); ++length) {
      const std::string path = folder.write("cut.ply", whole.substr(0, length));
      EXPECT_THROW(read_points(path), InputError) << length;
    }
  }
}

}  // namespace TEST_FILE
}  // namespace soapfilm
