// The displacement's system vertex by vertex and cell by cell, in float, as refine/fit/band_solver.h writes it; no
// layers, no SIMD, no threads. The preconditioner is the CPU's: tests/refine/multilevel_test.cpp has its reference.
#pragma once

#include <array>
#include <vector>

#include "soapfilm/grid/trilinear.h"
#include "soapfilm/refine/fit/cpu_band_solver.h"

namespace soapfilm::test {

/// A brick's sum, by place along x.
class PlacedSum {
 public:
  void add(float value, size_t x) { few_[x] += value; }
  void end_row() {
    if (++rows_ == 64) flush();
  }
  double total() {
    flush();
    return ((all_[0] + all_[1]) + (all_[2] + all_[3])) + ((all_[4] + all_[5]) + (all_[6] + all_[7]));
  }

 private:
  void flush() {
    for (size_t x = 0; x < brick_side; ++x) all_[x] += static_cast<double>(few_[x]);
    few_ = {};
    rows_ = 0;
  }
  std::array<float, brick_side> few_{};
  std::array<double, brick_side> all_{};
  int rows_ = 0;
};

class ReferenceBandSolver final : public CpuBandSolver {
 public:
  using CpuBandSolver::CpuBandSolver;

  void start(const CellSamples& data, Smoothness smoothness) override {
    for_each_slot([&](uint32_t row, size_t x, size_t i) { scratch_.data()[i] = bent(row, x, i, smoothness); });
    for_each_slot([&](uint32_t row, size_t x, size_t i) { residual_.data()[i] = -1 * laplacian(scratch_, row, x); });
    add_data(data, phi_, true, -1, &residual_);
  }

  double preconditioned() override {
    return multilevel_.apply([](int) {}, residual_, scratch_, image_, context_);
  }

  double search_direction(const CellSamples& data, Smoothness smoothness, float ratio, bool last) override {
    for_each_slot([&](uint32_t, size_t, size_t i) {
      float& d = direction_.data()[i];
      d = ratio == 0 ? scratch_.data()[i] : scratch_.data()[i] + ratio * d;
    });
    TileSums<double> smooth;
    for (size_t b = 0; b < band_.grid().size(); ++b) {
      PlacedSum sum;
      for (uint32_t row = band_.first_row(b); row < band_.first_row(b + 1); ++row, sum.end_row())
        for (size_t x = 0; x < brick_side; ++x) {
          const size_t i = row * size_t{brick_side} + x;
          const float g = laplacian(direction_, row, x);
          const float out = smoothness.slope * direction_.data()[i] + smoothness.curvature * share_.data()[i] * g;
          scratch_.data()[i] = out;
          sum.add(g * out, x);
        }
      smooth.add(band_.grid().coord(b), sum.total());
    }
    if (!last) for_each_slot([&](uint32_t row, size_t x, size_t i) { image_.data()[i] = laplacian(scratch_, row, x); });
    return smooth.total() + add_data(data, direction_, false, 1, last ? nullptr : &image_);
  }

  void step(float length, bool last) override {
    for_each_slot([&](uint32_t, size_t, size_t i) {
      phi_.data()[i] += length * direction_.data()[i];
      if (!last) residual_.data()[i] += -length * image_.data()[i];
    });
  }

 private:
  template <class Visit>
  void for_each_slot(Visit&& visit) const {
    for (uint32_t row = 1; row <= band_.rows(); ++row)
      for (size_t x = 0; x < brick_side; ++x) visit(row, x, row * size_t{brick_side} + x);
  }

  /// Slot of the neighbor along -x, +x, -y, +y, -z, +z.
  size_t beside(uint32_t row, size_t x, size_t side) const {
    const size_t other = band_.neighbors(row)[side] * size_t{brick_side};
    if (side == 0) return x > 0 ? row * size_t{brick_side} + x - 1 : other + brick_side - 1;
    if (side == 1) return x + 1 < brick_side ? row * size_t{brick_side} + x + 1 : other;
    return other + x;
  }
  bool is_in_band(size_t slot) const {
    return (band_.mask(static_cast<uint32_t>(slot / brick_side)) >> slot % brick_side & 1) != 0;
  }
  float pair(const RowArray& v, uint32_t row, size_t x, size_t axis) const {
    return v.data()[beside(row, x, 2 * axis)] + v.data()[beside(row, x, 2 * axis + 1)];
  }
  float degree(uint32_t row, size_t x) const { return static_cast<float>(band_.degree(row)[x]); }

  /// G v at a vertex.
  float laplacian(const RowArray& v, uint32_t row, size_t x) const {
    if (degree(row, x) == 0) return 0;
    return degree(row, x) * v.data()[row * size_t{brick_side} + x] -
           (pair(v, row, x, 0) + (pair(v, row, x, 1) + pair(v, row, x, 2)));
  }

