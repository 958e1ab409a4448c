// soapfilm reconstruct --scratch: larger than memory, the same mesh.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/mount.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>
#include <vector>

#include "cli/scratch.h"
#include "soapfilm/core/context_state.h"
#include "support/program.h"
#include "support/sanitized.h"

namespace soapfilm::test {
namespace TEST_FILE {

/// A disk of its own for some megabytes. Only root may make one.
class SmallDisk {
 public:
  explicit SmallDisk(int megabytes) {
    const std::string size = "size=" + std::to_string(megabytes) + "m";
    made_ = mount("tmpfs", folder_.path().c_str(), "tmpfs", 0, size.c_str()) == 0;
  }
  ~SmallDisk() {
    if (made_) umount2(folder_.path().c_str(), MNT_DETACH);
  }
  SmallDisk(const SmallDisk&) = delete;
  SmallDisk& operator=(const SmallDisk&) = delete;
  bool is_made() const { return made_; }
  std::string path() const { return folder_.path().string(); }

 private:
  TemporaryFolder folder_;
  bool made_ = false;
};

class ScratchOption : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_EQ(run({"scan", "knot", "--samples", "120000", "-o", folder.file("scan"), "--quiet"}).exit_code, 0);
    std::filesystem::create_directory(scratch);
  }
  /// A run that has less memory than it needs, but --scratch.
  std::vector<std::string> limited(const std::string& where) const {
    return {"reconstruct", "--resolution", "200", folder.file("scan") + "/samples.ply", "-o", mesh, "--memory",
            memory,        "--scratch",    where};
  }
  const std::string memory = sanitized ? "52M" : "40M";  // sanitized programs move no vectors
  TemporaryFolder folder;
  std::string scratch = folder.file("scratch"), mesh = folder.file("mesh.ply");
};

TEST_F(ScratchOption, GivesTheSameBytesWhereMemoryDoesNotSuffice) {
  std::vector<std::string> arguments = limited(scratch);
  arguments.resize(arguments.size() - 2);
  arguments.emplace_back("-q");
  expect_refused(arguments, "--memory is ");
  EXPECT_FALSE(std::filesystem::exists(mesh));
  arguments.resize(arguments.size() - 3);
  ASSERT_EQ(run(arguments).exit_code, 0);
  const std::string expected = read_file(mesh);
  for (const char* threads : {"1", "2"}) {
    std::filesystem::remove(mesh);
    arguments = limited(scratch);
    arguments.insert(arguments.end(), {"--threads", threads});
    const ProcessResult result = run(arguments);
    ASSERT_EQ(result.exit_code, 0) << result.err;
    EXPECT_TRUE(contains(result.err, " on disk in " + scratch + ", about ")) << result.err;
    EXPECT_TRUE(contains(result.err, " to be read and ")) << result.err;
    EXPECT_TRUE(read_file(mesh) == expected) << threads;
    EXPECT_TRUE(std::filesystem::is_empty(scratch));
  }
}

TEST(MakeRoom, KnowsHowLargeACloudBecomes) {
  const TemporaryFolder folder;
  const auto moves = [&](const std::string& name, uintmax_t bytes, const std::string& input) {
    std::ofstream(folder.file(name)).close();
    std::filesystem::resize_file(folder.file(name), bytes);
    Context context(1);
    context.limit_memory(size_t{256} << 20);  // an eighth is 32 MiB
    bool moved = false;
    context.state().move_vectors = [&](const std::string&) { moved = true; };
    cli::make_room_for({folder.file(input)}, context);
    std::filesystem::remove(folder.file(name));
    return moved;
  };
  std::filesystem::create_directories(folder.file("in"));
  std::ofstream(folder.file("scans.conf")) << "bmesh in/scan.ply 0 0 0 0 0 0 1\n";
  constexpr uintmax_t small = 3 << 20, large = 12 << 20;
  EXPECT_FALSE(moves("tile.las", small, "tile.las"));
  EXPECT_TRUE(moves("tile.las", large, "tile.las"));
  EXPECT_TRUE(moves("tile.laz", small, "tile.laz")) << "compressed";
  EXPECT_FALSE(moves("in/scan.ply", small, "scans.conf"));
  EXPECT_TRUE(moves("in/scan.ply", large, "scans.conf")) << "the set itself is small";
  EXPECT_FALSE(moves("other.ply", large, "scans.conf")) << "not of the set";
}

