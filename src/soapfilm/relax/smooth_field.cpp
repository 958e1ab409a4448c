#include "soapfilm/relax/smooth_field.h"

#include <array>
#include <cmath>

#include "soapfilm/core/context_state.h"
#include "soapfilm/core/parallel.h"
#include "soapfilm/grid/window.h"

namespace soapfilm {

namespace {

constexpr double least_slope = 0.3;
constexpr int newton_steps = 2;
// On average over a cell trilinear interpolation errs by 1/12 of the Laplacian; measured best a little below.
constexpr float balance = 0.075f;

/// The values around a cell: (0, 0, 0) is the vertex one below its lowest corner along each axis.
using Around = std::array<float, 64>;
constexpr int around_stride[3] = {1, 4, 16};

/// Corner k of the cell, x fastest.
constexpr int corner_of(int k) { return (1 + (k & 1)) + 4 * (1 + (k >> 1 & 1)) + 16 * (1 + (k >> 2)); }

/// False when one of the values is missing. Vertices that are outside the cell along two axes or more are not needed.
bool gather(const BrickGrid& grid, const Field<float>& value, Vec3i cell, Around& around) {
  const int32_t brick = grid.find(brick_of(cell));
  if (brick < 0) return false;
  const Vec3i first = cell - brick_of(cell) * brick_side - Vec3i{1, 1, 1};
  const auto& neighbors = grid.neighbors(static_cast<size_t>(brick));
  for (int z = 0; z < 4; ++z)
    for (int y = 0; y < 4; ++y) {
      const int outside = (z == 0 || z == 3) + (y == 0 || y == 3);
      if (outside > 1) continue;
      for (int x = outside; x < 4 - outside; ++x) {
        const Vec3i v = first + Vec3i{x, y, z};
        const int32_t at = neighbors[neighbor_slot(v.x >> 3, v.y >> 3, v.z >> 3)];
        if (at < 0) return false;
        around[static_cast<size_t>(x + 4 * y + 16 * z)] =
            value.brick(static_cast<size_t>(at))[brick_offset(v.x & 7, v.y & 7, v.z & 7)];
      }
    }
  return true;
}

}  // namespace

SmoothField::SmoothField(const BrickGrid& grid, const Field<float>& value, const Context& context)
    : grid_(grid), value_(grid, pages_of(context)) {
  parallel_chunks(context, grid.size(), 64, [&](size_t begin, size_t end) {
    Window<float, 1> window;
    for (size_t b = begin; b < end; ++b) {
      fill_window(
          grid, b, [&](int, int32_t n) { return n < 0 ? nullptr : value.brick(static_cast<size_t>(n)); },
          [&](int, int32_t) { return 0.0f; }, window);
      float* out = value_.brick(b);
      for (int z = 0; z < brick_side; ++z)
        for (int y = 0; y < brick_side; ++y)
          for (int x = 0; x < brick_side; ++x) {
            const float here = window.at(x, y, z);
            const float next = (window.at(x - 1, y, z) + window.at(x + 1, y, z)) +
                               (window.at(x, y - 1, z) + window.at(x, y + 1, z)) +
                               (window.at(x, y, z - 1) + window.at(x, y, z + 1));
            out[brick_offset(x, y, z)] = here + balance * (next - 6 * here);
          }
    }
  });
}

std::optional<SmoothField::Jet> SmoothField::at(Vec3d point) const {
  const Vec3d floor{std::floor(point.x), std::floor(point.y), std::floor(point.z)};
  Around around;
  if (!gather(grid_, value_, Vec3i(floor), around)) return std::nullopt;
  const Vec3d t = point - floor;
  std::array<double, 8> v;
  for (int k = 0; k < 8; ++k) v[static_cast<size_t>(k)] = around[static_cast<size_t>(corner_of(k))];
  Jet jet = trilinear(v, t);
  for (int axis = 0; axis < 3; ++axis) {
    std::array<double, 8> bend;
    for (int k = 0; k < 8; ++k) {
      const auto corner = static_cast<size_t>(corner_of(k)), step = static_cast<size_t>(around_stride[axis]);
      bend[static_cast<size_t>(k)] = around[corner - step] - 2.0 * around[corner] + around[corner + step];
    }
    const Jet b = trilinear(bend, t);
    const double share = 0.5 * t[axis] * (1 - t[axis]);
    jet.value -= share * b.value;
    jet.gradient = jet.gradient - b.gradient * share;
    jet.gradient[axis] -= (0.5 - t[axis]) * b.value;
  }
  return jet;
}

std::optional<Vec3d> SmoothField::project(Vec3d point, double reach) const {
  Vec3d at_surface = point;
  for (int step = 0; step < newton_steps; ++step) {
    const std::optional<Jet> jet = at(at_surface);
    if (!jet) return std::nullopt;
    const double squared_slope = dot(jet->gradient, jet->gradient);
    if (!(squared_slope > least_slope * least_slope)) return std::nullopt;
    at_surface = at_surface - jet->gradient * (jet->value / squared_slope);
    if (!(norm(at_surface - point) <= reach)) return std::nullopt;
  }
  return at_surface;
}

}  // namespace soapfilm
