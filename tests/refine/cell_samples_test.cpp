#include "soapfilm/refine/cell_samples.h"

#include <gtest/gtest.h>

#include "refine/band_support.h"
#include "soapfilm/refine/robust.h"

namespace soapfilm {
namespace {

using namespace test;

const Parallel one_thread(1);

class DataTerm : public testing::Test {
 protected:
  NarrowBand band = random_band(2, 0.97, 1);
  GridSamples samples = random_samples(2, 400, 2);
  BandSamples where = locate(samples, band, one_thread);
  std::vector<float> weight = std::vector<float>(samples.size(), 0.75f);
  CellSamples data =
      merge(samples, where, band, weight, samples.direction, {.normal = 0.3f, .slope = 0.8f}, one_thread);

  /// Half of the energy's gradient, or its linear part.
  RowArray gradient(const RowArray& v, bool affine) const {
    RowArray out = band.make_array();
    add_data_term(band, data, v, affine, out, one_thread);
    return out;
  }
  /// The energy from its definition, cell by cell.
  double energy(const RowArray& phi) const {
    double sum = 0;
    for (uint32_t r = 1; r <= band.rows(); ++r)
      for (uint32_t c = data.begin[r]; c < data.begin[r + 1]; ++c) {
        const CellSample& cell = data.cells[c];
        GridSamples one;  // a sample at the cell's mean
        one.local = {cell.fraction + Vec3f{static_cast<float>(data.x[c]), 0, 0}};
        const std::vector<Jet> jets = jets_at_samples(phi, one, {{r}, {data.x[c]}}, band, one_thread);
        const Vec3d n(cell.normal), g = Vec3d(jets[0].gradient) + n;
        const double value = jets[0].value, slope = dot(n, g);
        sum += cell.weight * value * value + cell.normal_weight * (dot(g, g) - slope * slope) +
               cell.slope_weight * slope * slope;
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

TEST_F(DataTerm, IsSymmetricAndBoundedByItsDiagonal) {
  const RowArray a = random_array(band, 5), b = random_array(band, 6);
  EXPECT_NEAR(dot(gradient(a, false), b, one_thread), dot(a, gradient(b, false), one_thread),
              1e-4 * dot(a, gradient(a, false), one_thread));
  RowArray diagonal = band.make_array(), scaled = band.make_array();
  add_data_diagonal(band, data, diagonal, one_thread);
  for (size_t i = 0; i < a.size(); ++i) scaled.data()[i] = diagonal.data()[i] * a.data()[i];
  EXPECT_LE(dot(a, gradient(a, false), one_thread), dot(a, scaled, one_thread));
}

TEST_F(DataTerm, MergingKeepsWeightsAndMeans) {
  double merged = 0, seen = 0;
  for (const CellSample& cell : data.cells) merged += cell.weight;
  for (const uint32_t row : where.cell_row) seen += row != 0 ? 0.75 : 0;
  EXPECT_NEAR(merged, seen, 1e-4);
}

TEST_F(DataTerm, DoesNotDependOnThreads) {
  const RowArray phi = random_array(band, 7);
  const RowArray expected = gradient(phi, true);
  const Parallel three(3);
  RowArray out = band.make_array();
  add_data_term(band, merge(samples, where, band, weight, samples.direction, {0.3f, 0.8f}, three), phi, true, out,
                three);
  for (size_t i = 0; i < out.size(); ++i) ASSERT_EQ(out.data()[i], expected.data()[i]);
}

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
