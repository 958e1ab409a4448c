// Outputs are whole or absent.
#include <signal.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <string>
#include <thread>

#include "files.h"
#include "samples.h"
#include "soapfilm/io.h"
#include "soapfilm/io/bytes/atomic_file.h"
#include "soapfilm/io/files.h"
#include "soapfilm/platform/new_file.h"

namespace soapfilm {
namespace TEST_FILE {

TEST(AtomicFile, AppearsOnlyWhenCommitted) {
  const TemporaryFolder folder;
  {
    io::AtomicFile file(folder / "out.txt");
    file.append("abc");
    EXPECT_FALSE(std::filesystem::exists(folder / "out.txt"));
  }
  EXPECT_EQ(folder.file_count(), 0u);
  io::AtomicFile file(folder / "out.txt");
  file.append("abc");
  file.commit();
  EXPECT_EQ(folder.read("out.txt"), "abc");
  EXPECT_EQ(folder.file_count(), 1u);
}

TEST(AtomicFile, AFailureLeavesTheOldFile) {
  const TemporaryFolder folder;
  folder.write("m.ply", "precious");
  Mesh mesh = torus_mesh(4, 1);
  WriteOptions options;
  options.comments = {"two\nlines"};
  EXPECT_THROW(write_mesh(folder / "m.ply", mesh, options), ParameterError);
  EXPECT_THROW(write_mesh(folder / "m.obj", mesh, options), ParameterError);
  {
    io::AtomicFile file(folder / "m.ply");
    file.append("half");
  }
  EXPECT_EQ(folder.read("m.ply"), "precious");
  EXPECT_EQ(folder.file_count(), 1u);
}

TEST(AtomicFile, LargeAndSmallPiecesKeepTheirOrder) {
  const TemporaryFolder folder;
  std::string expected;
  io::AtomicFile file(folder / "big.txt");
  Random random(5);
  for (int i = 0; i < 200; ++i) {
    const std::string piece(static_cast<size_t>(random.uniform(0, i % 50 == 0 ? 700000 : 9000)),
                            static_cast<char>('a' + i % 26));
    expected += piece;
    file.append(piece);
  }
  file.commit();
  EXPECT_TRUE(folder.read("big.txt") == expected);
}

TEST(AtomicFile, ASymbolicLinkStaysALink) {
  const TemporaryFolder folder;
  folder.write("target.txt", "old");
  std::filesystem::create_symlink(folder / "target.txt", folder / "link.txt");
  write_text_file(folder / "link.txt", "new");
  EXPECT_TRUE(std::filesystem::is_symlink(folder / "link.txt"));
  EXPECT_EQ(folder.read("target.txt"), "new");
}

TEST(AtomicFile, APipeIsWrittenToDirectly) {
  const TemporaryFolder folder;
  ASSERT_EQ(::mkfifo((folder / "pipe.ply").c_str(), 0600), 0);
  const PointCloud cloud = rich_cloud(1, 90, 90, 1);
  std::thread writer([&] {
    check_output(folder / "pipe.ply");  // before a long run: the reader waits on
    write_points(folder / "pipe.ply", cloud);
  });
  const PointCloud read = read_points(folder / "pipe.ply");
  writer.join();
  EXPECT_EQ(read.positions, cloud.positions);
  EXPECT_TRUE(std::filesystem::is_fifo(folder / "pipe.ply"));
}

TEST(AtomicFile, UnwritablePlacesAreRefused) {
  const TemporaryFolder folder;
  const Mesh mesh = torus_mesh(4, 1);
  for (const char* name : {"m.ply", "m.obj", "m.stl"})
    expect_refusal<OutputError>([&] { write_mesh(folder / "none" + ("/" + std::string(name)), mesh); },
                                {name, "cannot be written", "No such file"});
  std::filesystem::create_directory(folder / "dir.ply");
  expect_refusal<OutputError>([&] { write_mesh(folder / "dir.ply", mesh); }, {"dir.ply", "is a directory"});
  expect_refusal<OutputError>([&] { check_output(folder / "none/report.json"); }, {"report.json", "No such file"});
  expect_refusal<OutputError>([&] { write_text_file("/dev/full", "text"); }, {"/dev/full", "No space left"});
  check_output(folder / "fine.json");
  check_mesh_output(folder / "fine.stl");
  EXPECT_EQ(folder.file_count(), 1u);
}

TEST(AtomicFile, TemporaryFilesGoOnTheWayOutOfAProcess) {
  const TemporaryFolder folder;
  io::AtomicFile first(folder / "a.txt"), second(folder / "b.txt");
  for (io::AtomicFile* file : {&first, &second}) {
    file->append("abc");
    file->finish();
    file->close_until_commit();
  }
  write_text_file(folder / "done.txt", "done");
  EXPECT_EQ(folder.file_count(), 3u);
  first.commit();
  EXPECT_EQ(folder.read("a.txt"), "abc");
  EXPECT_EQ(folder.file_count(), 3u);
  remove_temporary_files();
  EXPECT_EQ(folder.file_count(), 2u);
}

TEST(AtomicFile, NothingIsLeftOfAProcessThatIsKilled) {
  const TemporaryFolder folder;
  const int unnamed = open_unnamed_file(folder / ".", 0600);
  if (unnamed < 0) GTEST_SKIP() << "this file system has no files without a name";
  ::close(unnamed);
  folder.write("old.txt", "old");
  for (const char* name : {"new.txt", "old.txt"}) {
    const pid_t child = ::fork();
    if (child == 0) {
      io::AtomicFile file(folder / name);
      file.append(std::string(1000000, 'x'));
      file.finish();
      ::raise(SIGKILL);
    }
    int status = 0;
    ASSERT_EQ(::waitpid(child, &status, 0), child);
    EXPECT_TRUE(WIFSIGNALED(status));
    EXPECT_EQ(folder.file_count(), 1u);
    EXPECT_EQ(folder.read("old.txt"), "old");
  }
}

/// Others may replace the same file at the same time: it always has the bytes of one of them.
TEST(AtomicFile, IsReplacedByManyAtOnce) {
  const TemporaryFolder folder;
  const auto write = [&](char c) {
    for (int k = 0; k < 100; ++k) write_text_file(folder / "m.txt", std::string(1000, c));
  };
  write('a');
  std::thread other([&] { write('b'); });
  for (int k = 0; k < 100; ++k) {
    const std::string text = folder.read("m.txt");
    EXPECT_TRUE(text == std::string(1000, 'a') || text == std::string(1000, 'b')) << text.size();
    write_text_file(folder / "m.txt", std::string(1000, 'a'));
  }
  other.join();
  EXPECT_EQ(folder.file_count(), 1u);
}

}  // namespace TEST_FILE
}  // namespace soapfilm
