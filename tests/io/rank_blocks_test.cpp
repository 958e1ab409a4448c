// A file that ranks write together: the bytes of one process, or none.
#include "soapfilm/io/bytes/rank_blocks.h"

#include <fcntl.h>
#include <sys/resource.h>

#include <csignal>
#include <utility>

#include "files.h"
#include "samples.h"
#include "soapfilm/core/context_state.h"
#include "soapfilm/core/random.h"
#include "soapfilm/error.h"
#include "soapfilm/io/bytes/atomic_file.h"
#include "soapfilm/io/bytes/file_descriptor.h"
#include "soapfilm/io/parts.h"
#include "soapfilm/platform/new_file.h"
#include "support/thread_ranks.h"

namespace soapfilm {
namespace TEST_FILE {

using io::RankBlocks;
using test::on_ranks;
constexpr test::Cuts any_cuts{1};  // slabs do not matter here
constexpr size_t block = RankBlocks::block_bytes;

/// No two of its blocks are the same.
std::string some_bytes(size_t count) {
  Random random(count);
  std::string bytes(count, ' ');
  for (char& c : bytes) c = static_cast<char>(random.next());
  return bytes;
}

/// write(context) on rank 0, while the others help; returns the bytes that rank 0 has sent.
uint64_t write_on_ranks(int ranks, const std::function<void(const Context&)>& write) {
  return on_ranks<uint64_t>(ranks, 1, any_cuts, [&](const Context& context) -> uint64_t {
    Ranks& all = *ranks_of(context);
    if (all.rank() > 0) {
      io::write_blocks(all);
      return 0;
    }
    write(context);
    io::end_blocks(all);
    return all.traffic().bytes;
  })[0];
}

/// In pieces of all sizes.
void append(const std::string& bytes, io::AtomicFile& file) {
  Random random(7);
  const std::string_view all = bytes;
  for (size_t at = 0; at < all.size();) {
    const std::string_view piece = all.substr(at, 1 + random.next() % (at % 2 == 0 ? 3 * block : block / 8));
    file.append(piece);
    at += piece.size();
  }
}

bool has_unnamed_files(const TemporaryFolder& folder) {
  const io::FileDescriptor file(open_unnamed_file(folder / ".", 0600));
  return file.is_open();
}

TEST(RankBlocks, GiveTheBytesOfOneProcess) {
  const TemporaryFolder folder;
  const bool are_shared = has_unnamed_files(folder);
  for (const int ranks : {2, 3, 4, 7, 20})
    for (const size_t size :
         {size_t{0}, size_t{1}, block - 1, block, 2 * block, 7 * block, 16 * block + 1, 33 * block + 5}) {
      const std::string bytes = some_bytes(size);
      const uint64_t sent = write_on_ranks(ranks, [&](const Context& context) {
        io::AtomicFile file(folder / "shared", ranks_of(context));
        append(bytes, file);
        file.commit();
      });
      EXPECT_TRUE(folder.read("shared") == bytes) << ranks << " ranks, " << size << " bytes";
      const size_t writers = std::min<size_t>(static_cast<size_t>(ranks), 16);
      if (!are_shared || size < writers * block) continue;
      EXPECT_GT(sent, (size / block) * block * (writers - 1) / writers - block)
          << "others write all but rank 0's share";
      EXPECT_LT(sent, size);
    }
}

/// Also over an old file, and one that rank 0 writes alone.
TEST(RankBlocks, WriteFilesOneAfterTheOther) {
  const TemporaryFolder folder;
  const std::string first = some_bytes(5 * block), second = some_bytes(4 * block + 3);
  folder.write("second", "old");
  write_on_ranks(3, [&](const Context& context) {
    for (const auto& [name, bytes] : {std::pair{"first", first}, {"second", second}, {"third", std::string("x")}}) {
      io::AtomicFile file(folder / name, ranks_of(context));
      append(bytes, file);
      file.commit();
    }
  });
  EXPECT_TRUE(folder.read("first") == first);
  EXPECT_TRUE(folder.read("second") == second);
  EXPECT_EQ(folder.read("third"), "x");
  EXPECT_EQ(folder.file_count(), 3u);
}

TEST(RankBlocks, MeshesInPartsAreThoseOfOneProcess) {
  const TemporaryFolder alone, shared;
  const Mesh mesh = torus_mesh(600, 1);
  const PartsParams parts{mesh.triangles.size() / 2, {}, {}};
  write_parts(alone / "m.ply", mesh, parts, {}, Context(1));
  write_on_ranks(2, [&](const Context& context) { write_parts(shared / "m.ply", mesh, parts, {}, context); });
  EXPECT_GT(alone.read("m.part_001.ply").size(), 2 * block);
  for (const char* name : {"m.parts.json", "m.part_001.ply", "m.part_002.ply"})
    EXPECT_TRUE(shared.read(name) == alone.read(name)) << name;
  EXPECT_EQ(shared.file_count(), alone.file_count());
}

/// Such as one on another machine, where the path is another file's or none's.
TEST(RankBlocks, ARankWithoutTheFileTakesNoPart) {
  const TemporaryFolder folder;
  const std::string bytes = some_bytes(6 * block), other = some_bytes(10 * block);
  folder.write("other", other);
  folder.write("as large as a mark", std::string(16, 'x'));
  for (const char* path : {"other", "as large as a mark", "absent", "."}) {
    const uint64_t sent = write_on_ranks(3, [&](const Context& context) {
      const io::FileDescriptor file(::open((folder / "file").c_str(), O_RDWR | O_CREAT | O_TRUNC, 0600));
      RankBlocks blocks(*ranks_of(context), file.get(), folder / path, false);
      EXPECT_EQ(blocks.append(bytes), 0);
      EXPECT_EQ(blocks.writers(), 1u);
      EXPECT_EQ(blocks.finish(), 0);
    });
    EXPECT_TRUE(folder.read("file") == bytes) << path;
    EXPECT_TRUE(folder.read("other") == other) << path;
    EXPECT_EQ(folder.read("as large as a mark"), std::string(16, 'x'));
    EXPECT_LT(sent, 2000u) << path;
  }
}

/// Where the file has a name already another rank removes it: rank 0 may have been killed.
TEST(RankBlocks, NothingIsLeftOfARunThatFails) {
  const TemporaryFolder folder;
  const auto write = [&](const Context& context) {
    io::tell_temporary(*ranks_of(context), folder / "file");
    const io::FileDescriptor file(::open((folder / "file").c_str(), O_RDWR | O_CREAT | O_TRUNC, 0600));
    RankBlocks blocks(*ranks_of(context), file.get(), folder / "file", true);
    EXPECT_EQ(blocks.append(some_bytes(2 * block)), 0);
    EXPECT_EQ(blocks.writers(), 2u);
    EXPECT_EQ(blocks.finish(), 0);
  };
  const auto fail = [&](const Context& context) {
    write(context);
    throw InputError("rank 0 goes");
  };
  EXPECT_THROW(write_on_ranks(2, fail), InputError);
  EXPECT_EQ(folder.file_count(), 0u);
  write_on_ranks(2, write);
  EXPECT_TRUE(folder.read("file") == some_bytes(2 * block));
}

/// No file of this process may be larger while it lives.
class LargestFile {
 public:
  explicit LargestFile(rlim_t bytes) : action_(std::signal(SIGXFSZ, SIG_IGN)) {
    ::getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit limit{bytes, before_.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~LargestFile() {
    ::setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, action_);
  }

 private:
  void (*action_)(int);
  rlimit before_{};
};

TEST(RankBlocks, WhatAnotherRankCannotWriteIsAnError) {
  const TemporaryFolder folder;
  if (!has_unnamed_files(folder)) GTEST_SKIP() << "this file system has no files without a name";
  folder.write("mesh", "old");
  const LargestFile limit(block + block / 2);
  const auto write = [&](const Context& context) {
    io::AtomicFile file(folder / "mesh", ranks_of(context));
    file.append(some_bytes(block));
    file.append(some_bytes(block));  // of rank 1: half of it
    file.commit();
  };
  try {
    write_on_ranks(2, write);
    FAIL();
  } catch (const OutputError& error) {
    EXPECT_EQ(std::string(error.what()), folder / "mesh" + ": cannot be written: File too large");
  }
  EXPECT_EQ(folder.read("mesh"), "old");
  EXPECT_EQ(folder.file_count(), 1u);
}

}  // namespace TEST_FILE
}  // namespace soapfilm
