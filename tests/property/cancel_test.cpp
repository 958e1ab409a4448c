// Cancelling: the running stage ends early, whichever it is and for every method, and all memory is freed.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <exception>
#include <map>
#include <set>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "io/files.h"
#include "property/each_method.h"
#include "soapfilm/error.h"
#include "soapfilm/io.h"
#include "soapfilm/reconstruct.h"
#include "support/resident.h"
#include "support/sanitized.h"

namespace soapfilm {
namespace TEST_FILE {

using namespace test;

/// Cancels in a stage: at its n-th report, or, n = 0, when it begins. Records the stages.
class Canceller : public Progress {
 public:
  explicit Canceller(std::string stage = {}, int report = 0) : stage_(std::move(stage)), report_(report) {}

  struct Stage {
    std::string name;
    int reports = 0;       ///< before cancel()
    int late_reports = 0;  ///< after it
    bool cut_short = false;
  };
  std::vector<Stage> stages;

  void begin_stage(std::string_view name) override {
    stages.push_back({std::string(name)});
    running_ = true;
    if (report_ == 0 && name == stage_) cancel();
  }
  /// A stage that was interrupted ends while its exception propagates.
  void end_stage(double) override {
    stages.back().cut_short = std::uncaught_exceptions() > 0;
    running_ = false;
  }
  void advance(double, std::string_view) override { reported(); }
  void detail(const std::string&) override { reported(); }

 private:
  void reported() {
    if (!running_) return;
    Stage& now = stages.back();
    ++(cancelled() ? now.late_reports : now.reports);
    if (now.name == stage_ && now.reports == report_) cancel();
  }

  std::string stage_;
  int report_;
  bool running_ = false;
};

std::vector<std::string> names_of(const std::vector<Canceller::Stage>& stages) {
  std::vector<std::string> names;
  for (const Canceller::Stage& stage : stages) names.push_back(stage.name);
  return names;
}

void run(const PointCloud& cloud, const ReconstructParams& params, Progress& progress, int threads = 1) {
  reconstruct(cloud, params, Context(threads, progress));
}

class CancelledRun : public testing::TestWithParam<Method> {
 protected:
  static constexpr int vertices = sanitized ? 32 : 48;
  const PointCloud cloud = range_scans({}, vertices);
  ReconstructParams params = params_of(GetParam());
  void SetUp() override { params.place.resolution = vertices; }

  void expect_cut_short(const std::vector<Canceller::Stage>& whole, size_t at, int report) const {
    SCOPED_TRACE(whole[at].name + ", report " + std::to_string(report));
    Canceller progress(whole[at].name, report);
    EXPECT_THROW(run(cloud, params, progress), Cancelled);
    std::vector<std::string> expected = names_of(whole);
    expected.resize(at + 1);
    ASSERT_EQ(names_of(progress.stages), expected);
    EXPECT_TRUE(progress.stages.back().cut_short) << "it went on to its end";
    EXPECT_EQ(progress.stages.back().late_reports, 0);
  }
};

TEST_P(CancelledRun, EndsWithinTheStageAtWork) {
  Canceller none;
  run(cloud, params, none);
  const std::vector<Canceller::Stage>& whole = none.stages;
  for (size_t at = 0; at < whole.size(); ++at) {
    const auto& [name, reports, late_reports, cut_short] = whole[at];
    EXPECT_FALSE(cut_short);
    // Methods without lambda have nothing to choose there; Poisson's surface is the result of the solve.
    if (name == "weights") continue;
    if (name == "refine" && GetParam() == Method::poisson) continue;
    std::set<int> wanted = {0, std::min(1, reports), reports / 2};
    for (const int report : wanted) expect_cut_short(whole, at, report);
  }
  const std::vector<std::string> names = names_of(whole);
  for (const char* name : {GetParam() == Method::vrip ? "fuse" : "solve", "extract"})
    EXPECT_EQ(std::count(names.begin(), names.end(), name), 1) << name;
}

/// The progress of every stage that may take long increases, and never decreases.
TEST(ProgressOfStages, RisesFromStageToStage) {
  struct Bars : Progress {
    void begin_stage(std::string_view name) override { stage = name; }
    void advance(double fraction, std::string_view) override {
      std::vector<double>& told = fractions[stage];
      EXPECT_GE(fraction, told.empty() ? 0 : told.back()) << stage;
      EXPECT_LE(fraction, 1) << stage;
      told.push_back(fraction);
    }
    std::string stage;
    std::map<std::string, std::vector<double>> fractions;
  } bars;
  PointCloud cloud = sampled("torus", 48, 2);
  add_noise(cloud, 0.003, 1);
  ReconstructParams params;
  params.place.resolution = 48;
  const Context context(1, bars);
  const Reconstruction result = reconstruct(cloud, params, context);
  for (const char* stage : {"orient", "field", "solve", "refine"}) EXPECT_GE(bars.fractions[stage].size(), 3u) << stage;
  for (const char* stage : {"extract", "self-check"}) EXPECT_GE(bars.fractions[stage].size(), 1u) << stage;

  const TemporaryFolder folder;
  bars.stage = "write";
  write_mesh(folder / "mesh.ply", result.mesh, {}, context);
  EXPECT_GE(bars.fractions["write"].size(), 2u);
  bars.stage = "read";
  write_points(folder / "a.ply", cloud);
  write_points(folder / "b.ply", cloud);
  EXPECT_EQ(read_points({folder / "a.ply", folder / "b.ply"}, nullptr, context).size(), 2 * cloud.size());
  EXPECT_EQ(bars.fractions["read"].size(), 2u);
}

/// Cancels some time after a stage began, from another thread.
class LateCanceller : public Progress {
 public:
  LateCanceller(std::string stage, double seconds) : stage_(std::move(stage)), seconds_(seconds) {}
  void begin_stage(std::string_view name) override {
    if (name != stage_) return;
    timer_ = std::jthread([this] {
      std::this_thread::sleep_for(std::chrono::duration<double>(seconds_));
      cancel();
    });
  }

