#include "soapfilm/core/exact_sum.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "support/shuffled.h"

namespace soapfilm {
namespace TEST_FILE {

using namespace test;

double sum_of(const std::vector<float>& terms) {
  ExactSum sum;
  for (const float term : terms) sum.add(term);
  return sum.value();
}

TEST(ExactSum, OfOneTermIsTheTerm) {
  using Limits = std::numeric_limits<float>;
  for (const float term : {0.0f, 1.0f, -1.0f, 0.1f, 3e38f, -2e-38f, Limits::min(), Limits::max(), Limits::denorm_min(),
                           -17 * Limits::denorm_min(), 1e-40f})
    EXPECT_EQ(sum_of({term}), double{term});
  for (int exponent = -149; exponent < 128; ++exponent)
    EXPECT_EQ(sum_of({std::ldexp(1.0f, exponent)}), std::ldexp(1.0, exponent));
}

TEST(ExactSum, LosesNothingToLargeTermsThatCancel) {
  EXPECT_EQ(sum_of({1e30f, 1e-30f, -1e30f}), double{1e-30f});
  EXPECT_EQ(sum_of({-3e38f, 0.1f, 1e10f, 3e38f, -1e10f}), double{0.1f});
}

/// Integers that double can hold, of all sizes and signs.
TEST(ExactSum, IsThatOfIntegersInAnyOrderAndInParts) {
  Random random(1);
  std::vector<float> terms;
  int64_t expected = 0;
  for (int k = 0; k < 50000; ++k) {
    const auto term = static_cast<int64_t>(random.next() >> (40 + random.next() % 24)) << random.next() % 20;
    terms.push_back(static_cast<float>(k % 3 == 0 ? -term : term));
    expected += k % 3 == 0 ? -term : term;
  }
  EXPECT_EQ(sum_of(terms), static_cast<double>(expected));
  EXPECT_EQ(sum_of(in_order(terms, random_order(terms.size(), 2))), static_cast<double>(expected));
  ExactSum whole, part;
  for (size_t k = 0; k < terms.size(); ++k) (k % 2 == 0 ? whole : part).add(terms[k]);
  EXPECT_EQ((whole += part).value(), static_cast<double>(expected));
}

TEST(ExactSum, OfAnyTermsDoesNotDependOnTheirOrder) {
  Random random(3);
  std::vector<float> terms;
  for (int k = 0; k < 10000; ++k) terms.push_back(static_cast<float>(random.normal() * std::exp(20 * random.normal())));
  for (uint64_t seed = 1; seed < 5; ++seed)
    EXPECT_EQ(sum_of(in_order(terms, random_order(terms.size(), seed))), sum_of(terms));
}

}  // namespace TEST_FILE
}  // namespace soapfilm
