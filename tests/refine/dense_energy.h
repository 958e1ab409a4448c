// The energy of the fit on a small band, every term from its definition, as one dense quadratic function.
#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include "refine/dense_band.h"
#include "soapfilm/refine/fit/cell_samples.h"
#include "soapfilm/refine/fit/displacement.h"
#include "support/dense_matrix.h"

namespace soapfilm::test {

/// E(phi) = <phi, A phi> - 2 <b, phi> + a constant.
struct Quadratic {
  DenseMatrix a;
  Values b;

  explicit Quadratic(size_t size) : a(size), b(size) {}
  /// += weight (f - wanted)^2, f linear in phi.
  void add(const std::vector<size_t>& index, const Values& f, double wanted, double weight) {
    a.add_square(index, f, weight);
    for (size_t k = 0; k < index.size(); ++k) b[index[k]] += weight * wanted * f[k];
  }
  double at(const Values& phi) const {
    const Values product = a.times(phi);
    double sum = 0;
    for (size_t i = 0; i < phi.size(); ++i) sum += phi[i] * (product[i] - 2 * b[i]);
    return sum;
  }
  /// Where it is least.
  Values minimizer() const {
    DenseMatrix factor = a;
    return factor.factorize() ? factor.solve(b) : Values{};
  }
};

/// The terms of Displacement's energy.
class DenseEnergy {
 public:
  const DenseBand& band;
  Values start;          ///< phi0
  Values share, target;  ///< of the curvature

  DenseEnergy(const DenseBand& band, const RowArray& phi0)
      : band(band), start(band.values(phi0)), share(band.size(), 1), target(band.size()) {}

  Quadratic quadratic(const CellSamples& data, Smoothness smoothness) const {
    Quadratic e(band.size());
    add_data(data, e);
    add_smoothness(smoothness, e);
    return e;
  }

 private:
  /// A corner's share in the value and in the gradient at a place in a cell.
  struct Corner {
    size_t index;
    double value;
    Vec3d gradient;
  };
  std::vector<Corner> corners_of(const CellSamples& data, size_t row, int x, Vec3d at) const {
    std::vector<Corner> corners;
    const size_t first = size_t{data.band_row(row)} * brick_side + static_cast<size_t>(x);
    const auto lowest = std::find(band.slot.begin(), band.slot.end(), first) - band.slot.begin();
    for (int k = 0; k < 8; ++k) {
      const Vec3i c{k & 1, k >> 1 & 1, k >> 2};
      Vec3d part, slope;
      for (int axis = 0; axis < 3; ++axis) {
        part[axis] = c[axis] ? at[axis] : 1 - at[axis];
        slope[axis] = c[axis] ? 1 : -1;
      }
      corners.push_back({band.find(band.vertex[static_cast<size_t>(lowest)] + c).value(),
                         part.x * part.y * part.z,
                         {slope.x * part.y * part.z, part.x * slope.y * part.z, part.x * part.y * slope.z}});
    }
    return corners;
  }

  void add_data(const CellSamples& data, Quadratic& e) const {
    for (size_t row = 0; row < data.rows(); ++row)
      for (int x = 0; x < brick_side; ++x) {
        if ((data.present(row) >> x & 1) == 0) continue;
        const MergedCell cell = data.cell(row, x);
        const Vec3d n(cell.normal);
        const auto corners = corners_of(data, row, x, Vec3d(cell.fraction));
        std::vector<size_t> index;
        Values value, along;
        std::array<Values, 3> slope;
        for (const Corner& c : corners) {
          index.push_back(c.index);
          value.push_back(c.value);
          along.push_back(dot(n, c.gradient));
          for (int axis = 0; axis < 3; ++axis) slope[static_cast<size_t>(axis)].push_back(c.gradient[axis]);
        }
        const double weight = cell.weight, normal = data.weights.normal, steepness = data.weights.slope;
        e.add(index, value, 0, weight);
        for (int axis = 0; axis < 3; ++axis) e.add(index, slope[static_cast<size_t>(axis)], -n[axis], weight * normal);
        e.add(index, along, -dot(n, n), weight * (steepness - normal));
      }
  }
  /// Of delta = phi - phi0.
  void add_smoothness(Smoothness smoothness, Quadratic& e) const {
    const Values k = band.inner_laplacian(start), g = band.graph_laplacian(start);
    for (size_t i = 0; i < band.size(); ++i) {
      std::vector<size_t> index{i};
      Values bend{0};
      for (const size_t j : band.neighbors(i)) {
        bend[0] += 1;
        bend.push_back(-1);
        index.push_back(j);
        if (j > i) e.add({i, j}, {1, -1}, start[i] - start[j], smoothness.slope);
      }
      e.add(index, bend, g[i] + k[i] - target[i], smoothness.curvature * share[i]);
    }
  }
};

}  // namespace soapfilm::test
