#include "soapfilm/core/some_by_place.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <vector>

#include "support/shuffled.h"

namespace soapfilm {
namespace TEST_FILE {

using namespace test;

const Context one_thread(1);

std::vector<Vec3d> random_places(size_t count, uint64_t seed) {
  Random random(seed);
  std::vector<Vec3d> places;
  for (size_t k = 0; k < count; ++k) places.push_back({random.uniform(-1, 1), random.normal(), random.uniform()});
  return places;
}

Box3d box_of(const std::vector<Vec3d>& places) {
  Box3d box;
  for (const Vec3d& p : places) box.extend(p);
  return box;
}

std::vector<Vec3d> some_in(const Box3d& box, const std::vector<Vec3d>& places, size_t most,
                           const Context& context = one_thread) {
  std::vector<Vec3d> some;
  for (const uint32_t i : some_by_place(box, places.size(), most, context, [&](size_t k) { return places[k]; }))
    some.push_back(places[i]);
  return some;
}

std::vector<Vec3d> some_of(const std::vector<Vec3d>& places, size_t most, const Context& context = one_thread) {
  return some_in(box_of(places), places, most, context);
}

TEST(SomeByPlace, AreTheSameInTheSameOrderHoweverSamplesAreNumbered) {
  const std::vector<Vec3d> places = random_places(20000, 1);
  for (const size_t most : {300u, 7000u, 20000u, 90000u}) {
    const std::vector<Vec3d> some = some_of(places, most);
    for (uint64_t seed = 1; seed <= 3; ++seed)
      EXPECT_EQ(some_of(in_order(places, random_order(places.size(), seed)), most), some);
    EXPECT_EQ(some_of(places, most, Context(3)), some);
  }
}

/// What a part of the samples gives for its share is in what the whole gives: so tiles can choose by themselves.
TEST(SomeByPlace, OfAPartAreThoseOfTheWholeThatAreInIt) {
  const std::vector<Vec3d> places = random_places(20000, 2);
  const std::vector<Vec3d> part(places.begin(), places.begin() + 5000);
  const std::vector<Vec3d> of_part = some_in(box_of(places), part, 500), of_whole = some_of(places, 2000);
  std::vector<Vec3d> both;
  const std::set<std::array<double, 3>> in_part = [&] {
    std::set<std::array<double, 3>> found;
    for (const Vec3d& p : part) found.insert({p.x, p.y, p.z});
    return found;
  }();
  for (const Vec3d& p : of_whole)
    if (in_part.count({p.x, p.y, p.z}) != 0) both.push_back(p);
  EXPECT_EQ(of_part, both);
}

TEST(SomeByPlace, AreAboutAsManyAsAskedForEverywhere) {
  const std::vector<Vec3d> places = random_places(100000, 3);
  EXPECT_EQ(some_of(places, places.size()).size(), places.size());
  for (const size_t most : {1000u, 30000u}) {
    const std::vector<Vec3d> some = some_of(places, most);
    const auto wanted = static_cast<double>(most);
    EXPECT_NEAR(static_cast<double>(some.size()), wanted, 5 * std::sqrt(wanted));
    // The order tells nothing of the place: half of the first half is in either half of space.
    double left = 0;
    for (size_t k = 0; k < some.size() / 2; ++k) left += some[k].x < 0;
    EXPECT_NEAR(left, wanted / 4, 5 * std::sqrt(wanted / 8));
  }
}

TEST(SomeByPlace, CountAPlaceOnce) {
  std::vector<Vec3d> places = random_places(100, 4);
  const std::vector<Vec3d> once = some_of(places, 1000);
  places.resize(5000, places[7]);
  EXPECT_EQ(some_of(places, 5000), once);
}

/// Places in one cell are told apart.
TEST(SomeByPlace, DoNotChangeWithTheUnitNorWithTheFrame) {
  const std::vector<Vec3d> places = random_places(10000, 5);
  const auto chosen = [&](auto&& change) {
    std::vector<Vec3d> changed;
    for (const Vec3d& p : places) changed.push_back(change(p));
    return some_by_place(box_of(changed), places.size(), 1000, one_thread, [&](size_t k) { return changed[k]; });
  };
  const auto same = chosen([](Vec3d p) { return p; });
  EXPECT_EQ(chosen([](Vec3d p) { return Vec3d{25.4 * p.x, 25.4 * p.y, 25.4 * p.z}; }), same);
  EXPECT_EQ(chosen([](Vec3d p) { return Vec3d{p.x + 300, p.y - 7, p.z + 0.1}; }), same);
  EXPECT_EQ(chosen([](Vec3d p) { return Vec3d{p.z, p.x, p.y}; }), same);
  const std::vector<Vec3d> near{{1, 2, 3}, {1, 2, 3 + 1e-9}, {1, 3, 2}, {2, 4, 6}, {1, 2, 3}};
  EXPECT_EQ(some_of(near, 10).size(), 4u);
}

}  // namespace TEST_FILE
}  // namespace soapfilm
