#include "soapfilm/core/radix_sort.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "soapfilm/core/random.h"
#include "support/sanitized.h"

namespace soapfilm {
namespace TEST_FILE {

TEST(RadixSort, OrdersAsAComparisonDoes) {
  for (const int threads : {1, 2, 3, 8})
    for (const int bits : {1, 11, 12, 13, 48, 63})
      for (const size_t count : {0, 1, 2, 1000, test::sanitized ? 40000 : 100000}) {
        Random random(count + 1);
        std::vector<uint64_t> keys;
        for (size_t i = 0; i < count; ++i) keys.push_back(random.next() >> (64 - bits));
        std::vector<uint64_t> expected = keys;
        std::sort(expected.begin(), expected.end());
        radix_sort(keys, bits, Context(threads));
        EXPECT_EQ(keys, expected) << bits << " bits, " << count << " keys, " << threads << " threads";
      }
}

TEST(RadixSort, KeepsTheOrderOfKeysThatAgreeInTheirLowestBits) {
  for (const int bits : {1, 5, 13, 22, 30}) {
    Random random(3);
    std::vector<uint64_t> keys;
    for (size_t i = 0; i < 70000; ++i) keys.push_back(random.next());
    std::vector<uint64_t> expected = keys;
    const uint64_t mask = (uint64_t{1} << bits) - 1;
    std::stable_sort(expected.begin(), expected.end(), [&](uint64_t a, uint64_t b) { return (a & mask) < (b & mask); });
    radix_sort(keys, bits, Context(2));
    EXPECT_EQ(keys, expected) << bits;
  }
}

}  // namespace TEST_FILE
}  // namespace soapfilm