  /// beta delta + gamma s (G phi - R phi0 + target).
  float bent(uint32_t row, size_t x, size_t i, Smoothness smoothness) const {
    const float strength = smoothness.curvature * share_.data()[i];
    if (degree(row, x) == 0) return strength * target_.data()[i];
    std::array<float, 3> one_sided{};
    for (size_t axis = 0; axis < 3; ++axis)
      if (is_in_band(beside(row, x, 2 * axis)) != is_in_band(beside(row, x, 2 * axis + 1)))
        one_sided[axis] = phi0_.data()[i] - pair(phi0_, row, x, axis);
    const float curved = laplacian(phi_, row, x) - (one_sided[0] + (one_sided[1] + one_sided[2]));
    return smoothness.slope * (phi_.data()[i] - phi0_.data()[i]) + strength * curved + strength * target_.data()[i];
  }

  /// out += scale times half of the data term's gradient at v, or without `affine` of its quadratic part. Returns <v,
  /// what is added>.
  double add_data(const CellSamples& data, const RowArray& v, bool affine, float scale, RowArray* out) const {
    std::vector<double> of_brick(data.bricks());
    for (const int parity : {0, 1})
      for (size_t b = 0; b < data.bricks(); ++b)
        if ((data.coord(b).z & 1) == parity) of_brick[b] = add_brick(data, b, v, affine, scale, out);
    TileSums<double> sum;
    for (size_t b = 0; b < data.bricks(); ++b) sum.add(data.coord(b), of_brick[b]);
    return sum.total();
  }

  double add_brick(const CellSamples& data, size_t brick, const RowArray& v, bool affine, float scale,
                   RowArray* out) const {
    PlacedSum energy;
    const auto [begin, end] = data.brick(brick);
    for (size_t k = begin; k < end; ++k, energy.end_row()) {
      std::array<std::array<float, 8>, brick_side> parts{};  // of each cell, for its corners
      for (int x = 0; x < brick_side; ++x)
        if (data.present(k) >> x & 1)
          energy.add(add_cell(data, corners(data.band_row(k), x), data.cell(k, x), v, affine, scale,
                              parts[static_cast<size_t>(x)]),
                     static_cast<size_t>(x));
      if (!out) continue;
      // A vertex first adds up what the cells on either side of it along x give.
      for (size_t c = 0; c < 4; ++c) {
        for (int x = 0; x < brick_side; ++x) {
          const auto at = static_cast<size_t>(x);
          const float left = x > 0 ? parts[at - 1][2 * c + 1] : 0.0f;
          out->data()[corners(data.band_row(k), x)[2 * c]] += parts[at][2 * c] + left;
        }
        if (data.present(k) >> (brick_side - 1) != 0)
          out->data()[corners(data.band_row(k), brick_side - 1)[2 * c + 1]] += parts[brick_side - 1][2 * c + 1];
      }
    }
    return energy.total();
  }

  /// Slots of a cell's corners, x fastest.
  std::array<size_t, 8> corners(uint32_t row, int x) const {
    const uint32_t y = band_.neighbors(row)[3], z = band_.neighbors(row)[5], both = band_.neighbors(z)[3];
    std::array<size_t, 8> slots{};
    size_t c = 0;
    for (const uint32_t r : {row, y, z, both}) {
      slots[c++] = r * size_t{brick_side} + static_cast<size_t>(x);
      slots[c++] = beside(r, static_cast<size_t>(x), 1);
    }
    return slots;
  }

  static float add_cell(const CellSamples& data, const std::array<size_t, 8>& slots, const MergedCell& cell,
                        const RowArray& v, bool affine, float scale, std::array<float, 8>& parts) {
    std::array<float, 8> values{};
    for (size_t c = 0; c < 8; ++c) values[c] = v.data()[slots[c]];
    const FieldJet<float> jet = trilinear(values, cell.fraction);
    const Vec3f g = affine ? jet.gradient + cell.normal : jet.gradient, n = cell.normal, f = cell.fraction;
    const float weight = scale * cell.weight;
    const float along = (data.weights.slope - data.weights.normal) * (n.x * g.x + n.y * g.y + n.z * g.z);
    const auto pull = [&](float gk, float nk) { return weight * (data.weights.normal * gk + along * nk); };
    const float pv = weight * jet.value, px = pull(g.x, n.x), py = pull(g.y, n.y), pz = pull(g.z, n.z);
    // Back to the corners: the interpolation's steps in reverse.
    const float z1 = f.z * pv + pz, z0 = pv - z1, ey1 = f.z * py, ey0 = py - ey1, ex1 = f.z * px, ex0 = px - ex1;
    const float qy = 1 - f.y, qx = 1 - f.x;
    const float corner[] = {qy * z0 - ey0, f.y * z0 + ey0, qy * z1 - ey1, f.y * z1 + ey1};
    const float slope[] = {qy * ex0, f.y * ex0, qy * ex1, f.y * ex1};
    for (size_t c = 0; c < 4; ++c) {
      parts[2 * c] = qx * corner[c] - slope[c];
      parts[2 * c + 1] = f.x * corner[c] + slope[c];
    }
    return (pv * jet.value + px * g.x) + (py * g.y + pz * g.z);
  }
};

}  // namespace soapfilm::test
