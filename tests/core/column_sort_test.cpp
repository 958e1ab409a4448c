#include "soapfilm/core/column_sort.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "soapfilm/core/random.h"

namespace soapfilm {
namespace TEST_FILE {

std::vector<std::pair<std::string, std::vector<uint64_t>>> key_columns() {
  constexpr size_t count = 5000;
  Random random(1);
  std::vector<std::pair<std::string, std::vector<uint64_t>>> columns{{"none", {}}, {"one", {7}}};
  const auto add = [&](const std::string& name, auto key) {
    std::vector<uint64_t> keys;
    for (size_t i = 0; i < count; ++i) keys.push_back(key(i));
    columns.emplace_back(name, std::move(keys));
  };
  add("any", [&](size_t) { return random.next(); });
  add("in order", [](size_t i) { return i; });
  add("in reverse", [](size_t i) { return UINT64_MAX - i; });
  add("equal", [](size_t) { return uint64_t{3}; });
  add("two", [&](size_t) { return random.next() % 2 * UINT64_MAX; });
  add("mostly the least", [&](size_t i) { return i % 999 == 5 ? random.next() : 0; });
  add("mostly the largest", [&](size_t i) { return i % 999 == 5 ? random.next() : UINT64_MAX; });
  add("few", [&](size_t) { return random.next() % 40; });
  return columns;
}

TEST(ColumnSort, GivesTheStableOrder) {
  for (const auto& [name, keys] : key_columns())
    for (const size_t parts : {2, 3, 16, 128})
      for (const size_t small : {size_t{1}, size_t{10}, size_t{1000}, size_t{1} << 20}) {
        std::vector<size_t> expected(keys.size());
        std::iota(expected.begin(), expected.end(), size_t{0});
        std::vector<size_t> rows = expected;
        const auto& key = keys;
        std::stable_sort(expected.begin(), expected.end(), [&](size_t a, size_t b) { return key[a] < key[b]; });
        const ColumnSort sort(keys, parts, small);
        sort.apply(std::span(rows));
        ASSERT_EQ(rows, expected) << name << ", " << parts << " parts, " << small;
        std::vector<uint64_t> sorted = keys;
        sort.apply(std::span(sorted));
        ASSERT_TRUE(std::is_sorted(sorted.begin(), sorted.end())) << name;
      }
}

}  // namespace TEST_FILE
}  // namespace soapfilm
