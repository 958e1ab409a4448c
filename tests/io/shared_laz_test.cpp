// LAZ files whose chunks ranks share: cloud, report and error are those of one process that decodes all of them.
#include "copc_files.h"
#include "files.h"
#include "laz_files.h"
#include "laz_reading.h"
#include "laz_records.h"
#include "shared_readings.h"
#include "soapfilm/core/context_state.h"
#include "soapfilm/io.h"
#include "support/real_data.h"
#include "support/sanitized.h"

namespace soapfilm {
namespace TEST_FILE {

using test::on_ranks;

struct Group {
  int ranks, threads;
  test::Cuts cuts;  ///< also where a round's chunks are cut
};
const std::vector<Group> groups{{1, 1, {1}}, {1, 2, {1}}, {2, 1, {1}}, {2, 2, {2}}, {3, 1, {3}}, {3, 2, {4}},
                                {4, 1, {5}}, {4, 2, {6}}, {7, 1, {7}}, {7, 1, {8}}, {7, 2, {9}}};

/// Expects on every rank what one process gives.
void expect_same(const std::function<std::string(const Context&)>& run) {
  const std::string alone = run(Context(1));
  EXPECT_TRUE(run(Context(3)) == alone);
  for (size_t k = 0; k < groups.size(); k += test::sanitized ? 3 : 1) {
    const Group& group = groups[k];
    for (const std::string& of_rank : on_ranks<std::string>(group.ranks, group.threads, group.cuts, run))
      EXPECT_TRUE(of_rank == alone) << group.ranks << " ranks, " << group.threads << " threads, cut "
                                    << group.cuts.seed;
  }
}

/// What is read, or the line and kind of the error.
std::string outcome_of(const std::string& path, const Context& context, const ReadOptions& options = {}) {
  try {
    Reading found;
    found.cloud = read_points(std::vector{path}, &found.report, context, options);
    return found.text();
  } catch (const ParameterError& error) {
    return std::string("parameter: ") + error.what();
  } catch (const InputError& error) {
    return std::string("input: ") + error.what();
  }
}

std::string records_or_error(const std::string& laz, const Context& context, size_t most_bytes = size_t{32} << 20) {
  try {
    return records_of(laz, context, most_bytes);
  } catch (const InputError& error) {
    return error.what();
  }
}

/// With another number of points at the head of a chunk: formats 6 to 10.
void damage(std::string& laz, const io::LazChunk& chunk) {
  char& count = laz[static_cast<size_t>(chunk.begin) + laz::at<uint16_t>(laz, 105)];
  count = static_cast<char>(count + 1);
}

TEST(SharedLaz, GivesTheCloudAndTheReportOfOneProcess) {
  const TemporaryFolder folder;
  for (int format = 0; format <= 10; ++format)
    for (const uint16_t version : versions_of(format)) {
      SCOPED_TRACE(testing::Message() << "format " << format << ", version " << version);
      const std::string laz = laz_of(survey(format, 1200).bytes(), {.chunk_points = 50, .version = version});
      const std::string path = folder.write("a.laz", laz);
      EXPECT_EQ(read_points(path).size(), 1029u);
      expect_same([&](const Context& context) { return outcome_of(path, context); });
    }
}

/// And it is worth it: with even cuts a large part of it comes from others.
TEST(SharedLaz, RanksSendEachRecordOnce) {
  const std::string las = random_las(3, 9000, 4, 3), laz = laz_of(las, {.chunk_points = 300});
  test::expect_same_on_ranks<std::string>([&](const Context& context) { return records_of(laz, context); });
  for (const int ranks : {2, 3, 5}) {
    const auto sent = on_ranks<uint64_t>(ranks, 1, {}, [&](const Context& context) {
      records_of(laz, context);
      return ranks_of(context)->traffic().bytes;
    });
    const uint64_t all = 9000 * laz::at<uint16_t>(las, 105), others = static_cast<uint64_t>(ranks) - 1;
    uint64_t sum = 0;
    for (const uint64_t of_rank : sent) {
      sum += of_rank;
      EXPECT_LT(of_rank, (all / static_cast<uint64_t>(ranks) + all / 10) * others);
    }
    EXPECT_GE(sum, all * others);
    EXPECT_LT(sum, all * others + 20000);
  }
}

/// No other looks at it: one that has it damaged alone does no harm.
TEST(SharedLaz, EachChunkIsDecodedByOneRank) {
  constexpr int ranks = 3;
  for (const int format : {1, 7}) {
    const std::string las = random_las(format, 1200, 0, 9), laz = laz_of(las, {.chunk_points = 100});
    const std::vector<io::LazChunk> chunks = chunks_of(laz);
    ASSERT_EQ(chunks.size(), 12u);  // two rounds of six
    const std::string whole = records_of(laz);
    for (const io::LazChunk& chunk : chunks) {
      std::string broken = laz;
      const auto head = laz::at<uint16_t>(laz, 105) + size_t{4}, size = static_cast<size_t>(chunk.bytes) - head;
      broken.replace(static_cast<size_t>(chunk.begin) + head, size, size, '\x5a');
      int others = 0;
      for (int bad = 0; bad < ranks; ++bad) {
        const auto found = on_ranks<std::string>(ranks, 1, any_cuts, [&](const Context& context) {
          return records_or_error(ranks_of(context)->rank() == bad ? broken : laz, context);
        });
        EXPECT_EQ(found, std::vector<std::string>(ranks, found[0])) << "all have the same";
        others += found[0] != whole;
      }
      EXPECT_EQ(others, 1) << "chunk from point " << chunk.first << ", format " << format;
    }
  }
}

TEST(SharedLaz, ChunksOfAllKindsAreShared) {
  const auto expect_records = [](const std::string& las, const LazWriting& writing, size_t most_bytes) {
    SCOPED_TRACE(testing::Message() << writing.chunk_points << " points, " << most_bytes << " bytes at once");
    const std::string laz = laz_of(las, writing);
    expect_same([&](const Context& context) { return records_of(laz, context, most_bytes); });
  };
  for (const int format : {3, 7}) {
    const std::string las = random_las(format, 150, 3, 17);
    for (const uint32_t points : {1u, 2u, 49u, 100u, 150u, 151u})
      for (const size_t most_bytes : {size_t{1} << 20, size_t{2000}, size_t{1}})  // 50 points, and one
        expect_records(las, {.chunk_points = points}, most_bytes);
    expect_records(las, {.chunks = {3, 20, 0, 1, 126}}, size_t{1} << 20);
    expect_records(las, {.chunks = {3, 20, 0, 100, 7, 5, 15}, .streamed = true}, 2000);
  }
}

TEST(SharedLaz, LevelsOfCopcAreShared) {
  const TemporaryFolder folder;
  const std::string path = folder.write("a.copc.laz", copc_file(2));
  for (const double spacing : {0., 2., 8.}) {
    ReadOptions options;
    options.spacing = spacing;
    expect_same([&](const Context& context) { return outcome_of(path, context, options); });
  }
}

TEST(SharedLaz, TheFirstDamagedChunkIsTheErrorOfAllRanks) {
  const TemporaryFolder folder;
  const std::string laz = laz_of(survey(7, 1200).bytes(), {.chunk_points = 50});
  const std::vector<io::LazChunk> chunks = chunks_of(laz);
  for (const size_t first : {0, 1, 4, 11, 23}) {
    std::string bytes = laz;
    for (size_t k = first; k < chunks.size(); k += 1 + k % 4) damage(bytes, chunks[k]);
    const std::string path = folder.write("a.laz", bytes);
    const std::string alone = outcome_of(path, Context(1));
    EXPECT_EQ(alone.rfind("input: " + path + ": byte " + std::to_string(chunks[first].begin) + ":", 0), 0u) << alone;
    expect_same([&](const Context& context) { return outcome_of(path, context); });
  }
  // A large one, after some that are shared, on all ranks or on one.
  const std::string whole = laz_of(random_las(6, 150, 0, 17), {.chunks = {20, 20, 100, 10}});
  std::string bytes = whole;
  damage(bytes, chunks_of(bytes)[2]);
  const std::string line = records_or_error(bytes, Context(1), 1500);
  EXPECT_NE(line.find("does not hold its 100 points"), std::string::npos);
  expect_same([&](const Context& context) { return records_or_error(bytes, context, 1500); });
  for (const std::string& of_rank : on_ranks<std::string>(3, 1, any_cuts, [&](const Context& context) {
         return records_or_error(ranks_of(context)->rank() == 1 ? bytes : whole, context, 1500);
       }))
    EXPECT_EQ(of_rank, line);
}

/// However many chunks are decoded at once.
TEST(SharedLaz, OfSampleAndChunkTheFirstIsTheError) {
  const TemporaryFolder folder;
  LasFile file = survey(7, 1200);
  file.records = {LasFile::record("LASF_Spec", 4, LasFile::extra("weight", 9))};
  for (size_t i = 0; i < file.points.size(); ++i) file.points[i].extra = bytes_of(i == 520 ? -1.0f : 1.0f);  // chunk 10
  const std::string laz = laz_of(file.bytes(), {.chunk_points = 50});
  const std::vector<io::LazChunk> chunks = chunks_of(laz);
  for (const size_t chunk : {4, 9, 11, 12, 20}) {
    std::string bytes = laz;
    damage(bytes, chunks[chunk]);
    const std::string path = folder.write("a.laz", bytes);
    const std::string alone = outcome_of(path, Context(1));
    EXPECT_NE(alone.find(chunk < 10 ? "does not hold its 50 points" : "weight = -1"), std::string::npos) << alone;
    expect_same([&](const Context& context) { return outcome_of(path, context); });
  }
}

TEST(SharedLaz, RanksMustHaveTheSameFile) {
  const TemporaryFolder folder;
  const auto expect_line = [&](const std::string& usual, const std::string& last) {
    const std::vector<std::string> paths{folder.write("a.laz", usual), folder.write("b.laz", last)};
    const auto lines = on_ranks<std::string>(3, 1, any_cuts, [&](const Context& context) -> std::string {
      try {
        read_points(paths[ranks_of(context)->rank() == 2 ? 1 : 0], nullptr, context);
        return "nothing was thrown";
      } catch (const ParameterError& error) {
        return error.what();
      }
    });
    for (const std::string& line : lines)
      EXPECT_EQ(line, "rank 2 has other input files than rank 0: each needs the same command and the same files");
  };
  const LazWriting writing{.chunk_points = 100};
  const std::string laz = laz_of(random_las(3, 900, 0, 1), writing);
  std::string moved = laz;
  put(moved, 155, 17.0);  // the offset of x
  expect_line(laz, moved);
  expect_line(moved, laz);
  expect_line(laz, laz_of(random_las(3, 900, 0, 2), writing));  // the same head, chunks of other sizes
}

TEST(SharedLaz, RanksMayHaveDifferentNumbersOfThreads) {
  const std::string laz = laz_of(random_las(8, 900, 0, 1), {.chunk_points = 20});
  expect_same([&](const Context& context) {
    const Ranks* const ranks = ranks_of(context);
    const Context own(ranks ? 1 + ranks->rank() % 3 : 1);
    own.state().ranks = context.state().ranks;
    return records_of(laz, own);
  });
}

/// Such as one of several files, which another rank does not read.
TEST(SharedLaz, WithinAStageNothingIsSent) {
  const std::string las = random_las(3, 900, 0, 1), laz = laz_of(las, {.chunk_points = 100});
  for (const uint64_t sent : on_ranks<uint64_t>(2, 1, any_cuts, [&](const Context& context) {
         EXPECT_EQ(records_of(laz, alone(context)), records_of(las));
         return ranks_of(context)->traffic().bytes;
       }))
    EXPECT_EQ(sent, 0u);
}

TEST(SharedLaz, RealFilesAreReadAsByOneProcess) {
  const auto folder = real_data("laz");
  if (!folder) GTEST_SKIP() << "no LAZ files in SOAPFILM_DATA";
  for (const auto& entry : std::filesystem::directory_iterator(*folder)) {
    const std::string path = entry.path().string();
    if (entry.path().extension() != ".laz") continue;
    const std::string alone = outcome_of(path, Context(1));
    for (const Group& group : {Group{2, 1, {1}}, Group{3, 2, {2}}})
      for (const std::string& of_rank :
           on_ranks<std::string>(group.ranks, group.threads, group.cuts,
                                 [&](const Context& context) { return outcome_of(path, context); }))
        EXPECT_TRUE(of_rank == alone) << path << ", " << group.ranks << " ranks";
  }
}

}  // namespace TEST_FILE
}  // namespace soapfilm