TEST_F(ScratchOption, RefusesAFolderThatIsNone) {
  for (const std::string& where : {folder.file("absent"), folder.file("scan") + "/samples.ply"}) {
    std::vector<std::string> arguments = limited(where);
    expect_refused(arguments, where);
    EXPECT_FALSE(std::filesystem::exists(mesh));
  }
}

TEST_F(ScratchOption, EndsCleanlyOnDisksOfAnySize) {
  int refused = 0, done = 0;
  for (const int megabytes : {1, 10, 30, 33, 36, 60, 300}) {
    const SmallDisk disk(megabytes);
    if (!disk.is_made()) GTEST_SKIP() << "only root may make a small disk";
    std::filesystem::remove(mesh);
    std::vector<std::string> arguments = limited(disk.path());
    arguments.emplace_back("-q");
    const ProcessResult result = run(arguments);
    EXPECT_TRUE(std::filesystem::is_empty(disk.path()));
    EXPECT_EQ(std::filesystem::exists(mesh), result.exit_code == 0);
    if (result.exit_code == 0) {
      ++done;
      continue;
    }
    ++refused;
    EXPECT_EQ(result.exit_code, 2) << result.err;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    EXPECT_TRUE(contains(result.err, disk.path()) && contains(result.err, " needed, ") && contains(result.err, " free"))
        << result.err;
  }
  EXPECT_GT(refused, 0);
  EXPECT_GT(done, 0);
}

