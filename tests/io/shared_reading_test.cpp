// Files that ranks share: cloud, report and error are those of one process that reads all of them.
#include "soapfilm/io/sets/shared_reading.h"

#include <atomic>
#include <new>
#include <numeric>
#include <set>

#include "files.h"
#include "samples.h"
#include "shared_readings.h"
#include "soapfilm/core/context_state.h"
#include "soapfilm/io.h"
#include "soapfilm/io/sets/read_each.h"
#include "soapfilm/io/sets/scan_set.h"

namespace soapfilm {
namespace TEST_FILE {

using test::on_ranks;

class SharedReading : public testing::Test {
 protected:
  /// Some with all columns, some without one or more of them, of different sizes.
  std::vector<std::string> tiles(size_t count) const {
    std::vector<std::string> paths;
    for (size_t k = 0; k < count; ++k) {
      PointCloud cloud = rich_cloud(1 + static_cast<int>(k % 2), 3, 2 + static_cast<int>(5 * k % 7), 40 + k);
      if (k % 3 == 1) cloud.normals.clear();
      if (k % 3 == 2) cloud.colors.clear();
      if (k % 4 == 3) cloud.sensors.clear();
      if (k % 4 == 2) cloud.weights.clear();
      if (k % 5 == 1) cloud.columns.pop_back();
      if (k % 5 == 2) cloud.columns.clear();
      if (k % 2 == 1) cloud.scans[0].range_grid.reset();
      paths.push_back(folder / ("tile_" + std::to_string(k) + ".ply"));
      write_points(paths.back(), cloud);
    }
    return paths;
  }
  /// Of a file with a coordinate that is not a number in line 8.
  std::string bad(const std::string& name) const {
    return folder.write(name,
                        "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
                        "property float z\nend_header\n0 one 0\n");
  }

