#include "soapfilm/solve/box_laplacian.h"

namespace soapfilm {

namespace {

// Differences first: on a plateau they are exact, where 6 u minus six neighbors would leave a rounding error of u.
inline float flux_out(const Stencil& s, const Rows& u, int i) {
  const float here = u.here[i];
  return (s.x_down * (here - u.here[i - 1]) + s.x_up * (here - u.here[i + 1])) +
         (s.y_down * (here - u.y_down[i]) + s.y_up * (here - u.y_up[i])) +
         (s.z_down * (here - u.z_down[i]) + s.z_up * (here - u.z_up[i]));
}

inline float weighted_neighbors(const Stencil& s, const Rows& u, int i) {
  return (s.x_down * u.here[i - 1] + s.x_up * u.here[i + 1]) + (s.y_down * u.y_down[i] + s.y_up * u.y_up[i]) +
         (s.z_down * u.z_down[i] + s.z_up * u.z_up[i]);
}

}  // namespace

RowStencils BoxLaplacian::row(int y, int z) const {
  const BoxAxis &ax = axes_[0], &ay = axes_[1], &az = axes_[2];
  const auto at = [&](int x) {
    const double yz = scale_ * ay.width(y) * az.width(z);
    const double xz = scale_ * ax.width(x) * az.width(z);
    const double xy = scale_ * ax.width(x) * ay.width(y);
    return Stencil{static_cast<float>(yz * ax.link(x - 1)), static_cast<float>(yz * ax.link(x)),
                   static_cast<float>(xz * ay.link(y - 1)), static_cast<float>(xz * ay.link(y)),
                   static_cast<float>(xy * az.link(z - 1)), static_cast<float>(xy * az.link(z))};
  };
  return {at(ax.free - 1), at(ax.free)};
}

DenseField<float> box_field(Vec3i free) { return DenseField<float>(LevelBox{0, {1, 1, 1}, free, {}}); }

void apply_row(const RowStencils& stencils, const Rows& u, int free, float* __restrict out) {
  const Stencil s = stencils.inner;
  for (int i = 1; i < free; ++i) out[i] = flux_out(s, u, i);
  out[free] = flux_out(stencils.last, u, free);
}

void residual_row(const RowStencils& stencils, const Rows& u, const float* b, int free, float* __restrict out) {
  const Stencil s = stencils.inner;
  for (int i = 1; i < free; ++i) out[i] = b[i] - flux_out(s, u, i);
  out[free] = b[free] - flux_out(stencils.last, u, free);
}

void relax_row(const RowStencils& stencils, const Rows& u, const float* b, int first, int free, float* here) {
  const Stencil s = stencils.inner;
  const float inverse = 1.0f / s.sum();
  int i = first;
  for (; i < free; i += 2) here[i] = inverse * (b[i] + weighted_neighbors(s, u, i));
  if (i == free) here[i] = (b[i] + weighted_neighbors(stencils.last, u, i)) / stencils.last.sum();
}

}  // namespace soapfilm
