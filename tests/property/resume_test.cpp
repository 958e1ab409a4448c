// Runs that did not end go on from their finished stages: the same mesh and report, and nothing stays behind.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <ostream>
#include <string>
#include <string_view>
#include <vector>

#include "soapfilm/core/context_state.h"
#include "soapfilm/error.h"
#include "soapfilm/platform/scratch.h"
#include "soapfilm/reconstruct.h"
#include "support/hash.h"
#include "support/problem.h"
#include "support/process.h"

namespace soapfilm {
namespace TEST_FILE {

using namespace test;
namespace fs = std::filesystem;

/// Ends the run at its n-th report, and counts.
class Interrupting final : public Progress {
 public:
  explicit Interrupting(size_t at) : at_(at) {}
  void advance(double, std::string_view) override { count(); }
  void info(const std::string& line) override {
    if (line.starts_with("resume: ")) resumed.push_back(line);
    if (line.starts_with("refined: ")) after_refining = reports + 1;
    count();
  }
  void warn(const std::string& line) override { warnings.push_back(line); }

  size_t reports = 0, after_refining = 0;
  std::vector<std::string> resumed, warnings;

 private:
  void count() {
    if (++reports == at_) cancel();
  }
  size_t at_;
};

/// Without what depends on when and how it ran.
std::string timeless(ReconstructReport report) {
  report.stages.clear();
  report.peak_bytes = report.array_bytes = 0;
  return to_json(report);
}

struct Interrupted {
  std::string shape;
  bool bare = false;  ///< without normals
  bool adapts = false;
};
void PrintTo(const Interrupted& c, std::ostream* out) { *out << c.shape << (c.adapts ? ", levels adapt" : ""); }

class ResumeOf : public testing::TestWithParam<Interrupted> {
 protected:
  void SetUp() override {
    if (!has_scratch_files()) GTEST_SKIP();
    cloud = sampled(GetParam().shape, 64, 1);
    if (GetParam().bare) cloud.normals.clear();
    params.place.resolution = 64;
    params.place.adapt = GetParam().adapts;
  }
  PointCloud cloud;
  ReconstructParams params;
};

TEST_P(ResumeOf, IsTheSameWhereverItWasInterrupted) {
  Interrupting counts(0);
  Context whole(1, counts);
  const Reconstruction expected = reconstruct(cloud, params, whole);
  const test::TemporaryFolder folder;
  std::vector<std::string> resumed;
  constexpr size_t places = 12;
  for (size_t place = 1; place < places; ++place) {
    Interrupting interrupting(place * counts.reports / places);
    Context first(2, interrupting);
    first.set_scratch_folder(folder.path().string());
    first.set_resume(true);
    EXPECT_THROW(reconstruct(cloud, params, first), Cancelled);

    Interrupting goes_on(0);
    Context second(1, goes_on);
    second.set_scratch_folder(folder.path().string());
    second.set_resume(true);
    const Reconstruction found = reconstruct(cloud, params, second);
    EXPECT_EQ(hash_mesh(found.mesh), hash_mesh(expected.mesh)) << place;
    EXPECT_EQ(timeless(found.report), timeless(expected.report)) << place;
    EXPECT_EQ(goes_on.warnings, counts.warnings) << place;
    EXPECT_TRUE(fs::is_empty(folder.path())) << place;
    resumed = goes_on.resumed;
  }
  const auto has = [&](const std::string& stage) {
    return std::any_of(resumed.begin(), resumed.end(),
                       [&](const std::string& line) { return line.starts_with("resume: " + stage); });
  };
  EXPECT_TRUE(has("orient") && has("level_0") && has("refine"));
}

INSTANTIATE_TEST_SUITE_P(Scans, ResumeOf,
                         testing::Values(Interrupted{"knot"}, Interrupted{"part", true},
                                         Interrupted{"knot", true, true}));

struct Resume : testing::Test {
  void SetUp() override {
    if (!has_scratch_files()) GTEST_SKIP();
    params.place.resolution = 48;
  }
  /// Interrupted where all stages are kept; returns how many files there are.
  size_t interrupt() {
    Interrupting counts(0);
    Context whole(1, counts);
    expected = hash_mesh(reconstruct(cloud, params, whole).mesh);
    Interrupting interrupting(counts.after_refining);
    Context context(1, interrupting);
    context.set_scratch_folder(folder.path().string());
    context.set_resume(true);
    EXPECT_THROW(reconstruct(cloud, params, context), Cancelled);
    return files();
  }
  size_t files() const {
    return static_cast<size_t>(std::distance(fs::directory_iterator(folder.path()), fs::directory_iterator()));
  }
  Reconstruction go_on(Interrupting& progress) {
    Context context(1, progress);
    context.set_scratch_folder(folder.path().string());
    context.set_resume(true);
    return reconstruct(cloud, params, context);
  }

  PointCloud cloud = sampled("torus", 48, 1);
  ReconstructParams params;
  test::TemporaryFolder folder;
  uint64_t expected = 0;
};

TEST_F(Resume, IsNotOfOtherParametersOrSamples) {
  const size_t kept = interrupt();
  EXPECT_GE(kept, 4u);
  Interrupting other(0);
  params.refine.smoothing = 3;
  go_on(other);
  EXPECT_TRUE(other.resumed.empty());
  EXPECT_EQ(files(), kept) << "the other run's";
  params.refine.smoothing.reset();
  const Vec3d place = cloud.positions[7];
  cloud.positions[7].x += 1e-12;
  Interrupting moved(0);
  go_on(moved);
  EXPECT_TRUE(moved.resumed.empty());
  cloud.positions[7] = place;
  Interrupting same(0);
  EXPECT_EQ(hash_mesh(go_on(same).mesh), expected);
  EXPECT_EQ(same.resumed.size(), kept);
  EXPECT_EQ(files(), 0u);
}

TEST_F(Resume, DoesAgainWhatIsNotWhole) {
  interrupt();
  for (const fs::directory_entry& file : fs::directory_iterator(folder.path()))
    fs::resize_file(file.path(), fs::file_size(file.path()) / 2);
  Interrupting progress(0);
  EXPECT_EQ(hash_mesh(go_on(progress).mesh), expected);
  EXPECT_TRUE(progress.resumed.empty());
  EXPECT_FALSE(progress.warnings.empty());
  EXPECT_EQ(files(), 0u);
}

TEST_F(Resume, NeedsAFolder) {
  Context context(1);
  context.set_resume(true);
  EXPECT_THROW(reconstruct(cloud, params, context), ParameterError);
  context.set_scratch_folder(folder.file("absent"));
  EXPECT_THROW(reconstruct(cloud, params, context), OutputError);
}

}  // namespace TEST_FILE
}  // namespace soapfilm
