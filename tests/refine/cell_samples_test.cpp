#include "soapfilm/refine/fit/cell_samples.h"

#include <gtest/gtest.h>

#include <map>

#include "refine/band_support.h"
#include "soapfilm/kernels/robust.h"
#include "support/back_ends.h"

namespace soapfilm {
namespace TEST_FILE {

using namespace test;

const Context one_thread(1);

class Pulled : public testing::Test {
 protected:
  /// A position may round up to the brick's end: it belongs to the last cell.
  static GridSamples with_rounded_places(GridSamples samples) {
    for (size_t s = 0; s < samples.size(); s += 50) samples.local[s][static_cast<int>(s) / 50 % 3] = brick_side;
    return samples;
  }
  static Vec3i cell_of(Vec3f local) {
    const auto part = [](float q) { return std::min(static_cast<int>(q), brick_side - 1); };
    return {part(local.x), part(local.y), part(local.z)};
  }

  NarrowBand band = random_band(2, 0.97, 1);
  GridSamples samples = with_rounded_places(random_samples(2, 3000, 2));
  RowArray zero = band.make_array();
  CellSamples data = merged({.normal = 0.3f, .slope = 0.8f}, one_thread);

  CellSamples merged(DataWeights weights, const Context& context) const {
    CellSamples cells(samples, band, context);
    merge(zero, samples, band, {}, weights, context, cells);
    return cells;
  }

  /// Which samples lie in cells with all corners in the band, from the definition.
  std::vector<uint8_t> seen() const {
    const auto in_band = [&](Vec3i v) {
      const int32_t brick = band.grid().find(brick_of(v));
      return band.mask(band.row(brick, v.y & 7, v.z & 7)) >> (v.x & 7) & 1;
    };
    std::vector<uint8_t> found(samples.size(), 1);
    for (size_t b = 0; b < samples.bricks.size(); ++b)
      for (uint32_t s = samples.begin[b]; s < samples.begin[b + 1]; ++s)
        for (int corner = 0; corner < 8; ++corner) {
          const Vec3i v = samples.bricks.first_vertex(b) + cell_of(samples.local[s]) +
                          Vec3i{corner & 1, corner >> 1 & 1, corner >> 2};
          if (!in_band(v)) found[s] = 0;
        }
    return found;
  }

  /// Value and gradient in the cell of a vertex, from the definition.
  Jet jet_in(const RowArray& phi, Vec3i vertex, Vec3f fraction) const {
    std::array<float, 8> v;
    for (size_t corner = 0; corner < 8; ++corner) {
      const auto c = static_cast<int>(corner);
      const Vec3i at = vertex + Vec3i{c & 1, c >> 1 & 1, c >> 2};
      const uint32_t row = band.row(band.grid().find(brick_of(at)), at.y & 7, at.z & 7);
      v[corner] = phi.data()[size_t{row} * brick_side + static_cast<size_t>(at.x & 7)];
    }
    return trilinear(v, fraction);
  }

  template <class Visit>
  void for_each_cell(const CellSamples& cells, Visit&& visit) const {
    for (size_t k = 0; k < cells.rows(); ++k)
      for (int x = 0; x < brick_side; ++x)
        if (cells.present(k) >> x & 1) visit(k, x, cells.cell(k, x));
  }

