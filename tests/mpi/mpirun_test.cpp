// The program on several processes, started by mpirun.
#include <gtest/gtest.h>
#include <signal.h>

#include <array>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "io/laz_files.h"
#include "soapfilm/core/random.h"
#include "support/process.h"

namespace soapfilm::test {
namespace TEST_FILE {

using Words = std::vector<std::string>;

/// The plain program, or the one that mpirun starts.
Words program(const Words& arguments, const char* path = SOAPFILM_PROGRAM) {
  Words words{path};
  words.insert(words.end(), arguments.begin(), arguments.end());
  return words;
}

/// Of so many processes, of which this machine may have fewer cores.
Words mpirun(int ranks, const Words& arguments, const char* path = SOAPFILM_MPI_PROGRAM) {
  Words words{SOAPFILM_MPIRUN, "--allow-run-as-root", "--oversubscribe", "-n", std::to_string(ranks)};
  for (const std::string& word : program(arguments, path)) words.push_back(word);
  return words;
}

size_t count_of(const std::string& text, const std::string& part) {
  size_t count = 0;
  for (size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
  return count;
}

/// The processes of the program that descend from `ancestor`.
std::vector<pid_t> programs_below(pid_t ancestor) {
  std::vector<pid_t> found;
  const std::filesystem::path tasks = "/proc/" + std::to_string(ancestor) + "/task";
  std::error_code gone;
  for (const auto& task : std::filesystem::directory_iterator(tasks, gone)) {
    std::ifstream children(task.path() / "children");
    for (pid_t child = 0; children >> child;) {
      if (std::filesystem::read_symlink("/proc/" + std::to_string(child) + "/exe", gone).filename() == "soapfilm-mpi")
        found.push_back(child);
      for (const pid_t below : programs_below(child)) found.push_back(below);
    }
  }
  return found;
}

class Mpirun : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_EQ(run_process(program({"scan", "knot", "--samples", "60000", "-o", folder.file("scan"), "-q"})).exit_code,
              0);
  }
  Words reconstruct(const std::string& to, int resolution = 300) const {
    return {"reconstruct",  folder.file("scan") + "/samples.ply", "-o",        folder.file(to),
            "--resolution", std::to_string(resolution),           "--threads", "1"};
  }
  /// What does not depend on the processes.
  nlohmann::json report_of(const std::string& name) const {
    auto json = nlohmann::json::parse(read_file(folder.file(name)));
    for (const char* key : {"seconds", "cpu_seconds", "memory", "ranks", "command"}) json.erase(key);
    return json;
  }
  /// A folder of tiles, each of other samples.
  std::string tiles(int count) const {
    const std::string all = folder.file("tiles");
    std::filesystem::create_directory(all);
    for (int k = 0; k < count; ++k) {
      const std::string seed = std::to_string(k), samples = std::to_string(4000 + 3000 * (k % 3));
      EXPECT_EQ(
          run_process(program({"scan", "knot", "--samples", samples, "--seed", seed, "-o", folder.file(seed), "-q"}))
              .exit_code,
          0);
      std::filesystem::rename(folder.file(seed) + "/samples.ply", all + "/tile_" + seed + ".ply");
    }
    return all;
  }
  /// A LAZ file of a hilly ground, in chunks of 1,000 points.
  static std::string ground() {
    LasFile file;
    file.format = 7;
    file.minor = 4;
    Random random(5);
    for (size_t i = 0; i < 20000; ++i) {
      LasPoint point;
      const double x = 40 * random.uniform(), y = 40 * random.uniform();
      const std::array<double, 3> place{x, y, 2 * std::sin(x / 5) * std::cos(y / 7)};
      for (size_t k = 0; k < 3; ++k) point.xyz[k] = static_cast<int32_t>(1000 * place[k]);
      point.withheld = i % 500 == 7;
      point.source = static_cast<uint16_t>(i / 5000);
      file.points.push_back(point);
    }
    return laz_of(file.bytes(), {.chunk_points = 1000});
  }
  /// The files that are there, but for the scan.
  size_t files() const {
    size_t count = 0;
    for (const auto& entry : std::filesystem::directory_iterator(folder.path())) count += entry.is_regular_file();
    return count;
  }
  /// Starts a run over an old mesh, calls stop() with mpirun's id and the processes, and expects that all of it ends
  /// with a code other than 0 and the old mesh.
  template <class Stop>
  ProcessResult expect_end(Stop&& stop) {
    std::ofstream(folder.file("mesh.ply")) << "old";
    const ProcessResult ended = run_process(mpirun(3, reconstruct("mesh.ply", 500)), [&](pid_t mpi) {
      std::vector<pid_t> running;
      for (int k = 0; k < 400 && running.size() < 3; ++k) {
        std::this_thread::sleep_for(std::chrono::milliseconds(50));
        running = programs_below(mpi);
      }
      std::this_thread::sleep_for(std::chrono::seconds(1));
      stop(mpi, running);
    });
    EXPECT_NE(ended.exit_code, 0);
    EXPECT_EQ(read_file(folder.file("mesh.ply")), "old");
    return ended;
  }
  TemporaryFolder folder;
};

TEST_F(Mpirun, GivesTheBytesOfOneProcess) {
  Words words = reconstruct("alone.ply");
  words.insert(words.end(), {"--report", folder.file("alone.json")});
  ASSERT_EQ(run_process(program(words)).exit_code, 0);
  for (const int ranks : {2, 3}) {
    words = reconstruct("mesh.ply");
    words.insert(words.end(), {"--report", folder.file("mesh.json")});
    const ProcessResult done = run_process(mpirun(ranks, words));
    ASSERT_EQ(done.exit_code, 0) << done.err;
    EXPECT_EQ(read_file(folder.file("mesh.ply")), read_file(folder.file("alone.ply")));
    EXPECT_EQ(report_of("mesh.json"), report_of("alone.json"));
    EXPECT_EQ(count_of(done.err, "triangles"), 1u) << "one process prints";
    const auto of_ranks = nlohmann::ordered_json::parse(read_file(folder.file("mesh.json")))["ranks"];
    ASSERT_EQ(of_ranks.size(), static_cast<size_t>(ranks));
    for (const auto& rank : of_ranks) {
      EXPECT_GT(rank["sent_bytes"].get<size_t>(), 1000000u) << "slabs had borders";
      EXPECT_EQ(rank["seconds"].items().begin().key(), "read");
      EXPECT_LT(rank["exchange_share"].get<double>(), 1);
    }
  }
}

/// Also where a file must have a name from the beginning, as on a network's file system.
TEST_F(Mpirun, RanksWriteTheMeshTogether) {
  ASSERT_EQ(run_process(program(reconstruct("alone.ply"))).exit_code, 0);
  std::filesystem::create_directory(folder.file("out"));
  for (const bool needs_name : {false, true}) {
    const Words variables{"/usr/bin/env", std::string("LD_PRELOAD=") + SOAPFILM_FAULTS,
                          "FAULT_UNDER=" + folder.file("out"), "FAULT_LOG=" + folder.file("calls"),
                          "FAULT_NAMED=" + folder.file(needs_name ? "out" : "")};
    Words words = mpirun(3, reconstruct("out/mesh.ply"));
    words.insert(words.begin(), variables.begin(), variables.end());
    const ProcessResult done = run_process(words);
    ASSERT_EQ(done.exit_code, 0) << done.err;
    EXPECT_TRUE(read_file(folder.file("out/mesh.ply")) == read_file(folder.file("alone.ply")));
    std::set<int> writers;
    std::ifstream calls(folder.file("calls"));
    bool renamed = false;
    int process = 0;
    for (std::string call; calls >> call >> process;) {
      if (call == "write") writers.insert(process);
      renamed = renamed || call == "rename";
    }
    EXPECT_EQ(writers.size(), 3u);
    EXPECT_EQ(renamed, needs_name);
    std::filesystem::remove(folder.file("calls"));
    std::filesystem::remove(folder.file("out/mesh.ply"));
    EXPECT_TRUE(std::filesystem::is_empty(folder.file("out")));
  }
}

/// Ranks write each of the files together, blocks of a MiB.
TEST_F(Mpirun, PartsAndLevelsAreThoseOfOneProcess) {
  for (const bool in_parts : {true, false}) {
    const Words further = in_parts ? Words{"--split", "130000", "--ascii"} : Words{"--simplify", "auto", "--lod", "1"};
    for (const char* name : {"alone", "ranks"}) {
      std::filesystem::create_directory(folder.file(name));
      Words words = reconstruct(std::string(name) + "/mesh.ply", in_parts ? 200 : 100);
      words.insert(words.end(), further.begin(), further.end());
      const ProcessResult done = run_process(name == std::string("alone") ? program(words) : mpirun(2, words));
      ASSERT_EQ(done.exit_code, 0) << done.err;
    }
    size_t files = 0, large = 0;
    for (const auto& entry : std::filesystem::directory_iterator(folder.file("alone"))) {
      const std::string name = entry.path().filename().string();
      EXPECT_EQ(read_file(folder.file("ranks/" + name)), read_file(folder.file("alone/" + name))) << name;
      large += entry.file_size() > size_t{2} << 20;
      ++files;
    }
    EXPECT_GE(files, 2u);
    EXPECT_EQ(large, in_parts ? 2u : 0u) << "smaller ones are written by rank 0 alone";
    for (const auto& entry : std::filesystem::directory_iterator(folder.file("ranks")))
      EXPECT_TRUE(std::filesystem::exists(folder.file("alone") / entry.path().filename())) << entry.path();
    for (const char* name : {"alone", "ranks"}) std::filesystem::remove_all(folder.file(name));
  }
}

/// Each of which one process reads.
TEST_F(Mpirun, TilesGiveTheBytesOfOneProcess) {
  const std::string all = tiles(5);
  std::ofstream(all + "/tile_5.ply") << "ply\nformat ascii 1.0\ncomment a tile of two samples\nelement vertex 3\n"
                                        "property float x\nproperty float y\nproperty float z\nproperty float nx\n"
                                        "property float ny\nproperty float nz\nend_header\n"
                                        "0.4 0 0 1 0 0\nnan 0 0 1 0 0\n0 0.4 0 nan 1 0\n";
  const auto run_on = [&](const std::string& name, int ranks, const std::string& threads) {
    const Words words{"reconstruct", all,     "-o",       folder.file(name + ".ply"), "--resolution", "60",
                      "--threads",   threads, "--report", folder.file(name + ".json")};
    const ProcessResult done = run_process(ranks == 1 ? program(words) : mpirun(ranks, words));
    EXPECT_EQ(done.exit_code, 0) << done.err;
    return done;
  };
  const ProcessResult alone = run_on("alone", 1, "1");
  EXPECT_EQ(count_of(alone.err, "1 of 32003 samples dropped"), 1u) << alone.err;
  for (const int ranks : {2, 3, 4}) {
    const ProcessResult done = run_on("mesh", ranks, ranks == 3 ? "2" : "1");
    EXPECT_EQ(count_of(done.err, "samples dropped"), 1u) << done.err;
    EXPECT_TRUE(read_file(folder.file("mesh.ply")) == read_file(folder.file("alone.ply"))) << ranks;
    EXPECT_EQ(report_of("mesh.json"), report_of("alone.json")) << ranks;
  }
}

TEST_F(Mpirun, OfBadTilesTheFirstIsNamed) {
  const std::string all = tiles(5);
  const auto expect_line = [&](const std::string& tile) {
    const Words words{"reconstruct", all, "-o", folder.file("mesh.ply"), "--report", folder.file("mesh.json")};
    const ProcessResult alone = run_process(program(words));
    EXPECT_EQ(alone.exit_code, 2);
    EXPECT_EQ(count_of(alone.err, all + "/" + tile + ":"), 1u) << alone.err;
    for (const int ranks : {2, 4}) {
      const ProcessResult refused = run_process(mpirun(ranks, words));
      EXPECT_EQ(refused.exit_code, 2);
      EXPECT_EQ(count_of(refused.err, alone.err), 1u) << refused.err << "instead of\n" << alone.err;
      EXPECT_EQ(count_of(refused.err, "soapfilm: "), 1u) << refused.err;
    }
    EXPECT_EQ(files(), 0u);
  };
  for (const char* tile : {"tile_4.ply", "tile_2.ply", "tile_1.ply"}) {
    std::filesystem::resize_file(all + "/" + tile, 5000);
    expect_line(tile);
  }
}

/// Of which each process decodes some chunks. One of them is damaged then.
TEST_F(Mpirun, ASingleLazFileGivesTheBytesOfOneProcess) {
  std::string laz = ground();
  const std::string path = folder.file("ground.laz");
  const auto run_on = [&](const std::string& name, int ranks, const std::string& threads) {
    const Words words{"reconstruct", path,    "-o",       folder.file(name + ".ply"), "--voxel", "0.5",
                      "--threads",   threads, "--report", folder.file(name + ".json")};
    return run_process(ranks == 1 ? program(words) : mpirun(ranks, words));
  };
  std::ofstream(path, std::ios::binary) << laz;
  const ProcessResult whole = run_on("alone", 1, "1");
  ASSERT_EQ(whole.exit_code, 0) << whole.err;
  EXPECT_EQ(count_of(whole.err, "40 of 20000 points are marked as withheld"), 1u) << whole.err;
  for (const int ranks : {2, 3, 5}) {
    const ProcessResult done = run_on("mesh", ranks, ranks == 3 ? "2" : "1");
    ASSERT_EQ(done.exit_code, 0) << done.err;
    EXPECT_EQ(count_of(done.err, "points are marked as withheld"), 1u) << done.err;
    EXPECT_TRUE(read_file(folder.file("mesh.ply")) == read_file(folder.file("alone.ply"))) << ranks;
    EXPECT_EQ(report_of("mesh.json"), report_of("alone.json")) << ranks;
  }
  const auto first = laz::at<uint32_t>(laz, 96) + 8;
  for (size_t k = first + (laz.size() - first) / 2; k < laz.size() - 1000; ++k) laz[k] = '\x5a';
  std::ofstream(path, std::ios::binary) << laz;
  const ProcessResult alone = run_on("mesh", 1, "1");
  EXPECT_EQ(alone.exit_code, 2);
  EXPECT_EQ(count_of(alone.err, "the file is damaged"), 1u) << alone.err;
  for (const int ranks : {2, 3, 5}) {
    const ProcessResult refused = run_on("mesh", ranks, "1");
    EXPECT_EQ(refused.exit_code, 2);
    EXPECT_EQ(count_of(refused.err, alone.err), 1u) << refused.err << "instead of\n" << alone.err;
    EXPECT_EQ(count_of(refused.err, "soapfilm: "), 1u) << refused.err;
  }
}

TEST_F(Mpirun, ThePlainProgramBecomesIt) {
  ASSERT_EQ(run_process(program(reconstruct("alone.ply", 100))).exit_code, 0);
  const ProcessResult done = run_process(mpirun(2, reconstruct("mesh.ply", 100), SOAPFILM_PROGRAM));
  ASSERT_EQ(done.exit_code, 0) << done.err;
  EXPECT_EQ(read_file(folder.file("mesh.ply")), read_file(folder.file("alone.ply")));
  EXPECT_EQ(count_of(done.err, "triangles"), 1u) << "one process prints";
}

TEST_F(Mpirun, RefusesInOneLine) {
  const ProcessResult refused =
      run_process(mpirun(2, {"reconstruct", folder.file("none.ply"), "-o", folder.file("m.ply")}));
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_EQ(count_of(refused.err, "soapfilm: "), 1u) << refused.err;
  Words words = mpirun(1, reconstruct("m.ply", 100)), second = reconstruct("m.ply", 100);
  second.insert(second.end(), {"--voxel", "-1"});
  words.insert(words.end(), {":", "-n", "1"});
  for (const std::string& word : program(second, SOAPFILM_MPI_PROGRAM)) words.push_back(word);
  const ProcessResult elsewhere = run_process(words);
  EXPECT_EQ(elsewhere.exit_code, 2);
  EXPECT_EQ(count_of(elsewhere.err, "soapfilm: "), 1u) << elsewhere.err;
  EXPECT_EQ(count_of(elsewhere.err, "soapfilm: rank 1: "), 1u) << elsewhere.err;
  const ProcessResult stream = run_process(mpirun(2, {"reconstruct", "-", "-o", folder.file("m.ply")}));
  EXPECT_EQ(stream.exit_code, 2);
  EXPECT_EQ(count_of(stream.err, "soapfilm: standard input"), 1u) << stream.err;
}

TEST_F(Mpirun, RanksMustAgree) {
  const auto scan = [&](const std::string& to, const char* samples, const char* seed) {
    ASSERT_EQ(run_process(program({"scan", "knot", "--samples", samples, "--seed", seed, "-o", folder.file(to), "-q"}))
                  .exit_code,
              0);
  };
  scan("other", "60000", "2");
  scan("less", "50000", "2");
  const auto in_folder = [&](const std::string& place, const Words& options) {
    Words words{"-n", "1", "--wdir", folder.file(place)};
    for (const std::string& word :
         program({"reconstruct", "samples.ply", "-o", folder.file("mesh.ply"), "--resolution", "100", "--threads", "1"},
                 SOAPFILM_MPI_PROGRAM))
      words.push_back(word);
    words.insert(words.end(), options.begin(), options.end());
    return words;
  };
  const auto expect_line = [&](const std::string& line, const std::string& place, const Words& options) {
    Words words{SOAPFILM_MPIRUN, "--allow-run-as-root", "--oversubscribe"};
    for (const std::string& word : in_folder("scan", {})) words.push_back(word);
    words.emplace_back(":");
    for (const std::string& word : in_folder(place, options)) words.push_back(word);
    const ProcessResult refused = run_process(words);
    EXPECT_EQ(refused.exit_code, 2);
    EXPECT_EQ(count_of(refused.err, line), 1u) << refused.err;
    EXPECT_EQ(count_of(refused.err, "soapfilm: "), 1u) << refused.err;
  };
  expect_line("soapfilm: rank 1 has other samples than rank 0: each needs the same", "other", {});
  expect_line("soapfilm: rank 1 has other parameters than rank 0: each needs", "other", {"--lambda", "0.1"});
  expect_line("soapfilm: rank 1 has other input files than rank 0: each needs", "scan", {"../less/samples.ply"});
  expect_line("soapfilm: samples.ply: of this file rank 1 has ", "less", {});
  std::filesystem::remove(folder.file("less") + "/samples.ply");
  expect_line("soapfilm: samples.ply: of this file rank 1 has none, rank 0 ", "less", {});
  EXPECT_EQ(files(), 0u);
}

TEST_F(Mpirun, ARankThatIsKilledEndsAll) {
  for (const size_t rank : {0, 1, 2}) {
    expect_end([&](pid_t, const std::vector<pid_t>& running) {
      ASSERT_EQ(running.size(), 3u);
      kill(running[rank], SIGKILL);
    });
    EXPECT_EQ(files(), 1u) << "nothing else is left";
  }
}

/// It says so in one line, and what is on its way between the others does no harm.
TEST_F(Mpirun, ARankThatIsAskedToEndEndsAll) {
  for (const size_t rank : {0, 1, 2}) {
    const ProcessResult ended = expect_end([&](pid_t, const std::vector<pid_t>& running) {
      ASSERT_EQ(running.size(), 3u);
      kill(running[rank], SIGTERM);
    });
    EXPECT_EQ(ended.exit_code, 130) << ended.err;
    EXPECT_EQ(count_of(ended.err, "cancelled"), 1u) << ended.err;
    EXPECT_EQ(files(), 1u) << "nothing else is left";
  }
}

/// Each rank goes on from its own stages, as far as all have them.
TEST_F(Mpirun, GoesOnAfterARankWasKilled) {
  const std::filesystem::path scratch = folder.file("scratch");
  std::filesystem::create_directory(scratch);
  const auto kept = [&](const std::string& stage) {
    std::vector<std::filesystem::path> found;
    for (const auto& file : std::filesystem::directory_iterator(scratch))
      if (file.path().string().ends_with(stage + ".stage")) found.push_back(file.path());
    return found;
  };
  Words words = reconstruct("mesh.ply");
  ASSERT_EQ(run_process(program(words)).exit_code, 0);
  const std::string expected = read_file(folder.file("mesh.ply"));
  std::filesystem::remove(folder.file("mesh.ply"));
  words.insert(words.end(), {"--scratch", scratch.string(), "--resume"});
  const ProcessResult ended = run_process(mpirun(2, words), [&](pid_t mpi) {
    for (int k = 0; k < 4000 && kept("level_0").size() < 2; ++k)
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    const std::vector<pid_t> running = programs_below(mpi);
    if (!running.empty()) kill(running.back(), SIGKILL);
  });
  EXPECT_NE(ended.exit_code, 0);
  EXPECT_EQ(files(), 0u);
  ASSERT_EQ(kept("level_0").size(), 2u);
  std::filesystem::remove(kept("level_1")[0]);
  const ProcessResult done = run_process(mpirun(2, words));
  ASSERT_EQ(done.exit_code, 0) << done.err;
  EXPECT_EQ(count_of(done.err, "resume: level_0 from"), 1u) << done.err;
  EXPECT_EQ(count_of(done.err, "resume: level_1 from"), 0u) << done.err;
  EXPECT_TRUE(read_file(folder.file("mesh.ply")) == expected);
  EXPECT_TRUE(std::filesystem::is_empty(scratch));
}

TEST_F(Mpirun, CtrlCEndsAll) {
  expect_end([&](pid_t mpi, const std::vector<pid_t>&) { kill(mpi, SIGINT); });
  EXPECT_EQ(files(), 1u) << "nothing else is left";
}

}  // namespace TEST_FILE
}  // namespace soapfilm::test
