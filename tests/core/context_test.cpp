#include "soapfilm/context.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "soapfilm/core/context_state.h"
#include "soapfilm/core/parallel.h"
#include "soapfilm/error.h"
#include "soapfilm/platform/page_pool.h"

namespace soapfilm {
namespace TEST_FILE {

struct Heard : Progress {
  void advance(double fraction, std::string_view) override { fractions.push_back(fraction); }
  void warn(const std::string& line) override { warnings.push_back(line); }
  std::vector<double> fractions;
  std::vector<std::string> warnings;
};

TEST(Context, RefusesThreadsBelowZero) {
  EXPECT_THROW(Context(-1), ParameterError);
  EXPECT_GE(Context(0).threads(), 1);
}

TEST(Context, PartsReportTheirShareOfTheWhole) {
  Heard heard;
  const Context whole(1, heard);
  const Context part = part_of(whole, 0.2, 0.6);
  part.progress().advance(0, {});
  part.progress().advance(0.5, {});
  part_of(part, 0.5, 1).progress().advance(1, {});
  silenced(part).progress().advance(0.9, {});
  part.progress().warn("a line");
  silenced(whole).progress().warn("nobody is told");
  ASSERT_EQ(heard.fractions.size(), 3u);
  EXPECT_DOUBLE_EQ(heard.fractions[0], 0.2);
  EXPECT_DOUBLE_EQ(heard.fractions[1], 0.4);
  EXPECT_DOUBLE_EQ(heard.fractions[2], 0.6);
  EXPECT_EQ(heard.warnings, std::vector<std::string>{"a line"});
}

TEST(Context, PartsAndSilentOnesStopWithTheWhole) {
  Progress progress;
  const Context whole(2, progress);
  const Context part = part_of(whole, 0, 0.5), silent = silenced(part);
  for (const Context* context : {&whole, &part, &silent}) EXPECT_NO_THROW(context->check());
  progress.cancel();
  for (const Context* context : {&whole, &part, &silent}) {
    EXPECT_THROW(context->check(), Cancelled);
    EXPECT_THROW(parallel_for(*context, 10, 1, [](size_t) {}), Cancelled);
  }
  progress.resume();
  EXPECT_NO_THROW(silent.check());
}

TEST(Context, PartsShareThreadsTargetAndPages) {
  Progress progress;
  const Context whole(3, progress, "scalar");
  const Context part = part_of(whole, 0, 1);
  EXPECT_EQ(part.threads(), 3);
  EXPECT_EQ(&kernels_of(part), &kernels_of(whole));
  { const ZeroedMemory memory = pages_of(silenced(part)).allocate(12345); }
  EXPECT_EQ(pages_of(whole).peak_bytes(), 12345u);
}

}  // namespace TEST_FILE
}  // namespace soapfilm
