// What ranks do together is on each of them what one process has.
#include "soapfilm/core/share.h"

#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <vector>

#include "support/thread_ranks.h"

namespace soapfilm {
namespace TEST_FILE {

using namespace test;

/// Expects that body(context), a list, is on every rank what it is on one process.
void expect_same(const std::function<std::vector<uint32_t>(const Context&)>& body) {
  const std::vector<uint32_t> alone = body(Context(1));
  for (uint64_t cut = 1; cut <= 12; ++cut)
    for (const std::vector<uint32_t>& found :
         on_ranks<std::vector<uint32_t>>(1 + static_cast<int>(cut % 7), 1 + static_cast<int>(cut % 2), {cut}, body))
      EXPECT_EQ(found, alone) << "cut " << cut;
}

TEST(Share, PartsAreAll) {
  for (const size_t count : {size_t{0}, size_t{1}, size_t{5}, size_t{1000}, size_t{1 << 20}})
    expect_same([&](const Context& context) {
      const std::vector<ItemRange> parts = even_parts(count, context);
      EXPECT_EQ(parts.front().begin, 0u);
      EXPECT_EQ(parts.back().end, count);
      for (size_t r = 1; r < parts.size(); ++r) EXPECT_EQ(parts[r].begin, parts[r - 1].end);
      return std::vector<uint32_t>{};
    });
}

TEST(Share, PartsAreEven) {
  Mail mail;
  const Context context(1);
  context.state().ranks = std::make_shared<ThreadRank>(1, 3, mail, Cuts{});
  for (const ItemRange& part : even_parts(100000, context)) EXPECT_NEAR(static_cast<double>(part.size()), 33333, 100);
}

TEST(Share, ValuesOfAllRanks) {
  expect_same([](const Context& context) {
    std::vector<uint32_t> values(1234);
    share_values(values, 10, context, [&](size_t k) { values[k] = static_cast<uint32_t>(3 * k); });
    return values;
  });
}

TEST(Share, ListsOfAllRanks) {
  for (const size_t count : {size_t{0}, size_t{3}, size_t{5000}})
    expect_same([&](const Context& context) {
      return share_gather<uint32_t>(count, 7, context, [](size_t k, std::vector<uint32_t>& found) {
        for (size_t i = 0; i < k % 3; ++i) found.push_back(static_cast<uint32_t>(10 * k + i));
      });
    });
}

/// Of each slot the bits that all items have in common: the ranks see different items.
TEST(Share, JoinsWhatRanksHaveOfEachValue) {
  constexpr size_t items = 3000, slots = 500;
  const auto run = [&](const Context& context) {
    std::vector<uint32_t> common(slots, ~uint32_t{0});
    const ItemRange own = own_part(even_parts(items, context), context);
    for (size_t k = own.begin; k < own.end; ++k) common[k * k % slots] &= static_cast<uint32_t>(k | 0xf00);
    join_values(common, context, [](uint32_t& all, uint32_t other) { all &= other; });
    return common;
  };
  EXPECT_NE(run(Context(1)), std::vector<uint32_t>(slots, ~uint32_t{0}));
  expect_same(run);
}

}  // namespace TEST_FILE
}  // namespace soapfilm
