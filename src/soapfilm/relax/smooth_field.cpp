#include "soapfilm/relax/smooth_field.h"

#include <algorithm>
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

constexpr size_t bricks_per_part = 64;

constexpr int around_stride[3] = {1, 4, 16};

/// Corner k of the cell, x fastest, among the values around it: (0, 0, 0) is the vertex one below its lowest corner
/// along each axis.
constexpr int corner_of(int k) { return (1 + (k & 1)) + 4 * (1 + (k >> 1 & 1)) + 16 * (1 + (k >> 2)); }

}  // namespace

SmoothField::SmoothField(const BrickGrid& grid, const Field<float>& value, const Context& context)
    : grid_(grid), rough_(value), value_(grid, pages_of(context)) {
  if (ranks_of(context))
    parts_ = std::make_unique<Part[]>(grid.size() / bricks_per_part + 1);
  else
    parallel_chunks(context, grid.size(), bricks_per_part, [&](size_t begin, size_t end) { smooth(begin, end); });
}

void SmoothField::smooth(size_t begin, size_t end) const {
  Window<float, 1> window;
  for (size_t b = begin; b < end; ++b) {
    fill_window(
        grid_, b, [&](int, int32_t n) { return n < 0 ? nullptr : rough_.brick(static_cast<size_t>(n)); },
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
}

/// `first`: of the vertices around a cell, from the brick's first one on.
void SmoothField::need_around(const BrickGrid::Neighbors& neighbors, Vec3i first) const {
  const Vec3i last = first + Vec3i{3, 3, 3};
  for (int z = first.z >> 3; z <= last.z >> 3; ++z)
    for (int y = first.y >> 3; y <= last.y >> 3; ++y)
      for (int x = first.x >> 3; x <= last.x >> 3; ++x) {
        const int32_t brick = neighbors[neighbor_slot(x, y, z)];
        if (brick < 0) continue;
        const size_t begin = static_cast<size_t>(brick) / bricks_per_part * bricks_per_part;
        Part& part = parts_[begin / bricks_per_part];
        if (part.is_there.load(std::memory_order_acquire)) continue;
        std::call_once(part.once, [&] {
          smooth(begin, std::min(begin + bricks_per_part, grid_.size()));
          part.is_there.store(true, std::memory_order_release);
        });
      }
}

/// False when one of the values is missing. Vertices that are outside the cell along two axes or more are not needed.
bool SmoothField::gather(Vec3i cell, Around& around) const {
  const int32_t brick = grid_.find(brick_of(cell));
  if (brick < 0) return false;
  const Vec3i first = cell - brick_of(cell) * brick_side - Vec3i{1, 1, 1};
  const auto& neighbors = grid_.neighbors(static_cast<size_t>(brick));
  if (parts_) need_around(neighbors, first);
  for (int z = 0; z < 4; ++z)
    for (int y = 0; y < 4; ++y) {
      const int outside = (z == 0 || z == 3) + (y == 0 || y == 3);
      if (outside > 1) continue;
      for (int x = outside; x < 4 - outside; ++x) {
        const Vec3i v = first + Vec3i{x, y, z};
        const int32_t at = neighbors[neighbor_slot(v.x >> 3, v.y >> 3, v.z >> 3)];
        if (at < 0) return false;
        around[static_cast<size_t>(x + 4 * y + 16 * z)] =
            value_.brick(static_cast<size_t>(at))[brick_offset(v.x & 7, v.y & 7, v.z & 7)];
      }
    }
  return true;
}

std::optional<SmoothField::Jet> SmoothField::at(Vec3d point) const {
  const Vec3d floor{std::floor(point.x), std::floor(point.y), std::floor(point.z)};
  Around around;
  if (!gather(Vec3i(floor), around)) return std::nullopt;
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