  TemporaryFolder folder;
};

TEST_F(SharedReading, GivesTheCloudAndTheReportOfOneProcess) {
  for (const size_t count : {1, 2, 3, 4, 5, 9}) {
    const std::vector<std::string> paths = tiles(count);
    expect_same_on_all([&](const Context& context) { return read_paths(paths, context); });
  }
  tiles(6);
  folder.write("tile_6.xyz", "0 0 0 1\n1 2 3 4\nnan 0 0 1\n");  // dropped
  expect_same_on_all([&](const Context& context) { return read_paths({folder / "*"}, context); });
}

TEST_F(SharedReading, TakesTheScansOfASet) {
  std::vector<ScanSetEntry> entries;
  for (const std::string& path : tiles(5))
    entries.push_back({std::filesystem::path(path).filename().string(),
                       {{1.0 + static_cast<double>(entries.size()), 2, 3}, {0, 0, 0.6, 0.8}}});
  write_mesh(folder / "mesh.ply", torus_mesh(4, 1));
  entries.push_back({"mesh.ply", {}});
  write_scan_set(folder / "set.conf", entries);
  expect_same_on_all([&](const Context& context) { return read_paths({folder / "set.conf"}, context); });
  expect_same_on_all([&](const Context& context) {
    return read_paths({folder / "set.conf", folder / "tile_1.ply"}, context);
  });

  bad("tile_3.ply");
  bad("tile_1.ply");
  for (const std::string& line :
       lines_of(3, 1, [&](const Context& context) { read_points(folder / "set.conf", nullptr, context); }))
    EXPECT_EQ(line.rfind(folder / "set.conf: " + (folder / "tile_1.ply:8: "), 0), 0u) << line;
}

/// As no format gives them: facts and columns in all combinations, and clouds without samples.
TEST_F(SharedReading, SendsAllThatACloudCanHave) {
  const io::ReadOne read = [](size_t i, ReadReport& report) {
    PointCloud cloud = i % 3 == 1 ? PointCloud{} : rich_cloud(1 + static_cast<int>(i % 2), 4, 3, i);
    cloud.is_survey = i % 5 != 4;
    if (i > 2) cloud.coordinate_system = "EPSG:" + std::to_string(i);
    if (i % 4 == 2) cloud.columns.push_back({"own " + std::to_string(i), std::vector<float>(cloud.size(), 2.5f), true});
    report.files.push_back({"path", std::string(i, 'f'), i, i + 1, i + 2, i + 3, {"", std::string(300, 'p')}});
    for (size_t k = 0; k < i % 3; ++k) report.warnings.push_back("warning " + std::to_string(i));
    return cloud;
  };
  for (const size_t count : {2, 7, 8, 17}) {
    std::vector<uint64_t> file_bytes(count);
    for (size_t i = 0; i < count; ++i) file_bytes[i] = i * 7919 % 1000;
    expect_same_on_all([&](const Context& context) {
      Reading found;
      found.report.warnings = {"one that was there"};
      found.cloud = io::read_each(file_bytes, found.report, context, read);
      return found;
    });
  }
}

TEST_F(SharedReading, ThreadsReadEachFileOnce) {
  for (const size_t count : {2, 5, 16}) {
    std::vector<std::atomic<int>> read(count);
    on_ranks<int>(3, 2, any_cuts, [&](const Context& context) {
      ReadReport report;
      io::read_each(std::vector<uint64_t>(count, 1), report, context, [&](size_t i, ReadReport&) {
        ++read[i];
        return rich_cloud(1, 3, 1, i);
      });
      return 0;
    });
    for (const std::atomic<int>& times : read) EXPECT_EQ(times, 1);
  }
}

TEST_F(SharedReading, TheFirstBadFileIsTheErrorOfAllRanks) {
  const std::vector<std::string> paths = tiles(9);
  bad("tile_7.ply");
  for (const std::string first : {"tile_6.ply", "tile_3.ply", "tile_2.ply", "tile_0.ply"}) {
    bad(first);
    for (int ranks = 2; ranks <= 4; ++ranks)
      for (int threads = 1; threads <= 3; ++threads)
        for (const std::string& line :
             lines_of(ranks, threads, [&](const Context& context) { read_points(paths, nullptr, context); }))
          EXPECT_EQ(line.rfind((folder / first) + ":8: ", 0), 0u) << line;
  }
  std::filesystem::remove(paths[0]);
  for (const std::string& line : lines_of(2, 1, [&](const Context& context) { read_points(paths, nullptr, context); }))
    EXPECT_EQ(line.rfind(paths[0] + ":", 0), 0u) << line;
}

/// Whose exit code and line depend on what it is.
TEST_F(SharedReading, ErrorsStayWhatTheyAre) {
  const auto kind_of = [](const std::function<void()>& call) -> std::string {
    try {
      call();
      return "none";
    } catch (const SamplesError& error) {
      return std::string("samples ") + error.what();
    } catch (const ParameterError& error) {
      return std::string("parameter ") + error.what();
    } catch (const InputError& error) {
      return std::string("input ") + error.what();
    } catch (const OutputError& error) {
      return std::string("output ") + error.what();
    } catch (const MemoryError& error) {
      return std::string("memory ") + error.what();
    } catch (const std::bad_alloc&) {
      return "allocation";
    } catch (const std::exception& error) {
      return std::string("other ") + error.what();
    }
  };
  const std::vector<std::function<void()>> failures{
      [] { throw SamplesError("a"); },    [] { throw ParameterError("b"); }, [] { throw InputError("c"); },
      [] { throw OutputError("d"); },     [] { throw MemoryError("e"); },    [] { throw std::bad_alloc(); },
      [] { throw std::logic_error("f"); }};
  for (const auto& fail : failures) {
    const auto read = [&](const Context& context) {
      return kind_of([&] {
        ReadReport report;
        io::read_each({5, 5, 5}, report, context, [&](size_t i, ReadReport&) {
          if (i == 1) fail();
          return rich_cloud(1, 3, 1, i);
        });
      });
    };
    const std::string expected = kind_of(fail);
    for (const std::string& kind : on_ranks<std::string>(3, 1, any_cuts, read)) EXPECT_EQ(kind, expected);
  }
}

TEST_F(SharedReading, RanksMustHaveTheSameFiles) {
  tiles(3);
  const auto expect_line = [&](const std::function<void(const Context&)>& read) {
    const std::vector<std::string> lines =
        on_ranks<std::string>(3, 1, any_cuts, [&](const Context& context) -> std::string {
          try {
            read(context);
            return "nothing was thrown";
          } catch (const ParameterError& error) {
            return error.what();
          }
        });
    for (const std::string& line : lines)
      EXPECT_EQ(line, "rank 2 has other input files than rank 0: each needs the same command and the same files");
  };
  const auto read_by_rank = [&](const std::vector<std::string>& usual, const std::vector<std::string>& last) {
    expect_line(
        [&](const Context& context) { read_points(ranks_of(context)->rank() == 2 ? last : usual, nullptr, context); });
  };
  const std::vector<std::string> two{folder / "tile_0.ply", folder / "tile_1.ply"};
  read_by_rank(two, {two[0], folder / "tile_2.ply"});
  read_by_rank(two, {two[1], two[0]});
  read_by_rank(two, {two[0]});
  read_by_rank({two[0]}, two);
  read_by_rank(two, {two[0], folder / "none.ply"});

  expect_line([&](const Context& context) {
    ReadOptions options;
    if (ranks_of(context)->rank() == 2) options.columns = "x,y,z";
    io::agreed_file_bytes(two, options, context);
  });
}

TEST(ReadersOfFiles, AreEvenByBytes) {
  Random random(5);
  for (int ranks = 1; ranks <= 6; ++ranks)
    for (int trial = 0; trial < 20; ++trial) {
      std::vector<uint64_t> file_bytes(1 + random.next() % 40);
      for (uint64_t& bytes : file_bytes) bytes = random.next() % 1000;
      const std::vector<int> readers = io::readers_of(file_bytes, ranks);
      ASSERT_EQ(readers.size(), file_bytes.size());
      std::vector<uint64_t> load(static_cast<size_t>(ranks));
      for (size_t i = 0; i < readers.size(); ++i) load.at(static_cast<size_t>(readers[i])) += file_bytes[i];
      const auto [least, most] = std::minmax_element(load.begin(), load.end());
      EXPECT_LE(*most - *least, *std::max_element(file_bytes.begin(), file_bytes.end()));
      for (size_t begin = 0; begin < readers.size(); begin += static_cast<size_t>(ranks)) {
        const auto end = std::min(readers.size(), begin + static_cast<size_t>(ranks));
        const std::set<int> once(readers.begin() + static_cast<long>(begin), readers.begin() + static_cast<long>(end));
        EXPECT_EQ(once.size(), end - begin);
      }
    }
}

}  // namespace TEST_FILE
}  // namespace soapfilm