TEST_F(ScratchOption, NothingStaysOfAKilledRun) {
  bool used = false;
  const ProcessResult result = run(limited(scratch), [&](pid_t process) {
    const std::string maps = "/proc/" + std::to_string(process) + "/maps";
    for (int wait = 0; wait < 2000 && !used; ++wait) {
      used = contains(read_file(maps), scratch);
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    kill(process, SIGKILL);
  });
  EXPECT_TRUE(used) << "no array was on disk before the end";
  EXPECT_EQ(result.exit_code, 128 + SIGKILL);
  EXPECT_TRUE(std::filesystem::is_empty(scratch));
  EXPECT_FALSE(std::filesystem::exists(mesh));
}

/// The same with --resume.
class ResumeOption : public ScratchOption {
 protected:
  std::vector<std::string> resuming(const std::string& where) const {
    std::vector<std::string> arguments = limited(where);
    arguments.emplace_back("--resume");
    return arguments;
  }
  /// Of a run without an end before its own.
  std::string expected() {
    EXPECT_EQ(run(limited(scratch)).exit_code, 0);
    std::string bytes = read_file(mesh);
    std::filesystem::remove(mesh);
    return bytes;
  }
};

TEST_F(ResumeOption, NeedsScratch) {
  expect_refused({"reconstruct", folder.file("scan") + "/samples.ply", "-o", mesh, "--resume"}, "--scratch");
}

TEST_F(ResumeOption, GoesOnHoweverOftenItIsKilled) {
  const std::string whole = expected();
  bool kept = false;
  for (int killed = 0; killed < 6; ++killed) {
    const ProcessResult result = run(resuming(scratch), [&](pid_t process) {
      std::this_thread::sleep_for(std::chrono::milliseconds(150 + 350 * killed));
      kill(process, SIGKILL);
    });
    kept = kept || contains(result.err, "resume: ");
    if (result.exit_code == 0) break;  // it was faster
    EXPECT_FALSE(std::filesystem::exists(mesh));
  }
  EXPECT_TRUE(kept || std::filesystem::exists(mesh) || !std::filesystem::is_empty(scratch));
  ASSERT_EQ(run(resuming(scratch)).exit_code, 0);
  EXPECT_TRUE(read_file(mesh) == whole);
  EXPECT_TRUE(std::filesystem::is_empty(scratch));
}

/// Kept stages take no space that the run's arrays need.
TEST_F(ResumeOption, RunsWhereverItRunsWithoutIt) {
  const std::string whole = expected();
  int done = 0;
  for (const int megabytes : {30, 36, 45, 60, 300}) {
    const SmallDisk disk(megabytes);
    if (!disk.is_made()) GTEST_SKIP() << "only root may make a small disk";
    const int without = run(limited(disk.path())).exit_code;
    std::filesystem::remove(mesh);
    const ProcessResult result = run(resuming(disk.path()));
    EXPECT_EQ(result.exit_code, without) << megabytes << result.err;
    if (result.exit_code != 0) continue;
    ++done;
    EXPECT_TRUE(read_file(mesh) == whole) << megabytes;
    EXPECT_TRUE(std::filesystem::is_empty(disk.path())) << megabytes;
  }
  EXPECT_GT(done, 1);
}

/// Open files of a process without a name in a folder, as paths by which they can be opened.
std::vector<std::string> unnamed_files(pid_t process, const std::string& folder) {
  std::vector<std::string> found;
  std::error_code gone;
  for (const auto& file : std::filesystem::directory_iterator("/proc/" + std::to_string(process) + "/fd", gone))
    if (std::filesystem::read_symlink(file.path(), gone).string().starts_with(folder + "/#"))
      found.push_back(file.path().string());
  return found;
}

/// Waits for such a file; false where there is none before the process ends.
bool has_unnamed_file(pid_t process, const std::string& folder) {
  for (int wait = 0; wait < 10000; ++wait) {
    if (!unnamed_files(process, folder).empty()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return false;
}

/// An array of which pages are lost, as on a disk that fails, ends the run; its stages are there.
TEST_F(ResumeOption, GoesOnAfterPagesWereLost) {
  const std::string whole = expected();
  int cut = 0, ended = 0;
  for (int time = 0; time < 4; ++time) {
    const ProcessResult result = run(resuming(scratch), [&](pid_t process) {
      if (!has_unnamed_file(process, scratch)) return;
      std::this_thread::sleep_for(std::chrono::milliseconds(200 * time));
      for (const std::string& file : unnamed_files(process, scratch)) cut += truncate(file.c_str(), 0) == 0;
    });
    if (result.exit_code == 0) {
      EXPECT_TRUE(read_file(mesh) == whole);
      std::filesystem::remove(mesh);
      continue;
    }
    ++ended;
    EXPECT_EQ(result.exit_code, 2) << result.err;
    // Found when the run reads them, or when it writes them into a file.
    EXPECT_TRUE(contains(result.err, "soapfilm: a page of a file in use") || contains(result.err, "Input/output error"))
        << result.err;
    EXPECT_FALSE(std::filesystem::exists(mesh));
  }
  if (cut == 0) GTEST_SKIP() << "this file system has no files without a name";
  EXPECT_GT(ended, 0);
  const ProcessResult last = run(resuming(scratch));
  ASSERT_EQ(last.exit_code, 0) << last.err;
  EXPECT_TRUE(read_file(mesh) == whole);
  EXPECT_TRUE(std::filesystem::is_empty(scratch));
}

TEST_F(ResumeOption, GoesOnAfterTheMeshFoundNoRoom) {
  const std::string whole = expected();
  const SmallDisk disk(1);
  if (!disk.is_made()) GTEST_SKIP() << "only root may make a small disk";
  const std::string elsewhere = mesh;
  for (const bool parts : {false, true}) {
    mesh = disk.path() + "/mesh.ply";
    std::vector<std::string> arguments = resuming(scratch);
    if (parts) arguments.insert(arguments.end(), {"--split", "2000"});
    arguments.emplace_back("-q");
    expect_refused(arguments, "No space left on device");
    EXPECT_TRUE(std::filesystem::is_empty(disk.path()));
  }
  mesh = elsewhere;
  const ProcessResult result = run(resuming(scratch));
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_TRUE(contains(result.err, "resume: refine")) << result.err;
  EXPECT_TRUE(read_file(mesh) == whole);
  EXPECT_TRUE(std::filesystem::is_empty(scratch));
}

/// Ended while the mesh, or its parts, are being written.
TEST_F(ScratchOption, NothingIsLeftOfAMeshHalfWritten) {
  const std::string output = folder.file("output");
  std::filesystem::create_directory(output);
  mesh = output + "/mesh.ply";
  int ended = 0;
  for (const bool parts : {false, true})
    for (const int signal : {SIGKILL, SIGTERM}) {
      std::vector<std::string> arguments = limited(scratch);
      if (parts) arguments.insert(arguments.end(), {"--split", "2000"});
      bool seen = false;
      const ProcessResult result = run(arguments, [&](pid_t process) {
        // At first the program looks whether it may write there.
        seen = has_unnamed_file(process, scratch) && has_unnamed_file(process, output);
        kill(process, signal);
      });
      if (!seen) GTEST_SKIP() << "this file system has no files without a name";
      EXPECT_EQ(std::filesystem::is_empty(output), result.exit_code != 0) << result.err;
      EXPECT_TRUE(std::filesystem::is_empty(scratch));
      ended += result.exit_code != 0;
      std::filesystem::remove_all(output);
      std::filesystem::create_directory(output);
    }
  EXPECT_GT(ended, 1);
}

}  // namespace TEST_FILE
}  // namespace soapfilm::test