  /// Half of the energy's gradient, or its linear part.
  RowArray gradient(const RowArray& v, bool affine) const {
    RowArray out = band.make_array();
    const DataTerm term = affine ? DataTerm::gradient(band, data, v, 1, out) : DataTerm::hessian(band, data, v, &out);
    term.add(one_thread);
    return out;
  }
  /// The energy from its definition, cell by cell.
  double energy(const RowArray& phi) const {
    double sum = 0;
    for_each_cell(data, [&](size_t k, int x, const MergedCell& cell) {
      const Vec3i first{x, band.place(data.band_row(k)) & 7, band.place(data.band_row(k)) >> 3};
      // The row's brick is the last one that begins at it or before.
      size_t brick = 0;
      while (brick + 1 < band.grid().size() && band.first_row(brick + 1) <= data.band_row(k)) ++brick;
      const Jet jet = jet_in(phi, band.grid().first_vertex(brick) + first, cell.fraction);
      const Vec3d n(cell.normal), g = Vec3d(jet.gradient) + n;
      const double value = jet.value, slope = dot(n, g);
      sum += cell.weight *
             (value * value + data.weights.normal * (dot(g, g) - slope * slope) + data.weights.slope * slope * slope);
    });
    return sum;
  }
};

TEST_F(Pulled, SeesSamplesWhoseCellsAreWhole) {
  const std::vector<uint8_t> expected = seen();
  const RowArray phi = random_array(band, 8);
  const auto jets = jets_at_samples(phi, samples, data, band, one_thread);
  for (size_t b = 0; b < samples.bricks.size(); ++b)
    for (uint32_t s = samples.begin[b]; s < samples.begin[b + 1]; ++s) {
      ASSERT_EQ(jets[s].has_value(), expected[s] != 0) << s;
      if (!jets[s]) continue;
      const Vec3i in_brick = cell_of(samples.local[s]);
      const Jet jet = jet_in(phi, samples.bricks.first_vertex(b) + in_brick, samples.local[s] - Vec3f(in_brick));
      ASSERT_EQ(jets[s]->value, jet.value);
      ASSERT_EQ(jets[s]->gradient, jet.gradient);
    }
  const auto count = std::count(expected.begin(), expected.end(), 1);
  EXPECT_GT(count, 100);
  EXPECT_LT(static_cast<size_t>(count), samples.size()) << "some cells have a corner outside of the band";
}

TEST_F(Pulled, GradientIsTheEnergysDerivative) {
  const RowArray phi = random_array(band, 3), step = random_array(band, 4);
  RowArray forth = band.make_array(), back = band.make_array();
  for (size_t i = 0; i < phi.size(); ++i) {
    forth.data()[i] = phi.data()[i] + 0.5f * step.data()[i];
    back.data()[i] = phi.data()[i] - 0.5f * step.data()[i];
  }
  // Quadratic: the central difference is exact.
  EXPECT_NEAR(2 * dot(gradient(phi, true), step), energy(forth) - energy(back), 1e-3 * energy(phi));
}

TEST_F(Pulled, IsSymmetricAndGivesItsEnergy) {
  const RowArray a = random_array(band, 5), b = random_array(band, 6);
  const double scale = dot(a, gradient(a, false));
  EXPECT_NEAR(dot(gradient(a, false), b), dot(a, gradient(b, false)), 1e-4 * scale);
  RowArray out = band.make_array();
  EXPECT_NEAR(DataTerm::hessian(band, data, a, &out).add(one_thread), scale, 1e-5 * scale);
  EXPECT_EQ(DataTerm::hessian(band, data, a, nullptr).add(one_thread),
            DataTerm::hessian(band, data, a, &out).add(one_thread));
}

TEST_F(Pulled, PositionsWeighOnConstantsAsMuchAsTheirRowSums) {
  const CellSamples positions = merged({}, one_thread);
  RowArray ones = band.make_array(), expected = band.make_array(), sums = band.make_array();
  std::fill_n(ones.data(), ones.size(), 1.0f);
  DataTerm::hessian(band, positions, ones, &expected).add(one_thread);
  DataTerm::row_sums(band, data, sums).add(one_thread);
  for (size_t i = 0; i < sums.size(); ++i) ASSERT_NEAR(sums.data()[i], expected.data()[i], 1e-6);
}

TEST_F(Pulled, MergingKeepsWeightsAndMeans) {
  double weight = 0, expected_weight = 0;
  Vec3d normal, expected_normal;
  for_each_cell(data, [&](size_t, int, const MergedCell& cell) {
    weight += cell.weight;
    normal += Vec3d(cell.normal * cell.weight);
    for (int axis = 0; axis < 3; ++axis) EXPECT_TRUE(cell.fraction[axis] >= 0 && cell.fraction[axis] <= 1);
  });
  const std::vector<uint8_t> is_seen = seen();
  for (size_t s = 0; s < samples.size(); ++s)
    if (is_seen[s]) {
      expected_weight += 1;
      expected_normal += Vec3d(samples.direction[s]);
    }
  EXPECT_EQ(weight, expected_weight);
  EXPECT_LT(norm(normal - expected_normal), 1e-4);
}

/// Merged again with other weights the cells hold only the new sums; samples of small weight, also unseen ones, count.
TEST_F(Pulled, MergingForgetsWhatWasMerged) {
  std::vector<uint8_t> third(samples.size());
  for (size_t s = 0; s < third.size(); s += 3) third[s] = 1;
  CellSamples fresh(samples, band, one_thread);
  merge(zero, samples, band, {.active = third}, {}, one_thread, fresh);
  merge(zero, samples, band, {.active = third}, {}, one_thread, data);
  const std::vector<uint8_t> is_seen = seen();
  size_t heard = 0;
  for (size_t s = 0; s < samples.size(); s += 3) heard += is_seen[s];
  EXPECT_EQ(data.doubted, samples.size() - heard);
  EXPECT_EQ(data.count, fresh.count);
  ASSERT_EQ(data.rows(), fresh.rows());
  for_each_cell(data, [&](size_t k, int x, const MergedCell& cell) {
    const MergedCell other = fresh.cell(k, x);
    ASSERT_EQ(cell.weight, other.weight);
    ASSERT_EQ(cell.fraction, other.fraction);
    ASSERT_EQ(cell.normal, other.normal);
  });
}

class PulledOn : public Pulled, public testing::WithParamInterface<BackEnd> {};

TEST_P(PulledOn, GivesTheSameBits) {
  const RowArray phi = random_array(band, 7);
  const RowArray expected = gradient(phi, true);
  const Context context = context_on(GetParam());
  RowArray out = band.make_array();
  const CellSamples cells = merged({0.3f, 0.8f}, context);
  DataTerm::gradient(band, cells, phi, 1, out).add(context);
  for (size_t i = 0; i < out.size(); ++i) ASSERT_EQ(out.data()[i], expected.data()[i]);
}

/// The merged samples of each cell equal the results of robust.h for one sample after the other, to the last bit.
TEST_P(PulledOn, MergesWhatEachSampleSays) {
  const RowArray phi = random_array(band, 9);
  const auto jets = jets_at_samples(phi, samples, data, band, one_thread);
  GridSamples weighted = samples;
  std::vector<uint8_t> most(samples.size());
  for (size_t s = 0; s < samples.size(); ++s) {
    weighted.direction[s] = weighted.direction[s] * static_cast<float>(s % 5);  // some have none
    most[s] = s % 7 != 0;
  }
  const Context context = context_on(GetParam());
  for (const Penalty penalty : {Penalty::least_squares, Penalty::huber, Penalty::geman_mcclure, Penalty::tukey})
    for (const bool directions : {false, true}) {
      constexpr float scale = 0.4f;
      struct Sums {
        Vec3f fraction, normal;
        float weight = 0;
      };
      std::map<std::pair<uint32_t, int>, Sums> expected;  // by row of the band and x
      size_t doubted = 0;
      for (size_t b = 0; b < samples.bricks.size(); ++b)
        for (uint32_t s = samples.begin[b]; s < samples.begin[b + 1]; ++s) {
          float weight = 0;
          if (jets[s] && most[s] && seen_from_outside(weighted.direction[s], jets[s]->gradient)) {
            const Vec3f g = jets[s]->gradient;
            weight = robust_weight(penalty, jets[s]->value / std::max(norm(g), least_slope_of_distance), scale);
            const Vec3i at = cell_of(samples.local[s]);
            const auto brick = static_cast<int32_t>(band.grid().find(samples.bricks.coord(b)));
            Sums& sums = expected[{band.row(brick, at.y, at.z), at.x}];
            sums.fraction += weight * (samples.local[s] - Vec3f(at));
            sums.normal += weight * (directions ? normalized(weighted.direction[s])
                                                : -(g / std::max(norm(g), least_slope_of_normal)));
            sums.weight += weight;
          }
          doubted += weight < 0.25f;
        }
      merge(phi, weighted, band, {penalty, scale, directions, most}, {}, context, data);
      EXPECT_EQ(data.doubted, doubted);
      EXPECT_EQ(data.count,
                std::count_if(expected.begin(), expected.end(), [](auto& e) { return e.second.weight > 0; }));
      for_each_cell(data, [&](size_t k, int x, const MergedCell& cell) {
        const Sums& sums = expected[{data.band_row(k), x}];
        const float weight = sums.weight;
        ASSERT_EQ(cell.weight, weight);
        ASSERT_EQ(cell.fraction, weight > 0 ? sums.fraction / weight : Vec3f{});
        ASSERT_EQ(cell.normal, weight > 0 ? sums.normal / weight : Vec3f{});
      });
    }
}

INSTANTIATE_TEST_SUITE_P(BackEnds, PulledOn, testing::ValuesIn(back_ends()), back_end_name);

TEST(RobustWeight, FallsFromOneWithTheResidual) {
  for (const Penalty penalty : {Penalty::least_squares, Penalty::huber, Penalty::geman_mcclure, Penalty::tukey}) {
    EXPECT_EQ(robust_weight(penalty, 0, 0.2f), 1);
    for (float r = 0.01f; r < 3; r *= 1.5f) {
      EXPECT_LE(robust_weight(penalty, r, 0.2f), robust_weight(penalty, r / 1.5f, 0.2f));
      EXPECT_EQ(robust_weight(penalty, r, 0.2f), robust_weight(penalty, -r, 0.2f));
    }
  }
  EXPECT_EQ(robust_weight(Penalty::tukey, 1, 0.2f), 0) << "beyond 4.685 scales";
}

}  // namespace TEST_FILE
}  // namespace soapfilm