 private:
  std::string stage_;
  double seconds_;
  std::jthread timer_;
};

/// LeakSanitizer does not see arrays allocated directly from the system, nor the pages kept for the next one. (Other
/// sanitizers keep memory of their own: hence Slow.)
TEST_P(CancelledRun, GivesItsMemoryBackSlow) {
  const int resolution_here = GetParam() == Method::tv ? 160 : 96;
  const PointCloud large = range_scans({}, resolution_here);
  params.place.resolution = resolution_here;
  constexpr int threads = 2;
  constexpr double megabyte = 1 << 20;
  constexpr double left = 4;  // between the small parts of what stays: more threads at once, more of it
  const double empty = resident_bytes();
  std::vector<StageTime> stages;
  {
    const Reconstruction whole = reconstruct(large, params, Context(threads));
    stages = whole.report.stages;
    EXPECT_GT(static_cast<double>(whole.report.peak_bytes) - empty, 16 * megabyte) << "too small to say anything";
  }
  const double before = resident_bytes();
  int cancelled = 0;
  for (const StageTime& stage : stages) {
    if (stage.elapsed < 0.02) continue;  // too short to hold much
    LateCanceller canceller(stage.name, 0.5 * stage.elapsed);
    try {
      run(large, params, canceller, threads);
    } catch (const Cancelled&) {
      ++cancelled;
    }
    EXPECT_LT(resident_bytes(), before + left * megabyte) << stage.name;
  }
  EXPECT_GE(cancelled, 2);
}

INSTANTIATE_TEST_SUITE_P(Methods, CancelledRun,
                         testing::Values(Method::tv, Method::tv_sor, Method::poisson, Method::graph_cut_6,
                                         Method::graph_cut_26, Method::vrip),
                         method_name);

/// Throws from one of its calls, as a callback of an embedding program may.
class Throwing : public Progress {
 public:
  explicit Throwing(std::string call) : call_(std::move(call)) {}
  void begin_stage(std::string_view name) override { fail("begin", name); }
  void end_stage(double) override { fail("end", "solve"); }
  void advance(double, std::string_view) override { fail("advance", "solve"); }

 private:
  void fail(const char* call, std::string_view stage) const {
    if (call_ == call && stage == "solve") throw std::runtime_error("callback");
  }
  std::string call_;
};

TEST(Callbacks, MayThrowAndTheLibraryIsUsableAfterwards) {
  const PointCloud cloud = range_scans({}, 32);
  ReconstructParams params;
  params.place.resolution = 32;
  for (const char* call : {"begin", "advance"}) {
    Throwing progress(call);
    EXPECT_THROW(run(cloud, params, progress, 2), std::runtime_error) << call;
  }
  Throwing progress("end");  // reported by a destructor, which must not throw: what it cannot tell is not told
  EXPECT_NO_THROW(run(cloud, params, progress, 2));
}

}  // namespace TEST_FILE
}  // namespace soapfilm
