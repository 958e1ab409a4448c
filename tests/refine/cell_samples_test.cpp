#include "soapfilm/refine/cell_samples.h"

#include <gtest/gtest.h>

#include "refine/band_support.h"
#include "soapfilm/refine/robust.h"
#include "support/back_ends.h"

namespace soapfilm {
namespace {

using namespace test;

const Parallel one_thread(1);

class DataTerm : public testing::Test {
 protected:
  NarrowBand band = random_band(2, 0.97, 1);
  GridSamples samples = random_samples(2, 400, 2);
  BandSamples where = locate(samples, band, one_thread);
  CellSamples data = merged({.normal = 0.3f, .slope = 0.8f}, one_thread);

  CellSamples merged(DataWeights weights, const Parallel& parallel) const {
    CellSamples cells = cells_of(samples, where, band, parallel);
    merge(
        samples, where, band,
        [&](size_t s) {
          return WeighedSample{0.75f, samples.direction[s]};
        },
        weights, parallel, cells);
    return cells;
  }

  /// Half of the energy's gradient, or its linear part.
  RowArray gradient(const RowArray& v, bool affine) const {
    RowArray out = band.make_array();
    add_data_term(band, data, v, affine, 1, out, one_thread);
    return out;
  }
  /// The energy from its definition, cell by cell.
  double energy(const RowArray& phi) const {
    double sum = 0;
    for (size_t k = 0; k < data.rows.size(); ++k)
      for (uint8_t x = 0; x < brick_side; ++x) {
        const CellRow& cells = data.rows[k];
        if (cells.weight[x] == 0) continue;
        GridSamples one;  // a sample at the cell's mean
        one.local = {Vec3f{cells.fraction[0][x] + static_cast<float>(x), cells.fraction[1][x], cells.fraction[2][x]}};
        const std::vector<Jet> jets = jets_at_samples(phi, one, {{data.row[k]}, {x}}, band, one_thread);
        const Vec3d n(Vec3f{cells.normal[0][x], cells.normal[1][x], cells.normal[2][x]});
        const Vec3d g = Vec3d(jets[0].gradient) + n;
        const double value = jets[0].value, slope = dot(n, g);
        sum += cells.weight[x] *
               (value * value + data.weights.normal * (dot(g, g) - slope * slope) + data.weights.slope * slope * slope);
      }
    return sum;
  }
};

TEST_F(DataTerm, SeesMostSamples) {
  const auto seen = std::count_if(where.cell_row.begin(), where.cell_row.end(), [](uint32_t r) { return r != 0; });
  EXPECT_GT(seen, 100);
  EXPECT_LT(static_cast<size_t>(seen), samples.size()) << "some cells have a corner outside of the band";
}

TEST_F(DataTerm, GradientIsTheEnergysDerivative) {
  const RowArray phi = random_array(band, 3), step = random_array(band, 4);
  RowArray forth = band.make_array(), back = band.make_array();
  for (size_t i = 0; i < phi.size(); ++i) {
    forth.data()[i] = phi.data()[i] + 0.5f * step.data()[i];
    back.data()[i] = phi.data()[i] - 0.5f * step.data()[i];
  }
  // Quadratic: the central difference is exact.
  EXPECT_NEAR(2 * dot(gradient(phi, true), step, one_thread), energy(forth) - energy(back), 1e-3 * energy(phi));
}

TEST_F(DataTerm, IsSymmetricAndTellsItsEnergy) {
  const RowArray a = random_array(band, 5), b = random_array(band, 6);
  const double scale = dot(a, gradient(a, false), one_thread);
  EXPECT_NEAR(dot(gradient(a, false), b, one_thread), dot(a, gradient(b, false), one_thread), 1e-4 * scale);
  RowArray out = band.make_array();
  EXPECT_NEAR(add_data_term(band, data, a, false, -2, out, one_thread), -2 * scale, 1e-5 * scale);
}

TEST_F(DataTerm, PositionsWeighOnConstantsAsMuchAsTheirRowSums) {
  const CellSamples positions = merged({}, one_thread);
  RowArray ones = band.make_array(), expected = band.make_array(), sums = band.make_array();
  std::fill_n(ones.data(), ones.size(), 1.0f);
  add_data_term(band, positions, ones, false, 1, expected, one_thread);
  add_position_weights(band, data, sums, one_thread);
  for (size_t i = 0; i < sums.size(); ++i) ASSERT_NEAR(sums.data()[i], expected.data()[i], 1e-6);
}

TEST_F(DataTerm, MergingKeepsWeightsAndMeans) {
  double merged = 0, seen = 0;
  for (const CellRow& cells : data.rows)
    for (const float w : cells.weight) merged += w;
  for (const uint32_t row : where.cell_row) seen += row != 0 ? 0.75 : 0;
  EXPECT_NEAR(merged, seen, 1e-4);
}

/// Merged again with other weights the cells hold these alone; samples that weigh little are counted, unseen ones too.
TEST_F(DataTerm, MergingForgetsWhatWasMerged) {
  const auto few = [&](size_t s) { return WeighedSample{s % 3 == 0 ? 1.0f : 0.0f, samples.direction[s]}; };
  CellSamples fresh = cells_of(samples, where, band, one_thread);
  merge(samples, where, band, few, {}, one_thread, fresh);
  merge(samples, where, band, few, {}, one_thread, data);
  size_t heard = 0;
  for (size_t s = 0; s < samples.size(); s += 3) heard += where.cell_row[s] != 0;
  EXPECT_EQ(data.doubted, samples.size() - heard);
  EXPECT_EQ(data.count, fresh.count);
  for (size_t k = 0; k < data.rows.size(); ++k)
    for (size_t x = 0; x < brick_side; ++x) {
      ASSERT_EQ(data.rows[k].weight[x], fresh.rows[k].weight[x]);
      for (int axis = 0; axis < 3; ++axis) {
        ASSERT_EQ(data.rows[k].fraction[axis][x], fresh.rows[k].fraction[axis][x]);
        ASSERT_EQ(data.rows[k].normal[axis][x], fresh.rows[k].normal[axis][x]);
      }
    }
}

class DataTermOn : public DataTerm, public testing::WithParamInterface<BackEnd> {};

TEST_P(DataTermOn, GivesTheSameBits) {
  const RowArray phi = random_array(band, 7);
  const RowArray expected = gradient(phi, true);
  const ForcedTarget target(GetParam().target);
  const Parallel parallel(GetParam().threads);
  RowArray out = band.make_array();
  add_data_term(band, merged({0.3f, 0.8f}, parallel), phi, true, 1, out, parallel);
  for (size_t i = 0; i < out.size(); ++i) ASSERT_EQ(out.data()[i], expected.data()[i]);
}

INSTANTIATE_TEST_SUITE_P(BackEnds, DataTermOn, testing::ValuesIn(back_ends()), back_end_name);

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

}  // namespace
}  // namespace soapfilm
